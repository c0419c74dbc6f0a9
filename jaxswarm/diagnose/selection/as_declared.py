"""Widths that stay as the declared model has them: of joints whose own torque is no better by others.

Within what width of the velocity a sign turns, a log with few slow samples tells to a factor of two, so that
joints share what they tell together, and on motion at rest it is worth more than all else. Whatever is added
moves the width of all by what it does to one. An offset that one joint of a world lacked (w3909) took that from
0.0102 to 0.0073 rad/s, since that joint's sign is sharp; the torque of another one, whose own is 0.017, was
left with more by it, and its error of point-to-point motion rose from 0.14 to 0.22 N m.
"""

from collections.abc import Callable

import numpy as np

from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.identify.estimation.estimate import Estimate, estimate
from jaxswarm.identify.estimation.sign_width import width_groups


def keep_declared_widths(search: Search, alone: Callable[[], Estimate]) -> None:
    """Leave the signs of joints whose own torque is not better by another one the declared model's width.

    A width that a joint was given for itself is better there as it is: what is asked is one that it shares.

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
    declared = np.array(told.model.width)[joints]
    del told
    if not len(joints):
        return
    trial = width.copy()
    trial[joints] = declared
    better = _left(_at_width(current, trial)) < _left(current)
    if not better[joints].any():
        return
    width[joints] = np.where(better[joints], declared, width[joints])
    after = _at_width(current, width)
    if (_left(after) / current.fit.sigma**2).sum() < (_left(current) / current.fit.sigma**2).sum():
        search.current = with_motion_noise(after, search.seed)
        search.crossfit = cross_fit(search.current)


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
