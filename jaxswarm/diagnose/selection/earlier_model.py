"""A model identified before on new logs: nothing is fitted, and how certain it was is kept."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.bends import width_slopes
from jaxswarm.diagnose.folds.noise import row_doubt, with_motion_noise
from jaxswarm.diagnose.folds.partial_out import CrossFit, cross_fit
from jaxswarm.identify.estimation.base_parameters import find_base
from jaxswarm.identify.estimation.clock_skew import with_clocks
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.least_squares import Fit
from jaxswarm.identify.estimation.standing import held, leave_out, mixed_with, standing
from jaxswarm.identify.forward.columns import Rigid, rigid_of
from jaxswarm.identify.forward.measuring_chain import term_block
from jaxswarm.identify.forward.model import Model, linear_values, smooth_torque
from jaxswarm.identify.forward.regression import build_regression
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.shifted import shift_motion

# Errors of parameters with a smaller part of the largest one's power are rounding.
_ROUNDING = 1e-15
# Widths of signs that are tried, as parts of those of the earlier motion.
_WIDTHS = np.geomspace(1.0 / 64.0, 4.0, 17)
# A width is another one where it takes off as much of a joint's squared error as a law has to.
_CLEAR = 1.0 - Rules.share


def freeze(
    model: Model, motions: Sequence[Motion], rigids: tuple[Rigid, ...] | None = None
) -> Estimate:
    """An earlier model on new logs, as an estimate in which nothing was fitted.

    ``rigids`` are the rigid columns of the logs where known.
    """
    rigids = rigids or tuple(rigid_of(model.robot, m) for m in motions)
    pi = np.asarray(model.robot.parameters).ravel()
    # A body that was added is in the last link's parameters, but for one that was carried for a while.
    terms = tuple(t for t in model.terms if t.law.in_one_log or not t.law.reference_only)
    model = replace(model, terms=terms)
    regression = build_regression(model.robot, terms, motions, model.width, pi, rigids)
    theta = linear_values(model)
    smooth = np.concatenate([m.decimator.apply(smooth_torque(model, m)) for m in motions])
    regression = replace(regression, torque=regression.torque - regression.counted(smooth))
    residual = regression.target - regression.columns @ theta
    sigma = regression.rms(residual) + 1e-12
    flat = regression.columns.reshape(-1, regression.columns.shape[2])
    base = find_base(flat, regression.names)
    size = base.size
    frozen = Fit(
        base, base.reduce(theta), np.zeros((size, size)), sigma, np.eye(size), np.zeros(size), 0.0,
        residual, np.zeros(size, bool), float(len(residual)),
    )  # fmt: skip
    errors = tuple({p.name: 0.0 for p in t.law.parameters} for t in terms)
    return Estimate(model, frozen, regression, tuple(motions), rigids, errors)


def on_new_logs(model: Model, motions: Sequence[Motion], seed: int = 0) -> Estimate:
    """The same by these logs' clocks and sign widths, and without the rest in which dry friction holds joints.

    When a torque was read in its sample is no change of an arm, nor is where it came to rest: unchanged arms
    were told to have soft joints or Stribeck friction, and left up to 28 times the noise. What is left at rest
    is compared with motion by the width that motion tells.
    """
    rest = standing(motions)
    mixed = mixed_with(motions, rest)
    moving = [replace(m, held=r) for m, r in zip(motions, mixed, strict=True)]
    found = _with_widths(freeze(model, moving))
    left = freeze(found.model, motions, found.rigids).fit.residual
    fitted = leave_out(motions, rest, held(left, rest, mixed))
    found = _with_widths(freeze(model, fitted, found.rigids))
    return with_doubt(with_clocks(found, moved_by=_moved), seed)


def _with_widths(found: Estimate) -> Estimate:
    """The same with the widths of its signs that these logs tell, one per joint.

    Within which speeds a joint reverses is a matter of its motion as much as of its friction: true stiction
    has no width, and fast motion or a short bristle tells one by what it blurs. On point-to-point motion of
    three unchanged arms a tenth of that of the earlier motion left 0.15 to 0.4 of the error in motion, told
    before as a bristle or Stribeck friction.
    """
    model = found.model
    if not any(t.law.uses_direction for t in model.terms):
        return found
    theta, k = linear_values(model), 10 * model.robot.num_joints
    pi, sizes = theta[:k], [len(t.columns(model.robot.joints)) for t in model.terms]
    own = np.split(theta[k:], np.cumsum(sizes)[:-1])

    def directed(part: float) -> np.ndarray:
        """The torque (T, n) of the laws of the direction with widths that are this part of the present ones."""
        width = tuple(part * w for w in model.width)
        return np.concatenate([
            np.sum([
                term_block(model.robot, model.terms, t, m, width, pi, r) @ values
                for t, values in zip(model.terms, own, strict=True)
                if t.law.uses_direction
            ], axis=0)
            for m, r in zip(found.motions, found.rigids, strict=True)
        ])  # fmt: skip

    rms, residual = found.regression.rms, found.fit.residual
    whole = residual + directed(1.0)
    cost = np.array([rms(whole - directed(part)) ** 2 for part in _WIDTHS])
    clear = cost.min(axis=0) < _CLEAR * rms(residual) ** 2
    if not clear.any():
        return found
    part = np.where(clear, _WIDTHS[cost.argmin(axis=0)], 1.0)
    width = tuple(map(float, part * np.asarray(model.width)))
    return freeze(replace(model, width=width), found.motions, found.rigids)


def with_doubt(found: Estimate, seed: int = 0) -> Estimate:
    """The same with the noise of every row, in which the earlier model's doubt counts as that of the motion.

    A sixth axis of an unchanged arm, told to a percent on other motion, left 3.2 times the noise of this one.
    So does what the model left of its own log beyond the torque's noise: it did not know that friction then,
    and it is no change that it does not know it now. A slide of slow motion that left 18 times the noise was
    told to have got a bristle.
    """
    found = with_motion_noise(found, seed)
    doubt, log = np.sqrt((_doubtful(found) ** 2).sum(axis=2)), found.regression.log
    lacked = lacking(found)
    motions = []
    for k, motion in enumerate(found.motions):
        assert motion.model_noise is not None  # it was drawn
        noise = np.hypot(np.hypot(motion.model_noise, doubt[log == k]), lacked)
        motions.append(replace(motion, model_noise=noise))
    return replace(found, motions=tuple(motions))


def lacking(found: Estimate) -> np.ndarray:
    """What an earlier model left of its own log beyond the noise of the torque's sensor [N m or N], (n,)."""
    own = np.asarray(found.model.sigma)
    told = [0.0 * own if m.torque_noise is None else m.sensor_noise for m in found.motions]
    sensor = np.max(told, axis=0)
    return np.sqrt(np.maximum(own**2 - sensor**2, 0.0))


