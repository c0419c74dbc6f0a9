r"""The clocks of torque and position, which every sampled and held torque has apart by a part of a sample.

A model's torque at positions that are stamped :math:`s` too early is its torque :math:`s` earlier,
:math:`\tau(t - s) \approx \tau(t) - s\,\dot\tau(t)`: one more column, whose coefficient is the skew. It matters
where nothing else does: with 0.3 samples that were not allowed for, friction of a clean world was 10 % off,
and the error on unseen motion four times as large (A. Janot, M. Gautier, M. Brunot, 2019, on the EMPS).

Clocks move all of a torque alike. Dry friction has a time of its own besides: a bristle turns after the
velocity does, friction of MuJoCo 6 to 17 ms before it, on every joint of nine clean arms. Where all of the
torque had to say when it was read, that came out as up to 6.6 ms, and once as an arm with a delay; with
friction free to be early or late by itself, on most of them as less than 2 ms.
"""

from collections.abc import Callable

import numpy as np

from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import CLOCKS_APART, Estimate, estimate
from jaxswarm.identify.estimation.starts import with_starts
from jaxswarm.identify.estimation.time_slopes import (
    CERTAIN_CLOCK,
    MOST_ROWS,
    SMALL_STEP,
    asked_rows,
    told_time,
    weight_slopes,
)
from jaxswarm.identify.estimation.weight_clock import weight_step
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.segments import stretch
from jaxswarm.logs.shifted import shift_motion
from jaxswarm.robot.model import Robot

# Each step makes a new fit: a first one, one for what it changed, one to see that nothing is left.
_STEPS = 3
# Rows of a log from which on two fits of it are too large.
_LONG = 5 * MOST_ROWS


def clock_skew(found: Estimate, heavy: float = 0.0) -> tuple[float, float]:
    """Time [s] by which the torque is read after the position, beyond what is allowed for, and its error.

    Args:
        found: A fit.
        heavy: Time [s] by which the weight lags beyond what is allowed for: then, or where some is allowed for,
            it has a clock of its own.

    Returns:
        The skew and its standard error, both zero where torques do not change.
    """
    rows = asked_rows(found)
    columns = rows.slope[:, :, None]
    if heavy or found.motions[0].weight_skew:
        weight = weight_slopes(found)[rows.asked]
        columns = np.concatenate([weight[:, :, None], columns], axis=2)
    return told_time(found, rows, columns)


def shrunk(seconds: float, doubt: float) -> float:
    """A time shrunk by its certainty: nothing where there is nothing (W. James, C. Stein, 1961)."""
    return seconds * max(0.0, 1.0 - (doubt / seconds) ** 2) if seconds else 0.0


def credited(seconds: float, doubt: float, interval: float) -> float:
    """A time between two clocks as far as it is told, beside what is known of clocks without any log.

    They are apart by a part of a sample (``CLOCKS_APART``). Beside friction that a joint lacked, a skew of
    -4.6 +- 2.4 ms and two more, each shrunk by its own certainty alone, moved clocks that are not apart by
    7.7 ms, nearly two samples, and a bristle was told for what that left on another joint.

    Args:
        seconds: The time [s], with all that is allowed for.
        doubt: Its standard error [s].
        interval: Of the samples [s].

    >>> round(1e3 * credited(-4.6e-3, 2.4e-3, 4e-3), 2), round(1e3 * credited(3e-3, 1e-4, 4e-3), 2)
    (-0.63, 2.97)
    """
    usual = (CLOCKS_APART * interval) ** 2
    return shrunk(seconds, doubt) * usual / (usual + doubt**2)


def with_skew(
    found: Estimate, seconds: float, weight: float = 0.0, bounded: bool = False
) -> Estimate:
    """The same model fitted to logs whose motion is moved against the torque, and against its weight alone."""
    model = found.model
    return estimate(
        model.robot,
        model.terms,
        tuple(shift_motion(m, seconds, weight) for m in found.motions),
        width=model.width,
        refine_width=True,
        bounded=bounded,
        start=np.asarray(model.robot.parameters).ravel(),
        near=model.terms,
    )


def estimate_with_clocks(robot: Robot, terms: tuple[Term, ...], motions: list[Motion]) -> Estimate:
    """The fit of declared terms within their bounds, with its clocks.

    Of long logs the clocks are found on a stretch, and the logs are moved one by one: two fits of all rows need
    twice the memory.

    Args:
        robot, terms: As for :func:`estimate`.
        motions: Prepared logs; long ones are taken out of the list.
    """
    longest = max(motions, key=lambda m: len(m.t))
    if len(longest.t) <= _LONG * longest.decimator.factor:
        terms = with_starts(robot, terms, motions)
        return with_clocks(estimate(robot, terms, motions), bounded=True)
    reach = MOST_ROWS * longest.decimator.factor // 2
    middle = len(longest.t) // 2
    part = stretch(longest, middle - reach, middle + reach)
    terms = with_starts(robot, terms, [part])
    told = with_clocks(estimate(robot, terms, [part]), bounded=True).motions[0]
    late, heavy = told.skew - part.skew, told.weight_skew - part.weight_skew
    moved = []
    while motions:
        moved.append(shift_motion(motions.pop(0), late, heavy))
    return estimate(robot, terms, moved)


def with_clocks(
    found: Estimate,
    bounded: bool = False,
    moved_by: Callable[[Estimate, float, float, bool], Estimate] = with_skew,
) -> Estimate:
    """The fit with its clocks where they fit best, where that is certain and below one sample.

    A delay beyond a sample is a matter of the robot and not of its clocks: it is left to be told as such.

    Args:
        found: A fit, or a model that is held.
        bounded: Whether physical bounds hold.
        moved_by: What makes of it, by logs that are moved by a time [s], and their weight by one, the next one.
    """
    if any(isinstance(t.law, MeasurementLaw) and t.law.clock for t in found.model.terms):
        return found  # that term says so
    most = min(m.interval for m in found.motions)
    moved = found
    for _ in range(_STEPS):
        heavy = weight_step(moved)
        step, doubt = clock_skew(moved, heavy)
        known = moved.motions[0].skew
        late = 0.0
        if known or abs(step) > CERTAIN_CLOCK * doubt:
            late = shrunk(known + step, doubt) - known
        if known and abs(late) <= SMALL_STEP * doubt:
            late = 0.0
        if not late and not heavy:
            break
        if abs(known + late) > most:
            return found
        moved = moved_by(moved, late, heavy, bounded)
    return moved
