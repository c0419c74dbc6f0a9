r"""The noise in the compared band: what no model can go below, row by row.

Four things make it. The torque's own sensor noise is told by its sample-to-sample differences and, where it is
stronger the slower it is, by what is as strong at all times just above the compared band and in it; where the
differences are those of a drive that jitters near half the rate, by what they cannot be more than there
(:mod:`jaxswarm.diagnose.folds.steady`). The motion is
known only as well as its encoders tell: its noise goes through smoothing and derivatives into
:math:`M(q)\,\delta\ddot q`, and, where a joint hardly moves, through the steep sign of its friction; what comes
out of the model is found by drawing that noise and sending it the same way. When a torque jumped between two
samples is not known either (:mod:`jaxswarm.logs.steps`). And where a joint starts, stops or sticks, motion and
torque are sharper than any smoothing or sampling shows: such errors are short, so that they have as much power
per hertz above the compared band as in it, and are read off there (:mod:`jaxswarm.diagnose.folds.sharp`).

On clean logs of another simulator (11 worlds, some with 15-bit encoders, stick-slip or 50 Hz sampling) the
residual is 0.4 to 1.4 times this noise on 44 of 47 joints, and up to 15 times one that is the same in all rows.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy

from jaxswarm.diagnose.folds.motion_noise import noisy
from jaxswarm.diagnose.folds.sharp import sharp_noise
from jaxswarm.diagnose.folds.stairs import stair_noise
from jaxswarm.diagnose.folds.steady import with_steady_noise
from jaxswarm.diagnose.folds.stiction import rest_noise
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.steps import step_noise

# Without any measured noise, this share of a joint's torque counts as it: what a sensor of 10 bits tells.
_LEAST_NOISE = 1e-3
# What is steady is noise up to this share of a joint's torque, or this multiple of its sensor's noise. Of 54
# clean logs of another simulator it is up to 0.012 (6 times its sensor's), of a measured axis 0.008 (11 times).
# A joint that rubs at narrow places for moments left 0.06 (29 times), and "nothing missing" was said of it.
_STEADY_SHARE, _STEADY_TIMES = 0.01, 10.0
# Draws of the motion's noise, and the decimated rows over which their power is averaged.
_DRAWS, _ROWS = 2, 7
# Decimated rows that missing samples have this share in are unknown to events: where 0.08 s were missing, a
# line across them was told as a push. Their noise over the largest residual: none of them counts.
_ACROSS, _UNKNOWN = 0.02, 1e3
# Residuals beyond this multiple of the noise are bounded in their influence.
_REACH = 4.0


def noise_of(found: Estimate) -> np.ndarray:
    """Standard deviation of the noise below the torque cutoff [N m or N], (n,), over the rows in use.

    Where dry friction holds a joint the sign of its velocity is noise, and nothing is fitted: with these rows
    the noise was seven times what it is in motion, beside which a drag of ten times that was too small to tell.
    """
    return found.regression.rms(found.regression.counted(row_noise(found)))


def row_noise(found: Estimate) -> np.ndarray:
    """The same of every row, (T', n)."""
    sensor = _sensor(found)
    most = np.maximum(_STEADY_SHARE * _size(found), _STEADY_TIMES * sensor)

    def part(motion: Motion) -> np.ndarray:
        # A part of a log between two gaps may be too short to tell.
        steady = np.nan_to_num(np.fmin.reduce([_known(m.steady_noise) for m in found.motions]))
        slow = np.sqrt(np.maximum(steady**2 - sensor**2, 0.0))
        # What is steady is seen above the band once more, where what is sharp is read off.
        sharp = np.sqrt(np.maximum(_known(motion.sharp_noise) ** 2 - slow**2, 0.0))
        # A jump is sharp, too: a window of time that is told as that has it already.
        sharp = np.maximum(sharp, _known(motion.jump_noise))
        slow = np.minimum(slow, most)
        return np.hypot(slow, np.hypot(_known(motion.model_noise), sharp))

    return _with_sensor(found, part)


def row_doubt(found: Estimate) -> np.ndarray:
    """The noise of every row (T', n) by which it counts: without what is sharp.

    An impact in a gear or the edge of a contact is sharp too, and is what has to be explained.
    """
    return _with_sensor(found, lambda m: _known(m.model_noise))


def event_doubt(found: Estimate) -> np.ndarray:
    """The noise of every row (T', n) by which it counts for an event: with jumps, and what sticks.

    An event is a matter of few rows. A law shows on all of them, and an impact is what it has to explain.
    """
    doubt = row_doubt(found)
    if any(m.jump_noise is None for m in found.motions):
        return doubt
    jumps, more = (
        np.concatenate([_known(noise) for noise in noises])
        for noises in zip(*((m.jump_noise, m.event_noise) for m in found.motions), strict=True)
    )
    return np.hypot(doubt, np.hypot(jumps, more))


def _with_sensor(found: Estimate, part: Callable[[Motion], np.ndarray]) -> np.ndarray:
    """Noise of the torque's sensor and a part of what the logs' motion makes, (T', n)."""
    sensor = _sensor(found)
    if any(m.model_noise is None for m in found.motions):
        return np.broadcast_to(sensor, found.regression.torque.shape)
    return np.hypot(sensor, np.concatenate([part(m) for m in found.motions]))


def _known(noise: np.ndarray | None) -> np.ndarray:
    assert noise is not None  # asked for where there is a torque, and after the doubt of the motion
    return noise


def _sensor(found: Estimate) -> np.ndarray:
    """Noise of the torque's sensor (n,), the least of the logs."""
    measured = np.min([m.sensor_noise for m in found.motions], axis=0)
    return np.maximum(np.maximum(measured, _LEAST_NOISE * _size(found)), 1e-12)


def _size(found: Estimate) -> np.ndarray:
    """RMS of the torque of every joint, (n,)."""
    return np.sqrt((found.regression.torque**2).mean(axis=0))


def usual_size(residual: np.ndarray) -> np.ndarray:
    """Standard deviation (n,) of a residual (T, n) by its median; rows that are not used have none.

    >>> usual_size(np.array([[0.0], [0.0], [0.0], [1.0], [-1.0]])).tolist()
    [1.4826]
    """
    told = [x[x > 0] if x.any() else x for x in np.abs(residual).T]
    return 1.4826 * np.array([np.median(x) for x in told])


def with_motion_noise(found: Estimate, seed: int = 0) -> Estimate:
    """The same fit, with what the doubt of its logs' motion makes of the model, row by row."""
    motions = tuple(
        replace(
            with_steady_noise(m, left, drawn),
            model_noise=np.hypot(np.sqrt(_drawn_power(m, drawn)), stair_noise(found.model, m)),
            sharp_noise=sharp_noise(m, left, drawn),
            jump_noise=_jump_noise(m, left),
            event_noise=np.maximum(rest_noise(found.model, m), _missing(m, left)),
        )
        for m in found.motions
        for left, drawn in [(_left(found.model, m), _drawn(found, m, seed))]
    )
    return replace(found, motions=motions)


def _left(model: Model, motion: Motion) -> np.ndarray:
    """What a model leaves on the working clock (T, n), with straight lines where samples are lost."""
    left = motion.tau - model_torque(model, motion)
    if motion.lost is not None:
        # What was put in is off by any amount: it would count as noise of what is beside it.
        known = ~motion.lost
        for own in left.T:
            own[motion.lost] = np.interp(motion.t[motion.lost], motion.t[known], own[known])
    return left


def _jump_noise(motion: Motion, left: np.ndarray) -> np.ndarray:
    """Standard deviation (T', n) of the residual from when in its interval a torque jumped.

    Of what the model leaves on the working clock (T, n): where it jumps along, as at a reversal that positions
    tell to a part of a sample, nothing is in doubt.
    """
    lasting = max(3, round(motion.rate / motion.torque_cutoff))
    return step_noise(left, motion.interval * motion.rate, motion.decimator, lasting)


def _missing(motion: Motion, left: np.ndarray) -> np.ndarray:
    """So much of what is left (T, n) that no row across missing samples counts, (T', n); zero elsewhere."""
    if motion.bridged is None:
        return np.zeros((1, left.shape[1]))
    across = motion.decimator.apply(motion.bridged.astype(float)[:, None]) > _ACROSS
    return across * _UNKNOWN * np.abs(left).max(axis=0)


def _drawn(found: Estimate, motion: Motion, seed: int) -> list[np.ndarray]:
    """What draws of the white noise of a log's positions make of the model's torque, each (T, n)."""
    if motion.position_noise is None:
        return []
    rng = np.random.default_rng(seed)

    def torque(share: float) -> np.ndarray:
        return model_torque(found.model, noisy(motion, share, rng))

    plain = torque(0.0)
    return [torque(1.0) - plain for _ in range(_DRAWS)]


def _drawn_power(motion: Motion, drawn: list[np.ndarray]) -> np.ndarray:
    """Power (T', n) below the torque cutoff that the doubt of the motion makes."""
    if not drawn:
        return np.zeros((len(motion.decimator.kept(len(motion.t))), motion.q.shape[1]))
    power = np.mean([motion.decimator.apply(x) ** 2 for x in drawn], axis=0)
    # Where a joint stands after it moved a running sum goes below zero.
    return np.maximum(scipy.ndimage.uniform_filter1d(power, _ROWS, axis=0), 0.0)


def row_weight(found: Estimate, doubt: np.ndarray | None = None) -> np.ndarray:
    """Weights (T, n) of a fit's rows: those whose motion is in doubt, as where a joint sticks, say less."""
    doubt = row_doubt(found) if doubt is None else doubt
    relative = doubt.min(axis=0) / doubt
    return relative * robust_weight(found.fit.residual * relative, found.regression.whole_rows)


def robust_weight(residual: np.ndarray, whole: np.ndarray | None = None) -> np.ndarray:
    """Weights (T, n) of rows: one over the joint's noise, less where the residual is beyond its reach.

    ``whole``: Rows that count whole, (T, n), which tell the noise; None: all.
    """
    size = np.abs(residual)
    told = residual if whole is None else residual * whole
    noise = np.maximum(usual_size(told), 1e-6 * size.max(axis=0) + 1e-300)
    return np.minimum(1.0, _REACH * noise / np.maximum(size, 1e-300)) / noise
