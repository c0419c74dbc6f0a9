"""Logs on which nothing can be decided: a result that says why, before anything is fitted."""

from collections.abc import Sequence

from jaxswarm.diagnose.decision.insufficient import undecidable
from jaxswarm.diagnose.report.place import place
from jaxswarm.effects.term import Term
from jaxswarm.identify.checks.relation import without_relation
from jaxswarm.identify.checks.weak import WEAK, all_rest, resting_joints, too_short
from jaxswarm.identify.report.summary import units
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot


def undecided_by(
    motions: Sequence[Motion], robot: Robot, terms: tuple[Term, ...], accept: Sequence[str]
) -> dict | None:
    """``diagnosis.json`` of logs that cannot decide anything; None if they can.

    They are too short for the parameters, rest, or have torques that have nothing to do with their motion.

    Args:
        motions: Prepared logs with torque.
        robot: Kinematics.
        terms: Declared effects.
        accept: Findings in spite of which logs are used, by name.
    """
    columns = 10 * robot.num_joints + sum(len(t.columns(robot.joints)) for t in terms)
    short = [] if WEAK in accept else too_short(motions, columns)
    rests = all_rest(motions)
    if not rests and "no_relation" not in accept:
        rests = without_relation(robot, motions)
    if not short and not rests:
        return None
    declared = [place(t, robot.joints) for t in terms]
    reasons = [*rests, *short, *resting_joints(motions, robot)]
    return undecidable(robot, declared, units(robot), reasons)
