"""Joints that dry friction holds for a moment: where they start, stop, stick or reverse.

True stiction is no function of the velocity. A joint that stops is held at any torque within its friction, and
one that sticks while its drive winds up goes through all of them. Fitted to a sign of any width, that was 2 to
3.4 times the noise on five joints of clean arms of another simulator, told as "unexplained", with friction 6 %
and viscous friction 9 % off; fitted to what moves, all were within their noise and friction within 0.3 %.

Laws go first: a bristle, a play or a rise of friction at low speed shows in the same rows. Structure that holds
on no other motion is none, and what friction does at rest is a matter of its own joint: on cycles of four
points joints that stuck at each seemed to follow two others, or the acceleration of one.
"""

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.decision.material import find_material
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import LOST, LOUD, NEAR
from jaxswarm.diagnose.decision.unexplained import Unexplained
from jaxswarm.diagnose.folds.noise import row_noise, with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.friction_at_rest import (
    left_and_friction,
    left_out,
    much_nearer,
    rest_exceeds,
    rms_in,
    with_all_held,
    within_friction,
)
from jaxswarm.diagnose.selection.loose_rest import with_loose_rest
from jaxswarm.diagnose.selection.refit import fit_from, refit
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import chain
from jaxswarm.diagnose.selection.told_at_rest import take_back_told_at_rest
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.rest_foretold import is_foretold
from jaxswarm.identify.estimation.standing import (
    hardly_moving,
    leave_out,
    mixed_with,
    standing,
    tells_motion,
)
from jaxswarm.logs.motion import Motion


def leave_out_sticks(search: Search) -> bool:
    """Leave out where joints hardly move that nothing explains, if friction holds them there; whether it does.

    The sign keeps its width: it is what tells of the rows that are left out.
    """
    known = set(search.sticking)
    every = not search.lent and not any(known_held(m).any() for m in search.current.motions)
    after = _fit_of_what_moves(search)
    if after is not None:
        search.of_all_rows |= every
        held = search.sticking - known
        go_on_from(search, after, held)
        take_back_told_at_rest(search, held)
    return after is not None


def leave_out_where_lost(
    search: Search, sticks: Callable[[Search], bool] = leave_out_sticks
) -> bool:
    """Leave out sticks where something was added and very much is left, before that is judged by it.

    ``sticks`` is what the search does where friction holds joints: one for a model of every row is given up.

    A cable over two joints took 0.95 off one of them, which rows that friction held left at 12 times its noise:
    as too little it was taken back, and a dozen others in its place, for eight minutes.
    """
    over = over_noise(search.current)
    acts = {j for s in search.steps for j in (s.score.joint, s.added.joint) if j is not None}
    return any(over[j] > LOST for j in acts) and sticks(search)


def give_up_if_it_sticks(search: Search) -> bool:
    """Give a search up that is asked for a model of every row, and has none; it never goes on.

    It has none where friction holds joints for moments, or where rounds ended before all was found. To go on
    there took a sixth of the whole time on a measured arm of six joints, and its end was not looked at.
    """
    search.given_up = search.ended or _fit_of_what_moves(search) is not None
    return False


def _fit_of_what_moves(search: Search) -> Estimate | None:
    """The fit without the rows in which friction holds joints that nothing explains; None if it holds none."""
    current = search.current
    if search.unheld is current:
        return None
    asked = loud_joints(search)
    if asked:
        structure = find_material(current, search.folds, search.seed)
        other = _left_but_for_rest(current) > NEAR
        lawful = {item.joint for item in structure if _may_be_friction(item, current)}
        asked -= {joint for joint in lawful if other[joint]}

    def fitted(motions: Sequence[Motion]) -> Estimate:
        return fit_of_rows(search, current, motions)

    after = without_sticks(search, asked, fitted) or with_loose_rest(search, asked, fitted)
    search.unheld = current if after is None else None
    return after


def fit_of_rows(search: Search, found: Estimate, motions: Sequence[Motion]) -> Estimate:
    """A fit once more, to the rows that are in use of these logs, with their noise."""
    return with_motion_noise(
        refit(replace(found, motions=tuple(motions)), found.model.terms), search.seed
    )


def motion_alone(
    motions: Sequence[Motion], slow: Sequence[np.ndarray], joints: Collection[int]
) -> list[Motion]:
    """The logs without the rows in which some joints hardly move; of all joints those are ``slow``, (T', n)."""
    return leave_out(motions, slow, np.isin(np.arange(slow[0].shape[1]), list(joints)))


def fits_of_motion(search: Search) -> Callable[[set[int]], Estimate]:
    """The current model fitted without the rows in which given joints hardly move, as a function of these."""
    current = search.current
    rows = hardly_moving(current.motions)
    return lambda joints: fit_of_rows(search, current, motion_alone(current.motions, rows, joints))


