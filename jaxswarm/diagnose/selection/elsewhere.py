"""Two models on motion that neither was fitted to: other logs, or regions of states held out of one log."""

from collections.abc import Iterator, Sequence

import numpy as np

from jaxswarm.diagnose.decision.rules import CERTAIN, EVENTFUL, GAIN, KNOWN
from jaxswarm.diagnose.folds.other_motion import regions
from jaxswarm.effects.alike import lacking
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.standing import held as held_at_rest
from jaxswarm.identify.estimation.standing import mixed_with, standing
from jaxswarm.identify.estimation.validate import held_out_residual, known_without, outside
from jaxswarm.identify.forward.begun import in_state_of
from jaxswarm.identify.forward.link_lag import slope_terms, unseen_rows
from jaxswarm.identify.forward.metrics import is_moving
from jaxswarm.identify.forward.model import (
    Model,
    linear_values,
    model_torque,
    with_linear_values,
)
from jaxswarm.identify.forward.names import column_names
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.runs import runs
from jaxswarm.logs.shifted import with_skew_of

# Time [s] at either end of another log that is left out.
_ENDS = 0.25
# Stretches of a log whose errors count as independent.
_BLOCKS = 20
# Pieces of such a stretch, by which it is told where in it something begins or ends.
_PIECES = 10
# Sets of parameters that are drawn: what they say of an error is within a fifth of it.
_DRAWS = 16


def errors_elsewhere(
    before: Estimate, after: Estimate, other: Sequence[Motion]
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, str]]:
    """RMS errors (n,) of two fits, whether they fall, whether they rise, and on what motion.

    Nothing where there is none.
    """
    if other:
        for motion in other:
            yield *compared(*residuals_on(before, after, motion)), "on " + motion.source
        return
    label = regions(before)
    if label is None or len(label) != len(after.regression.torque):
        return
    used = rows_of_both(before, after)
    rows = used.any(axis=1) & np.isin(label, _telling(before, after, label))
    if not rows.any():
        return
    left = (np.where(used, held_out_residual(e, block=label), 0.0) for e in (before, after))
    one, two = (x[rows] for x in left)
    moving = before.regression.moving[rows]
    yield *compared(one, two, moving), "on held-out regions of the motion"


def added_columns(before: Estimate, after: Estimate) -> set[str]:
    """Names of the columns of what a fit has and one before it has not."""
    joints = after.model.robot.joints
    added = lacking(after.model.terms, before.model.terms)
    return {name for term in added for name in term.columns(joints)}


def _telling(before: Estimate, after: Estimate, label: np.ndarray) -> np.ndarray:
    """The regions without which the rest of the log still tells of what was added.

    A joint that went up in two moves of one region and down in all others was refused the friction of its
    direction, which took 92 to 99.6 % off their squared errors, for what the rest knew nothing of.
    """
    known = known_without(after, added_columns(before, after), label)
    return np.unique(label)[np.array(known) > KNOWN]


