"""Two laws of one joint at once, where neither passes while the model does without the other.

What one leaves is most of what the other is seen against, and on a short log that is chance enough to hide it.
On a world (w2793) friction that differs by direction and friction by a power of the speed, both on one joint,
left 48 times its noise: alone the first passed at p = 1e-4 of 180 candidates, and the other with an exponent of
0.98 instead of 0.41 beside a viscous friction below zero. Together they leave 0.9 times the noise; of all other
laws of that joint none finds a partner with which it is left below 3.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import jax

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.position_laws import imitates
from jaxswarm.diagnose.candidates.propose import propose_all
from jaxswarm.diagnose.decision.competing import choose
from jaxswarm.diagnose.decision.evaluate import score_if_passing, score_terms
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import (
    NEAR,
    PAIR_ASKED,
    PAIR_LEAVES,
    PAIR_TO_FIRST_ORDER,
    Rules,
)
from jaxswarm.diagnose.decision.worth import Score, passes
from jaxswarm.diagnose.folds.partial_out import Fold, cross_fit
from jaxswarm.diagnose.selection.plainer import does_as_well
from jaxswarm.diagnose.selection.refit import refit, refit_in_place, refit_with
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import find_term, step_between, with_errors
from jaxswarm.diagnose.selection.survives import one_place, survives
from jaxswarm.diagnose.selection.tenable import (
    can_be,
    goes_beyond,
    is_certain,
    unphysical_beside,
    winds_up,
)
from jaxswarm.effects.alike import has, lacking, without
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate

# First laws of a joint that are asked for a partner, the most certain ones.
_MOST_FIRST = 12


@dataclass(frozen=True)
class _Pair:
    """Two laws that leave little more than the noise together.

    Attributes:
        scores: What each is worth beside the other.
        rivals: What the data do not tell from the second, beside the first.
        middle, after: The fits with the first, and with both.
    """

    scores: tuple[Score, Score]
    rivals: tuple[Score, ...]
    middle: Estimate
    after: Estimate

    @property
    def places(self) -> frozenset:
        """Where either acts."""
        return frozenset(s.candidate.term.place for s in self.scores)

    @property
    def size(self) -> int:
        """Numbers that both spend."""
        return sum(s.candidate.size for s in self.scores)


def add_two_laws(search: Search) -> bool:
    """Add two laws of one joint that explain all of it together, where nothing explains a part; whether any.

    Asked are joints that are far from their noise. The second law has to pass beside the first by a level
    divided by the number of all pairs; the first beside the second, which then is no chance, by one divided by
    the number of laws of their joint. Together they leave little more than the noise, a small part of what was
    left: two that share what an unknown law does leave more. What happens in one log only is not asked: it
    bends into anything.
    """
    current = search.current
    over = over_noise(current)
    for joint in sorted(
        (j for j in range(len(over)) if over[j] > PAIR_ASKED), key=lambda j: -over[j]
    ):
        found = _best(_pairs(search, joint))
        if found is None:
            continue
        why = survives(current, found.after, joint, search.other, search.rules)
        if why:
            second = found.scores[1].candidate.term
            search.refuse(second, why, by_all=bool(search.other))
            continue
        _add(search, found)
        return True
    return False


def _add(search: Search, found: _Pair) -> None:
    first, second = found.scores
    search.steps.append(step_between(first, search.current, found.middle))
    search.steps.append(step_between(second, found.middle, found.after, found.rivals))
    search.current = found.after
    search.pairs.add(found.places)
    # What was refused on this joint was refused without them, and every choice was made without them.
    search.ask_again(found.scores[0].joint)
    search.settled = False


def _best(pairs: Sequence[_Pair]) -> _Pair | None:
    """The pair of the fewest numbers among those that leave as little as the one that leaves least."""
    if not pairs:
        return None
    least = min(pairs, key=lambda p: float(p.after.fit.sigma[p.scores[0].joint]))
    as_good = [p for p in pairs if does_as_well(p.after, least.after, least.size - p.size)]
    return min((least, *as_good), key=lambda p: p.size)


def _pairs(search: Search, joint: int) -> list[_Pair]:
    """Pairs of laws of a joint that leave it near its noise and pass beside each other."""
    current = search.current
    terms = _own(search, current, joint)
    lin = Linearization(current, search.folds, search.memory)
    asked = score_terms(lin, terms, search.seed)
    alone = sorted(_passing(asked, 1, search.rules), key=lambda s: s.p_value)
    first = alone[:_MOST_FIRST]
    names = current.model.robot.joints
    told = []
    for one in first:
        search.progress(f"asking what goes with {one.candidate.term.label(names)}")
        if not _may_explain(search, one, terms):
            continue
        told.append(_partner(search, one, len(asked), len(first) * max(search.asked, len(asked))))
    return [found for found in told if found is not None and found.places not in search.pairs]


def _passing(asked: Sequence[Score], tests: int, rules: Rules) -> list[Score]:
    """Those that pass as one of so many, but for bristles of the least way there is."""
    return [s for s in asked if passes(s, tests, rules) and winds_up(s.candidate.term)]


def _may_leave(over: float) -> float:
    """Multiple of the noise that two laws may leave on a joint that is left with this one."""
    return min(NEAR, PAIR_LEAVES * over)


def _may_explain(search: Search, one: Score, terms: Sequence[Term]) -> bool:
    """Whether to first order a first law and another one of its joint explain most of what is left there.

    To fit a pair took 8 to 45 s on six joints whose friction goes by the load, and this 1 s.
    """
    folds = search.folds.with_columns(one.candidate.columns)
    lin = Linearization(search.current, folds, search.memory.aside())

    def left(fold: Fold) -> float:
        return float((fold.residual[:, one.joint] ** 2).sum())

    over = over_noise(search.current)[one.joint]
    most = (PAIR_TO_FIRST_ORDER * _may_leave(over) / over) ** 2 * left(search.folds.whole)
    return any(
        left(folds.whole.with_columns(other.columns[0])) <= most
        for other in propose_all(lin, tuple(terms), jax.random.key(search.seed))
    )


def _partner(search: Search, one: Score, own: int, pairs: int) -> _Pair | None:
    """A first law with the best that passes beside it, if both explain their joint and each needs the other.

    ``own``, ``pairs``: Laws of the joint and pairs that are asked, for the level of the tests.
    """
    current, rules, seed = search.current, search.rules, search.seed
    joint = one.joint
    most = _may_leave(over_noise(current)[joint])
    # Without the other it may come to values that no law has.
    middle = refit_in_place(current, one.candidate.term)
    folds = cross_fit(middle)
    asked = score_terms(Linearization(middle, folds), _own(search, middle, joint), seed)
    passed = _passing(asked, pairs, rules)
    if not passed:
        return None
    two, rivals = choose(passed, rules, folds)
    after = refit_with(middle, two)
    if after is None or over_noise(after)[joint] > most:
        return None
    if not has(one.candidate.term, after.model.terms):
        return None  # the second is all that the first is
    first, second = (find_term(after, s.candidate.term) for s in (one, two))
    if not all(_may_stand(current, after, t, search) for t in (first, second)):
        return None
    back = lacking(current.model.terms, middle.model.terms)
    rest = refit(current, (*without(first, after.model.terms), *back))
    needed = score_if_passing(rest, one.candidate.term, own, rules, seed)
    return None if needed is None else _Pair((needed, two), tuple(rivals), middle, after)


def _may_stand(current: Estimate, after: Estimate, term: Term, search: Search) -> bool:
    """Whether one of two laws is what a law can be, beside the other and all there was before."""
    known = with_errors(term, after)
    assert known is not None  # the fit that it is of has it
    physical = can_be(*known) and is_certain(*known) and goes_beyond(*known)
    if not physical or unphysical_beside(current, after, term):
        return False
    bent = imitates(term, after.model.terms, after.motions)
    return not bent and one_place(after, term, search.rules, search.seed) is None


def _own(search: Search, found: Estimate, joint: int) -> list[Term]:
    """Torques of a joint that could be added to a model: these add up, and each is seen in its own joint."""
    return [
        t
        for t in eligible_terms(found.model, found.motions)
        if t.joint == joint
        and isinstance(t.law, TorqueLaw)
        and not t.law.in_one_log
        and t.identity not in search.barred
    ]
