"""Joints that a law may couple: which are asked, and what a partner's rows say while a joint is searched.

Rows of a partner that is not explained yet say nothing of the arm.
What is stored between two joints acts on both. Its torque on one bends the parameters of the arm that both
joints share, and by them what is seen of it on the other: of a cable over a pulley the right form left four
times the noise of its joint so, and 1.2 times without the partner's rows.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.folds.partial_out import CrossFit, Fold

# A partner, None for none, and the fields besides the motion that a search is given.
Variables = tuple[int | None, list[str]]
# Joints that are asked as partners where nothing was named: what lies further is rarely tied to a joint.
_NEIGHBORS = 2


def named_partners(joint: int, depends_on: Sequence[str], joints: Sequence[str]) -> list[Variables]:
    """Partners and further fields, as what a residual depends on names them: one search each.

    A motor warms up with time, so that one log names either: where time is named its temperature is asked, too.

    >>> named_partners(0, ("q_elbow", "t"), ("shoulder", "elbow"))
    [(1, ['t', 'temperature'])]
    """
    own = joints[joint]
    named = [name.split("_", 1) if "_" in name else [name, own] for name in depends_on]
    wanted = [quantity for quantity, _ in named if quantity in ("t", "temperature")]
    if "t" in wanted and "temperature" not in wanted:
        wanted.append("temperature")
    partners = dict.fromkeys(joints.index(place) for _, place in named if place != own)
    return [(partner, wanted) for partner in partners] or [(None, wanted)]


def neighbors(joint: int, named: Sequence[Variables], joints: int) -> list[Variables]:
    """Partners beside those that were named: of a product of two variables a residual may name none, or others.

    sin(q) exp(-(dq/s)^2) of the next joint left 4.7 times the noise, and no variable by itself told any of it;
    of abs(q dq) of one joint in a drag on another the residual named the position of a third.

    >>> neighbors(2, [(None, [])], 6)
    [(1, []), (3, [])]
    """
    known, wanted = {partner for partner, _ in named}, named[0][1]
    nearest = sorted((k for k in range(joints) if k != joint), key=lambda k: abs(k - joint))
    return [(k, wanted) for k in nearest[:_NEIGHBORS] if k not in known]


def without_joint(crossfit: CrossFit, joint: int) -> CrossFit:
    """The folds of the same model, fitted without the rows of a joint."""
    kept = np.arange(crossfit.weight.shape[1]) != joint

    def fitted(fold: Fold) -> Fold:
        seen = replace(
            fold, project=fold.project * kept[:, None], residual=np.where(kept, fold.residual, 0.0)
        )
        return seen.trained_on(fold.train)

    whole, one, two = map(fitted, crossfit.folds)
    return replace(
        crossfit, weight=crossfit.weight * kept, whole=whole, halves=(one, two), structure={}
    )