def held_folds(
    earlier: Estimate,
    found: Estimate,
    doubt_of: Callable[[Estimate], np.ndarray] = row_doubt,
) -> CrossFit:
    """All folds of an earlier model with what changed, which takes up no more than its parameters' doubt.

    The widths of its signs are as free as those of a model that is fitted: they are those of another motion.

    Args:
        earlier: The earlier model on these rows; how certain it was is known.
        found: With what changed.
        doubt_of: The noise of every row by which it counts.
    """
    folds = cross_fit(found, frozen=True, doubt_of=doubt_of)
    columns = np.concatenate([width_slopes(found), _doubtful(earlier)], axis=2)
    if not columns.shape[2]:
        return folds
    return folds.with_columns((folds.weigh(columns),) * len(folds.folds), known=True)


def _doubtful(found: Estimate) -> np.ndarray:
    """What each independent error of the earlier parameters, of one standard deviation, does, (T, n, k)."""
    power, axes = np.linalg.eigh(earlier_covariance(found))
    told = power > _ROUNDING * power[-1:]
    return found.regression.columns @ (axes[:, told] * np.sqrt(power[told]))


def _moved(found: Estimate, seconds: float, weight: float, _: bool) -> Estimate:
    return freeze(found.model, [shift_motion(m, seconds, weight) for m in found.motions])


def earlier_covariance(before: Estimate) -> np.ndarray:
    """Covariance (p, p) of a frozen model's linear parameters; zeros where its file told none."""
    names = before.regression.names
    known = before.model.uncertainty
    return np.zeros((len(names), len(names))) if known is None else known.on(names)
