"""Widths that stay as the declared model has them: of joints whose own torque is no better by others.

Within what width of the velocity a sign turns, a log with few slow samples tells to a factor of two, so that
joints share what they tell together, and on motion at rest it is worth more than all else. Whatever is added
moves the width of all by what it does to one. An offset that one joint of a world lacked (w3909) took that from
0.0102 to 0.0073 rad/s, since that joint's sign is sharp; the torque of another one, whose own is 0.017, was
left with more by it, and its error of point-to-point motion rose from 0.14 to 0.22 N m.

A width that is shared is told by all who share it: where they tell it from the declared one beyond chance, it
stays for all of them. One joint of a practice log (q13) was left with less by the declared 0.0084 rad/s than by
0.0096, by less than two standard errors, all six with far more; with it that joint had 2.6 times the error of
point-to-point motion (0.010 is true). Where they do not, joints on which nothing was added keep what they had:
beside friction by the load of one joint (w3853) the width of the next one, known to 7 %, moved by 2.5 %, which
its torque tells by 0.4 standard errors, and its error of point-to-point motion rose by a third.
"""

from collections.abc import Callable, Sequence

import numpy as np

from jaxswarm.diagnose.decision.rules import SAVED
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.alike import lacking
from jaxswarm.identify.estimation.estimate import Estimate, estimate
from jaxswarm.identify.estimation.sign_width import sharing, width_groups


def keep_declared_widths(search: Search, alone: Callable[[], Estimate]) -> None:
    """Leave the signs of joints whose own torque is not better by another one the declared model's width.

    Args:
        search: With everything added, its model within its bounds. Nothing is done where friction holds joints
            in rows that are left out, which say what the widths are.
        alone: Gives the fit of the declared model.
    """
    current = search.current
    if search.sticking or not any(t.law.uses_direction for t in search.declared.model.terms):
        return
    told = alone()
    groups = width_groups(told.model.robot, told.model.terms, told.motions)
    width = np.array(current.model.width)
    joints = np.array(
        [j for group in groups for j in group if told.model.width[j] != width[j]], int
    )
    declared = np.array(told.model.width)
    del told
    if not len(joints):
        return
    left, weight = _left(current), current.fit.sigma**-2.0
    # Two standard errors of one number, in weighted squares, of rows that are no independent ones.
    chance = SAVED * current.fit.residual.size / search.folds.effective
    parts, acted = sharing(groups, current.model.width), _acted_on(search)
    while len(joints):
        trial = width.copy()
        trial[joints] = declared[joints]
        after = _at_width(current, trial)
        more = (_left(after) - left) * weight
        kept = _kept(parts, joints, more, acted, chance)
        if len(kept) < len(joints):
            joints = kept
            continue
        if more.sum() <= chance:
            search.go_on(after)
        return


def _kept(
    parts: Sequence[tuple[int, ...]],
    joints: np.ndarray,
    more: np.ndarray,
    acted: np.ndarray,
    chance: float,
) -> np.ndarray:
    """Those of some joints that keep the declared width.

    Args:
        parts: Joints that share a width.
        joints: Those asked.
        more: What the declared widths leave more of every joint, in weighted squares, (n,).
        acted: Whether something was added that acts on a joint, (n,).
        chance: What is told by no more than this is not told.
    """
    told: list[int] = []
    for part in parts:
        asked = [j for j in part if j in joints]
        if more[asked].sum() <= chance:
            told += [j for j in asked if more[j] < 0.0 or not acted[j]]
    return np.array(sorted(told), int)


def _acted_on(search: Search) -> np.ndarray:
    """Whether something was added that acts on a joint, on its partner or on the whole arm, (n,)."""
    acted = np.zeros(search.current.model.robot.num_joints, bool)
    for term in lacking(search.current.model.terms, search.declared.model.terms):
        if term.joint is None:
            acted[:] = True
        else:
            acted[[j for j in (term.joint, term.other) if j is not None]] = True
    return acted


def _left(found: Estimate) -> np.ndarray:
    """Sum of the squares that a fit leaves of every joint, (n,)."""
    return np.square(found.fit.residual).sum(axis=0)


def _at_width(current: Estimate, width: np.ndarray) -> Estimate:
    """The same model fitted with other widths (n,), which stay and are not known."""
    model = current.model
    return estimate(
        model.robot,
        model.terms,
        current.motions,
        width=tuple(map(float, width)),
        refine_width=False,
        known_width=False,
        bounded=bool(current.fit.at_bound.any()),
        rigids=current.rigids,
        start=np.asarray(model.robot.parameters).ravel(),
        near=model.terms,
    )
