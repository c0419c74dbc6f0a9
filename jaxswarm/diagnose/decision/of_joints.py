"""Laws of single joints that together say what one law of the arm seems to.

A law that shows on many joints gains on all of them at once, and each law of a joint on its own alone: of an
offset on one joint and a friction that differs by direction on a slide, a tilted base took nearly twice what
either took, and left twice the noise on both.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.score import score
from jaxswarm.diagnose.decision.worth import Score, adds
from jaxswarm.diagnose.folds.partial_out import CrossFit


def told_by_joints(arm: Score, passed: Sequence[Score], rules: Rules, crossfit: CrossFit) -> bool:
    """Whether laws of joints, two or more of those that passed, say all that a law of the arm does, and more.

    Each gains more on its joint than the law of the arm does there, and explains what that leaves, while it
    explains nothing that they leave together: encompassing as in
    :func:`jaxswarm.diagnose.decision.competing.beats`.
    """
    if arm.own is not None:
        return False
    beside_arm = crossfit.with_columns(arm.candidate.columns)
    joints: list[int] = []
    left, beside = arm, crossfit
    while adds(left, rules):
        joint = int(np.argmax(left.per_joint))
        found = _best_on(joint, passed, beside_arm, rules)
        if found is None or joint in joints or found.worth <= arm.per_joint[joint]:
            return False
        joints.append(joint)
        beside = beside.with_columns(found.candidate.columns)
        left = score(arm.candidate, beside)
    return len(joints) > 1


def _best_on(
    joint: int, passed: Sequence[Score], beside_arm: CrossFit, rules: Rules
) -> Score | None:
    """The law of a joint that gains most there of those that explain what the law of the arm leaves."""
    here = [s for s in passed if s.own is not None and s.joint == joint]
    left = [(s, score(s.candidate, beside_arm)) for s in here]
    told = [s for s, beside in left if adds(beside, rules) and beside.share >= rules.share]
    return max(told, key=lambda s: s.worth, default=None)
