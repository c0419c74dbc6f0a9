"""Whether torque and motion of a log belong together, for all of it or but for a time that something pushed."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from jaxswarm.identify.checks.channels import enough
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import Samples, samples_of
from jaxswarm.identify.checks.sound import UNRELATED, Tried
from jaxswarm.logs.finding import Finding
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.runs import runs
from jaxswarm.robot.model import Robot

__all__ = ["NO_RELATION", "Relation", "relation_of", "unrelated_by_few", "without_relation"]

NO_RELATION = "no_relation"
# Rows per parameter that a fit has to have before it tells that nothing at all is explained: noise has no band,
# which leaves few rows of it, and no clean log leaves more than a third.
_ROWS = 2.0
# Share of the torque left from which on motion explains nothing of so few joints: one law may rule them.
_FEW_UNRELATED, _FEW = 0.8, 2
# Without its worst stretches, each this part of the log, five at most, a log that a hard push hid leaves less
# than this share of the torque: of two, of a hand for 1.5 s and of a wall, 0.64 and 0.86 was left, 0.17 without
# two and three of them. Torques a third of the log too late leave 0.58 and more, noise all of it.
_STRETCH, _MOST, _BELONGS = 0.07, 5, 0.3
# Time [s] over which what is left counts as one: a push lasts longer than a row.
_LASTS = 0.5


class Relation(NamedTuple):
    """What a log's motion tells of its torque.

    Attributes:
        found: What is told of it; None: motion explains it.
        belongs: The samples that belong together, without those of a push; None: none do.
    """

    found: Finding | None
    belongs: Samples | None


def relation_of(robot: Robot, rough: Rough) -> Relation:
    """Whether motion explains nothing of the torque, as of noise, or of torques of another log.

    Args:
        robot: Kinematics.
        rough: A rough fit to rows of the log.
    """
    samples, (logged, sigma) = rough.samples, rough.as_logged()
    if logged.size < (_FEW_UNRELATED if robot.num_joints <= _FEW else UNRELATED):
        return Relation(None, samples)
    what = (
        f"rigid body, friction and springs leave {100 * min(logged.size, 1.0):.0f} % of the torque"
    )
    apart = _but_for_pushes(robot, rough, logged, sigma)
    if apart is None:
        what += ": torque and motion do not belong together"
        remedy = "Check units, signs, clock and the order of the columns"
        return Relation(Finding(NO_RELATION, what, remedy, refused=False), None)
    kept, left = apart
    first, past = runs(~kept)
    ends = zip(samples.t[first], samples.t[past - 1], strict=True)
    times = ", ".join(f"{a:.4g} to {b:.4g} s" for a, b in ends)
    what += f", {100 * left:.0f} % without {times}: something else acts there"
    remedy = "Leave that time out, or let diagnose look for a push"
    return Relation(Finding(NO_RELATION, what, remedy, refused=False), samples.taken(kept))


def without_relation(robot: Robot, motions: Sequence[Motion]) -> list[str]:
    """A sentence if torques and motions of all logs have nothing to do with each other."""
    found = unrelated_by_few(robot, samples_of(motions))
    return [f"{one.what}; {one.remedy[0].lower()}{one.remedy[1:]}" for one in found]


def unrelated_by_few(robot: Robot, samples: Samples) -> list[Finding]:
    """What is told of torques and motions without relation, on fewer rows than other checks need."""
    if not enough(robot, samples, _ROWS):
        return []
    relation = relation_of(robot, Rough(robot, samples))
    return [] if relation.found is None or relation.belongs is not None else [relation.found]


def _but_for_pushes(
    robot: Robot, rough: Rough, found: Tried, sigma: np.ndarray
) -> tuple[np.ndarray, float] | None:
    """The rows (R,) without a few stretches, of which motion explains the torque, and what it leaves of it.

    One stretch after the other, that which is explained worst by a fit without those before: ``rough`` with
    what it leaves and its weights.
    """
    whole = rough.samples
    kept = np.ones(len(whole.t), bool)
    length = max(int(_STRETCH * len(kept)), 1)
    for _ in range(_MOST):
        first = _worst(rough.samples.t, rough.residual(sigma) / (found.left * rough.spread), length)
        kept[np.flatnonzero(kept)[first : first + length]] = False
        samples = whole.taken(kept)
        if not enough(robot, samples, _ROWS):
            return None
        rough = Rough(robot, samples)
        found, sigma = rough.as_logged()
        if found.size < _BELONGS:
            return kept, found.size
    return None


def _worst(t: np.ndarray, left: np.ndarray, length: int) -> int:
    """First row of the stretch of so many rows in which most is left, (R, n) in its own standard deviations."""
    window = max(int(_LASTS / np.median(np.diff(t))), 1)
    power = uniform_filter1d(np.square(left).sum(axis=1), window)
    return int(np.argmax(np.convolve(power, np.ones(length), "valid")))
