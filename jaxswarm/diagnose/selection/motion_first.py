"""Laws asked of motion alone first, where what is left at rest is most of what is left.

Where dry friction holds joints at any torque within it, rows at rest may be left with several times what motion
is left with, and a law that is missing in motion is fitted to them. Of six joints whose friction sticks, with a
base tilted by 8 degrees and a soft joint of 4.5 Hz, 2.2 N m were left at rest and 0.4 in motion: the tilt was
found, the spring was fitted as one of sixty times its stiffness, and all ended as "unexplained". So these rows
are lent: laws are asked without them, and with them again once no more is found.

That takes motion that is very far from its noise. Of clean joints whose bristles hold them a little longer than
they hardly move, motion was left with up to four times its noise: a Stribeck friction was told there.
"""

from collections.abc import Callable

import numpy as np

from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import LOST, REST_STANDS_OUT
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.selection.friction_at_rest import (
    left_and_friction,
    left_out,
    rest_exceeds,
    within_friction,
)
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.sticking import (
    fits_of_motion,
    go_on_from,
    leave_out_where_lost,
    loud_joints,
)
from jaxswarm.diagnose.selection.take_back import take_back
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.standing import tells_motion


def found_in_motion(search: Search, run: Callable[[Search], None]) -> Search | None:
    """The search with what motion alone tells, its other rows lent; None if it tells nothing or is not asked.

    Args:
        search: One that has begun.
        run: Runs its rounds.
    """
    if not _lend_rest(search):
        return None
    search.progress("asking what motion alone lacks")
    run(search)
    while not search.given_up and (leave_out_where_lost(search) or take_back(search)):
        run(search)
    return search if search.steps else None


def _lend_rest(search: Search) -> bool:
    """Leave out where joints hardly move, for a while; whether much is left there, and motion lacks a law."""
    current = search.current = with_motion_noise(search.current, search.seed)
    asked = loud_joints(search)
    if not asked:
        return False
    what_moves = fits_of_motion(search)
    moving = what_moves(asked)
    held = asked & set(np.flatnonzero(_stands_out(current, moving)))
    if not held & set(np.flatnonzero(over_noise(moving) > LOST)):
        return False
    search.lent = current.motions
    go_on_from(search, moving if held == asked else what_moves(held), held)
    return True


def _stands_out(before: Estimate, after: Estimate) -> np.ndarray:
    """Whether each joint, (n,), is left with far more where the fit after uses no row, within its friction."""
    left, friction = left_and_friction(after)
    held = within_friction(left, friction, left_out(before, after))
    held &= tells_motion(after.regression.used_rows)
    return held & rest_exceeds(left, before, after, REST_STANDS_OUT)