def loud_joints(search: Search) -> set[int]:
    """Joints left beyond their noise whose friction was not yet found to hold them for moments."""
    return {int(j) for j in np.flatnonzero(over_noise(search.current) > LOUD)} - search.sticking


def without_sticks(
    search: Search, asked: set[int], fitted: Callable[[Sequence[Motion]], Estimate]
) -> Estimate | None:
    """The fit without the rows in which some of these joints hardly move; None if friction holds none there.

    That is so where motion alone is near its noise and leaves a small part of what was left, tells what the
    model does where the joint hardly moves, and what is left there is not more than the joint's friction.

    Args:
        search: The selection; such joints are kept in it.
        asked: Joints that it may be so for.
        fitted: Fits the model to the rows that are left, with their noise.
    """
    logs = search.current.motions
    rows = hardly_moving(logs)

    def without(joints: set[int]) -> Estimate:
        return fitted(motion_alone(logs, rows, joints))

    return with_all_held(search, asked, without, is_held)


def _left_but_for_rest(found: Estimate) -> np.ndarray:
    """What a model leaves over the noise of its rows where a joint does not stand, RMS (n,).

    A law of friction shows there, too. Each of eight rests of a clean joint had a torque of its own, which
    seemed to follow where another joint stood, at p = 1e-9.
    """
    rest = mixed_with(found.motions, standing(found.motions))
    rows = found.regression.used_rows & ~np.concatenate(rest)
    return rms_in(found.fit.residual / row_noise(found), rows)


def _may_be_friction(item: Unexplained, found: Estimate) -> bool:
    """Whether structure may be a law of friction that nobody has written down."""
    own = found.model.robot.joints[item.joint]
    named = any(name.split("_", 1)[-1] == own for name in item.depends_on)
    return named and (item.elsewhere is None or item.elsewhere > 0.0)


def settle_signs(search: Search, alone: Callable[[], Estimate]) -> None:
    """Give the signs of these joints the widths that all rows tell, in the final model or as it was declared.

    Rows that are left out count in the errors of other logs, and no others tell what the sign is there. Those
    found on the way, beside what was missing then, were up to ten times wider, and the error of rest on another
    log two and a half times the declared model's.

    Args:
        search: With everything added.
        alone: Gives the fit of the declared model.
    """
    if not search.sticking:
        return
    current = search.current
    start, terms = np.asarray(current.model.robot.parameters).ravel(), current.model.terms
    if search.steps:
        joints = np.isin(np.arange(current.model.robot.num_joints), list(search.sticking))
        every = tuple(replace(m, held=known_held(m) & ~joints) for m in current.motions)
        width = refit(replace(current, motions=every), terms).model.width
    else:
        width = alone().model.width
    search.go_on(fit_from(current, start, terms, width))


def known_held(motion: Motion) -> np.ndarray:
    """Samples (T, n) of a fitted log in which joints are held."""
    assert motion.held is not None  # it was fitted
    return motion.held


def is_held(before: Estimate, after: Estimate) -> np.ndarray:
    """Whether friction may be what holds each joint, (n,), in rows that the fit after does not use any more.

    Motion alone has to tell what the model does there. Of seven joints that moved one by one it did not: four
    were left out at rest, and the errors of three joints on another log rose up to four times.
    """
    every, out = before.regression, left_out(before, after)
    left, friction = left_and_friction(after)
    tells = tells_motion(after.regression.used_rows)
    held = much_nearer(before, after) & tells & within_friction(left, friction, out)
    if not held.any():
        return held
    return held & is_foretold(every.columns, np.where(every.used_rows, left, 0.0), out)


def stands_out(before: Estimate, after: Estimate) -> np.ndarray:
    """Whether friction may hold each joint, (n,), where the fit after uses no row, far from the noise or not.

    Those are left with more than motion. By how much, and whether that is more than friction, says only a
    model with the law that motion lacks: of friction that fell from 2.2 to 0.4 N m as its joint warmed a model
    without that law knew 0.95 N m, and left 1.16 N m at rest, 2.4 times as much as in motion.
    """
    left, _ = left_and_friction(after)
    return rest_exceeds(left, before, after)


def go_on_from(search: Search, after: Estimate, joints: Iterable[int]) -> None:
    """Go on from a fit to other rows of some joints, with all that is told before it on the same rows."""

    def on_these(found: Estimate) -> Estimate:
        here = replace(found, motions=after.motions, rigids=after.rigids)
        return refit(here, found.model.terms)

    search.declared = on_these(search.declared)
    if search.steps:
        first = replace(search.steps[0], before=on_these(search.steps[0].before))
        search.steps = chain([first, *search.steps[1:]])
    search.current = after
    search.crossfit = cross_fit(after)
    # What was refused on these joints was refused beside what friction held.
    for joint in joints:
        search.ask_again(joint)
    search.settled = False
