"""Joints that dry friction holds for a moment and that lack a law as well: neither is told without the other.

With the rows in which friction holds a joint no law of the others lowers its error by enough, and without the
law motion alone is far from its noise, so that nothing is friction's. A joint of an arm of another simulator
that paused for less than a quarter of a second between its moves, at up to its whole dry friction, lacked a
spring of 2.8 times its noise: "unexplained", ten times the noise, 92 % of it by the joint's own position. So
laws are asked of motion alone; where one brings that near its noise, the rows are judged beside it.

It may bring all rows there: then friction holds nothing, and they come back once it is added. Beside short
rests between sudden stops a filter of 11 ms bent the signs of four joints, and no half of the log told a delay
of the other one: "unexplained", seven times the noise, and 1.4 times with that delay.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.decision.competing import choose
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import LOUD, NEAR
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.selection.of_some_joints import accepted_on
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.sticking import (
    fit_of_rows,
    fits_of_motion,
    go_on_from,
    is_held,
    known_held,
    loud_joints,
    stands_out,
)
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion


def leave_out_beside_laws(search: Search) -> bool:
    """Leave out where joints hardly move that motion alone explains with a law; whether that may be told so.

    The laws are not added here: the search goes on without these rows, and asks for them as for any.
    """
    current, asked = search.current, loud_joints(search)
    if search.budget.spent or not asked:
        return False
    what_moves = fits_of_motion(search)
    moving = what_moves(asked)
    loud = set(np.flatnonzero(stands_out(current, moving) & (over_noise(moving) > LOUD)))
    if not asked & loud:
        return False
    if asked - loud:
        asked &= loud
        moving = what_moves(asked)
    told = _with_laws(search, moving, asked)
    if told is None:
        return False
    every = fit_of_rows(search, told, current.motions)
    if asked <= set(np.flatnonzero(is_held(every, told))):
        search.sticking |= asked
    elif _may_lend(search, told, every):
        search.lent = current.motions
    else:
        return False
    go_on_from(search, moving, asked)
    return True


def _may_lend(search: Search, told: Estimate, every: Estimate) -> bool:
    """Whether laws explain all rows, none of which was found on these already, and refused there."""
    refused = any(map(search.is_refused, told.model.terms))
    return search.lent is None and not refused and bool((over_noise(every) <= NEAR).all())


def put_back(search: Search) -> bool:
    """Go on with all rows again where some were left out to find a law that explains them; whether any were.

    Those in which friction has been found to hold joints since stay out: with them two joints on a cable were
    left at 5 and 12 times their noise again, and their friction was asked about no more.
    """
    if not search.lent:
        return False
    every = fit_of_rows(search, search.current, _but_for_sticks(search, search.lent))
    search.lent = ()
    go_on_from(search, every, ())
    return True


def _but_for_sticks(search: Search, lent: Sequence[Motion]) -> list[Motion]:
    """The logs as they were lent, without the rows in which friction holds joints by now."""
    joints = np.isin(np.arange(search.current.model.robot.num_joints), list(search.sticking))
    logs = zip(lent, search.current.motions, strict=True)
    return [replace(m, held=known_held(m) | (known_held(now) & joints)) for m, now in logs]


def _with_laws(search: Search, moving: Estimate, asked: set[int]) -> Estimate | None:
    """The fit to motion alone with a law for each of these joints; None where one of them stays loud."""
    here = moving
    for _ in asked:
        after = _with_law(search, here, asked)
        if after is None:
            return None
        here = with_motion_noise(after, search.seed)
        if (over_noise(here)[list(asked)] <= NEAR).all():
            return here
    return None


def _with_law(search: Search, here: Estimate, asked: set[int]) -> Estimate | None:
    """The fit with the law of these joints that would be added, or the next one that can be fitted."""
    left, folds = accepted_on(search, here, asked, search.memory.aside())
    while left:
        best, _ = choose(left, search.rules, folds)
        after = refit_with(here, best)
        if after is not None:
            return after
        left = [s for s in left if s is not best]
    return None
