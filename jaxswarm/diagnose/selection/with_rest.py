"""Whether a law that is missing shows where joints rest, and not friction that holds them there.

What a model leaves at rest is taken for dry friction's before anything is added
(:mod:`jaxswarm.identify.estimation.standing`). A law of the position that is missing looks the same there, and
rest is where it is seen best: on a cycle of four points two of five joints were taken for held, and a wrong
reading of one of them was told as two others, beside which the error on other motion grew three times. With the
rest it was named, and all was left within its noise. Nor need any law be missing: of a clean arm a slide creeps
at rest, by a sign whose width motion alone does not tell, and was left at 3.4 times its noise; with it at 0.3.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import ABOVE_NOISE, NEAR
from jaxswarm.diagnose.decision.worth import Score, is_large
from jaxswarm.diagnose.folds.free_parts import coefficients, free_parts
from jaxswarm.diagnose.folds.noise import noise_of, with_motion_noise
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.diagnose.selection.elsewhere import errors_elsewhere
from jaxswarm.diagnose.selection.of_some_joints import accepted_on
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.sticking import give_up_if_it_sticks
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.standing import held, mixed_with, standing
from jaxswarm.logs.motion import Motion

# Rounds of the second search beyond the steps of the first: what every drive has, clocks, and one law, after
# one that it contains (a bristle, then one whose friction falls with speed).
_MORE_ROUNDS = 4


def with_rest(
    search: Search,
    motions: Sequence[Motion],
    searched: Callable[
        [Sequence[Motion], int, Callable[[Search, list[Score]], bool], Callable[[Search], bool]],
        Search,
    ],
) -> Search:
    """The search with all rows, where its model explains rest and motion by no more numbers; else the search.

    By more of them where other logs show that these are right.

    It is made only where rows were left out at rest and motion alone is not explained by what was declared.
    Nor is it where friction was found to hold joints for moments too and rest asks for no other law of its
    joints: friction holds them then as well. On a measured arm of six joints the second search found the eight
    laws of the first, for half of the whole time. Without such moments it is made whatever rest asks for: that
    asks for nothing beside a spring which had been told for a push, and a part of the push. Nor is it made
    where the first search has begun with all rows and then found that friction holds joints for moments: the
    second is given up there. It found a tilted base once more, for a third of the whole time. Nor is it made
    where only joints are far from the noise whose rest is fitted, and that of the others asks for no law: the
    measured arm has such a joint, too. It is given up where what it would add does not act at rest: of four
    joints with stiction it found the viscous friction of the first once more, for half of the whole time.

    Args:
        search: A search that may have left out rest.
        motions: The logs it was given.
        searched: ``searched(motions, most, goes_on, sticks)``: a search of so many rounds on these logs, given
            up in the round in which it does not go on with those that passed; ``sticks`` is asked in the end
            whether it goes on with other rows.
    """
    if search.of_all_rows or search.budget.spent:
        return search
    rest = standing(motions)
    left_out = _left_out(search, rest)
    over = over_noise(search.current)
    loud = over.max() > NEAR
    if not left_out.any() or not (search.steps or loud):
        return search
    search.progress("asking whether a law shows where joints rest")
    every = [replace(m, held=np.zeros_like(r)) for m, r in zip(motions, rest, strict=True)]
    others = loud and not (left_out & (over > NEAR)).any()
    if (others or (search.sticking and not loud)) and not _asks_for_more(search, every, left_out):
        return search
    # What is far from the noise in motion gets there by what rest shows, or not at all; of other joints the
    # same laws are to be found once more.
    near = [s for s in search.steps if s.added.joint is None or over[s.added.index] <= NEAR]
    most = _MORE_ROUNDS + len(near)
    goes_on = partial(_may_explain, rest, mixed_with(motions, rest))
    again = searched(every, most, goes_on, give_up_if_it_sticks)
    nothing = not again.steps and not loud  # what was near with something added lacked it
    if again.given_up or again.ended or again.budget.spent or again.sticking or nothing:
        return search
    plain = loud or _numbers(again) <= _numbers(search) or _better_elsewhere(search, again)
    return again if plain and _explains(again.current, rest, motions) else search


def _left_out(search: Search, rest: Sequence[np.ndarray]) -> np.ndarray:
    """Whether some of the rest of each joint is not fitted, (n,)."""
    known = [m.held for m in search.current.motions]
    parts = [
        np.zeros(r.shape[1], bool) if h is None else (h & r).any(axis=0)
        for h, r in zip(known, rest, strict=True)
    ]
    return np.any(parts, axis=0)


def _asks_for_more(search: Search, every: Sequence[Motion], joints: np.ndarray) -> bool:
    """Whether a law of some joints (n,), or of the arm, would be added to the model fitted to all rows."""
    current = search.current
    logs = [replace(m, held=e.held) for m, e in zip(current.motions, every, strict=True)]
    beside = refit(replace(current, motions=tuple(logs)), current.model.terms)
    beside = with_motion_noise(beside, search.seed)
    asked = {int(j) for j in np.flatnonzero(joints)}
    passed, _ = accepted_on(search, beside, asked, search.memory)
    return any(joints[s.joint] and is_large(s, search.rules) for s in passed)


def _may_explain(
    rest: Sequence[np.ndarray], mixed: Sequence[np.ndarray], search: Search, passed: list[Score]
) -> bool:
    """Whether a round of the search with rest may lead to a model that explains it.

    It does not where friction would hold joints as before, and none of those that passed lowers what is left of
    them at rest: it finds what motion alone had told, and rest is what it cannot tell. Nor does it where it
    will end with laws still to add.
    """
    if _too_many(search, passed):
        return False
    stuck = held(search.current.fit.residual, rest, mixed)
    if not passed or not stuck.any():
        return True
    rows, share = np.concatenate(rest) & stuck, search.rules.share
    left = np.array([_left_at_rest(s, search.folds, rows) for s in passed])
    before, after, own = left.transpose(1, 0, 2)
    acts = own > share * before
    # What laws without torque there take off it as well, rest does not ask for: viscous friction bent the
    # rigid body less, and left as little of it as an asymmetric one in its place.
    least = np.minimum(before, np.where(acts, np.inf, after).min(axis=0))
    return bool((acts & (after < (1.0 - share) * least)).any())


def _too_many(search: Search, passed: Sequence[Score]) -> bool:
    """Whether laws of more joints passed than rounds are left to add one in, each shown by its joint alone.

    On a measured arm of six joints four had one in the last round, and three after it: it was fitted, all laws
    were asked once more, and nothing of that was looked at.
    """
    alone = all(s.own is not None and not s.candidate.term.law.mutual for s in passed)
    return alone and len({s.joint for s in passed}) > search.left + 1


def _left_at_rest(one: Score, crossfit: CrossFit, rows: np.ndarray) -> np.ndarray:
    """Squared error of every joint in rows (T, n) not fitted to, without and with a candidate, (3, n).

    And, last, the square of the candidate's own torque there: viscous friction has none at rest, but without it
    the rigid body is bent, and rest with it.
    """
    columns = one.candidate.columns
    parts = next(free_parts([columns], crossfit))
    total = np.zeros((3, rows.shape[1]))
    for fold, free, whole in zip(crossfit.halves, parts[1:], columns[1:], strict=True):
        a, out = coefficients(free, fold), rows & ~fold.train[:, None]
        sizes = (fold.residual, fold.residual - free @ a, whole @ a)
        total += [np.square(np.where(out, x, 0.0)).sum(axis=0) for x in sizes]
    return total


def _explains(found: Estimate, rest: Sequence[np.ndarray], motions: Sequence[Motion]) -> bool:
    """Whether a model leaves every joint near its noise, and nothing at rest that is friction's."""
    near = over_noise(found).max() <= NEAR
    return bool(near and not held(found.fit.residual, rest, mixed_with(motions, rest)).any())


def _better_elsewhere(search: Search, again: Search) -> bool:
    """Whether the model with rest has lower errors on every other log, and raises none there above the noise.

    Bristles whose friction falls with speed were told as plain ones, which spend two numbers less, while their
    rest was left out: 1.6 times the noise on another log, and 0.9 with all four.
    """
    before, after = search.current, again.current
    noise = noise_of(after)
    told = [
        falls.any() and not (rises & (two > ABOVE_NOISE * noise)).any()
        for _, two, falls, rises, _ in errors_elsewhere(before, after, search.other)
    ]
    return bool(search.other) and all(told)


def _numbers(search: Search) -> int:
    """Numbers that the additions of a search spend."""
    return sum(step.score.candidate.size for step in search.steps)
