"""Events of one joint that are a matter of its place: other logs have as much wherever it comes there again."""

from collections.abc import Iterator, Sequence

import numpy as np

from jaxswarm.diagnose.decision.rules import AS_MUCH, MOST_VISITS
from jaxswarm.diagnose.decision.smooth_rows import table_of
from jaxswarm.diagnose.selection.elsewhere import at_rows, log_residual
from jaxswarm.diagnose.selection.event_at_rest import rows_within
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.runs import runs

# Visits of other logs that tell: one may be pushed there as well.
_VISITS = 2
# Share of the rows of an event that go one way: visits count that go this way, too.
_ONE_WAY = 0.9


def of_place(
    current: Estimate, joint: int, events: Sequence[Term], other: Sequence[Motion]
) -> str | None:
    """Why an event of a joint alone is a matter of its place; None if no other log tells so of any.

    A detent that a log came through once, in 0.4 s, was told as a contact; the other log came there three
    times, and left as much each time.

    Args:
        current: The fit, with the events.
        joint: On which they act.
        events: Those that act on it alone.
        other: Logs that are not fitted.
    """
    if not other:
        return None
    robot, table = current.model.robot, table_of(current)
    name = robot.joints[joint]
    if not {f"q_{name}", f"dq_{name}"} <= set(table):
        return None
    own = np.stack([table[f"q_{name}"].raw, table[f"dq_{name}"].raw], axis=1)
    log = np.where(
        np.any([rows_within(current, event) for event in events], axis=0),
        -1,
        current.regression.log,
    )
    left = current.fit.residual[:, joint]
    here = [(own[log == one], left[log == one]) for one in np.unique(log[log >= 0])]
    logs = [(_states(m, joint), log_residual(current, m)[:, joint]) for m in other]
    for event in events:
        there = own[rows_within(current, event)]
        torque = event.values[event.linear_names(robot.joints)[joint]]
        if not len(there):
            continue
        elsewhere, again = (
            [visit / torque for states, rest in some for visit in _left_at(there, states, rest)]
            for some in (logs, here)
        )
        ratios = np.array([*elsewhere, *again])
        if len(elsewhere) >= _VISITS and np.mean(ratios >= AS_MUCH) >= MOST_VISITS:
            return (
                f"lies at {there[:, 0].min():.3g} to {there[:, 0].max():.3g} of q_{name}, where as much is "
                f"left in {int((ratios >= AS_MUCH).sum())} of {len(ratios)} other visits"
            )
    return None


def _states(motion: Motion, joint: int) -> np.ndarray:
    """Position and velocity of a joint at the rows of :func:`log_residual`, (T, 2)."""
    return at_rows(motion, np.stack([motion.q[:, joint], motion.dq[:, joint]], axis=1))


def _left_at(there: np.ndarray, states: np.ndarray, left: np.ndarray) -> Iterator[float]:
    """Mean of a residual (T,) in every visit of the places of ``there``, by position and velocity (T, 2)."""
    way = np.sign(there[:, 1]).mean()
    inside = (states[:, 0] >= there[:, 0].min()) & (states[:, 0] <= there[:, 0].max())
    if abs(way) >= _ONE_WAY:
        inside &= np.sign(states[:, 1]) == np.sign(way)
    for begin, end in zip(*runs(inside), strict=True):
        yield float(left[begin:end].mean())