def residuals_on(
    before: Estimate, after: Estimate, motion: Motion
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Residuals of two fits on another log, and whether each joint moves, (T, n) each, at the same rows.

    Where a link on a spring of either may swing by what was before the log, neither is compared, nor where
    an event was, nor a joint that dry friction holds.
    """
    one, two, held = _both(before, after, motion)
    times = at_rows(motion, motion.t)
    seen = outside(times, _eventful(one, two, held, times))
    if slope_terms((*before.model.terms, *after.model.terms)):
        seen &= ~unseen_rows(motion)[_inside(motion)]
    one, two = (np.where(held, 0.0, x)[seen] for x in (one, two))
    return one, two, at_rows(motion, is_moving(motion.dq))[seen]


def event_windows(
    before: Estimate, after: Estimate, motion: Motion
) -> tuple[tuple[float, float], ...]:
    """Stretches of another log [s] in which two models leave far more than in most of it.

    What happened there, such as a contact, is in neither model, and hides what the rest of the log shows: a
    push of 0.8 s had true Stribeck friction of another log refused.
    """
    times = at_rows(motion, motion.t)
    # What lasts to the first or last row that is compared may last to that end of the log.
    times[[0, -1]] = motion.t[[0, -1]]
    return _eventful(*_both(before, after, motion), times)


def _both(
    before: Estimate, after: Estimate, motion: Motion
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Residuals of two fits on another log, and whether friction holds a joint at rest by both, (T, n) each."""
    one, two = (log_residual(e, motion) for e in (before, after))
    return one, two, _held(motion, np.minimum(np.abs(one), np.abs(two)))


def _held(motion: Motion, left: np.ndarray) -> np.ndarray:
    """Whether dry friction holds a joint on the rows of :func:`log_residual`, which leaves so much, (T, n)."""
    rest = standing([motion])
    mixed = mixed_with([motion], rest)[0][_inside(motion)]
    still = rest[0][_inside(motion)]
    return still & held_at_rest(left, [still], [mixed])


def _eventful(
    one: np.ndarray, two: np.ndarray, held: np.ndarray, times: np.ndarray
) -> tuple[tuple[float, float], ...]:
    """The same from two residuals (T, n) at times (T,), but for what friction holds.

    What happens begins and ends within a stretch, of which it may be a small part: half a second with a load
    before the first stretch full of it left 5 % of the torque of a log that was right to 0.3 %. Next to such a
    stretch its pieces are therefore asked, too.
    """
    squares = np.ma.array(np.minimum(one**2, two**2), mask=held)
    count = min(_BLOCKS, len(one))
    parts = np.array_split(np.arange(len(one)), count)
    power = np.ma.stack([squares[rows].mean(axis=0) for rows in parts])
    # The lower one of two middles: what lasts half of the log is not what is usual.
    free = [x.compressed() for x in power.T]
    most = EVENTFUL * np.array(
        [np.quantile(x, 0.5, method="lower") if len(x) else np.inf for x in free]
    )

    def beyond(power: np.ndarray) -> np.ndarray:
        return np.any(np.ma.filled(power > most, False), axis=-1)

    eventful = beyond(power)
    seen = np.repeat(eventful, [len(rows) for rows in parts])
    follows, precedes = np.append(False, eventful[:-1]), np.append(eventful[1:], False)
    for number in np.flatnonzero(~eventful & (follows | precedes)):
        pieces = np.array_split(parts[number], min(_PIECES, len(parts[number])))
        inside = [rows for rows in pieces if beyond(squares[rows].mean(axis=0))]
        if inside and follows[number]:
            seen[parts[number][0] : inside[-1][-1] + 1] = True
        if inside and precedes[number]:
            seen[inside[0][0] : parts[number][-1] + 1] = True
    return tuple((float(times[i]), float(times[j - 1])) for i, j in zip(*runs(seen), strict=True))


def compared(
    one: np.ndarray, two: np.ndarray, moving: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """RMS (n,) of two residuals (T, n), whether it falls, and whether it rises.

    It falls over all rows, or where the joint moves: a joint that stands is held by friction of any size up to
    its limit, which no law predicts; on measured strain-wave gears that is nine tenths of the error of
    point-to-point motion, and hides what the rest shows. It rises if that is no chance of a few stretches: on
    a short log of a world a play that halved the error of all other motion raised that of the next joint by
    two fifths in regions that the rest of the log did not tell.
    """
    all_rows = rms(one), rms(two)
    in_motion = (rms(np.where(moving, x, 0.0)) for x in (one, two))
    # A joint that never moves leaves nothing either way, which is no fall.
    falls = [(b <= GAIN * a) & (b < a) for a, b in (all_rows, tuple(in_motion))]
    blocks = np.array_split(two**2 - one**2, min(_BLOCKS, len(one)))
    rise = np.array([block.sum(axis=0) for block in blocks])
    doubt = rise.std(axis=0, ddof=1) * np.sqrt(len(rise))
    return *all_rows, falls[0] | falls[1], rise.sum(axis=0) > CERTAIN * doubt


def _inside(motion: Motion) -> np.ndarray:
    """The decimated rows of a log without its ends; all of them where nothing else is left."""
    kept = motion.t[motion.decimator.kept(len(motion.t))]
    inside = (kept > kept[0] + _ENDS) & (kept < kept[-1] - _ENDS)
    return inside if inside.any() else np.ones_like(inside)


def at_rows(motion: Motion, x: np.ndarray) -> np.ndarray:
    """What is known of all samples (T, ...) at the rows of :func:`log_residual`, (T', ...)."""
    return x[motion.decimator.kept(len(motion.t))][_inside(motion)]


def log_residual(found: Estimate, motion: Motion, model: Model | None = None) -> np.ndarray:
    """Residual of a log by the clocks of the fit, without the ends, where accelerations are worst known."""
    motion = with_skew_of(motion, found.motions[0])
    model = in_state_of(model or found.model, [motion])
    predicted = model_torque(model, motion)
    left = motion.decimator.apply(motion.tau - predicted)
    return left[_inside(motion)]


def expected(motion: Motion, noise: np.ndarray, *fits: Estimate) -> np.ndarray:
    """The most (n,) that fits are expected to leave of another log: noise, and how far each may be off.

    Ten seconds of one cycle told so little of the inner joints that the declared model was 9 times their noise
    off on another log, as its covariance says. True friction of the last joint, which took 99.9 % off that
    joint's squared error there, was refused since it changed what chance had drawn on theirs. The least
    doubt of them counts: what a model lacks makes its doubt too large, as does a law that is not told.

    Args:
        motion: The log.
        noise: Of every joint, (n,) [N m or N].
        fits: One or more.
    """
    doubt = np.min([_doubt(one, motion) for one in fits], axis=0)
    return np.sqrt(noise**2 + (CERTAIN * doubt) ** 2)


def _doubt(found: Estimate, motion: Motion) -> np.ndarray:
    """RMS standard error (n,) of the torque that a fit predicts, by parameters drawn by their covariance."""
    model, rng = found.model.during(None), np.random.default_rng(0)
    if model.uncertainty is None:
        return np.zeros(model.robot.num_joints)
    covariance = model.uncertainty.on(column_names(model.robot, model.terms))
    size, axes = np.linalg.eigh(covariance)
    root, here = axes * np.sqrt(np.maximum(size, 0.0)), linear_values(model)
    left = log_residual(found, motion)
    power = []
    for _ in range(_DRAWS):
        other = with_linear_values(model, here + root @ rng.standard_normal(len(here)))
        power.append(((log_residual(found, motion, other) - left) ** 2).mean(axis=0))
    doubt = np.sqrt(np.mean(power, axis=0))
    return np.where(np.isfinite(doubt), doubt, 0.0)  # a link that runs away says nothing


def rms(x: np.ndarray) -> np.ndarray:
    """Root mean square over rows (T, n): (n,)."""
    return np.sqrt((x**2).mean(axis=0))


def rows_of_both(before: Estimate, after: Estimate) -> np.ndarray:
    """Rows of every joint, (T, n), that both fits use."""
    return before.regression.used_rows & after.regression.used_rows
