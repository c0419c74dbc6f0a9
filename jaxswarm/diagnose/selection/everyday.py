"""What every drive has, proposed for all joints at once.

Where viscous and dry friction or rotors' inertias are missing on several joints, each joint's residual is
their sum, laws of more parameters compete to be bent into it, and in a short log hardly one of them shows
alone: what the others leave is most of what it would be seen against (on a TX40, rotors that were added one by
one ended with one that was false at 4.6 % of the torque, together they leave 3.9 %). Effects marked
``everyday`` are therefore tried together wherever there is none, before anything rarer and before the clocks
are asked, whose skew would take up a part of them. What the common fit does not confirm is dropped again, the
least certain of a joint first, and so is what does not lower its joint's error on rows that were not fitted. A
joint that lacks more may hide it: friction that falls with speed can outweigh the viscous part that all other
joints show. There it stays until the rest is found; what is still uncertain when every choice is made again
goes then.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.own_variables import torque_at_joint
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import EVERYDAY_CERTAIN, EVERYDAY_MATERIAL, NEAR, Rules
from jaxswarm.diagnose.decision.sharpness import score_softly
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.noise import noise_of
from jaxswarm.diagnose.folds.partial_out import CrossFit, cross_fit
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step, find_term
from jaxswarm.effects.alike import number_of
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate


def allow_for_everyday(search: Search, lin: Linearization, eligible: Sequence[Term]) -> bool:
    """Add what every drive has, on all joints that lack it, once; whether anything was added."""
    everyday = [t for t in eligible if t.law.everyday]
    if search.everyday or not everyday:
        return False
    search.everyday = True
    scores = score_terms(lin, everyday, search.seed)
    if not _add(search, scores):
        return False
    search.asked = len(eligible)
    return True


def everyday_again(search: Search) -> bool:
    """Ask once more for what every drive has, where nothing passes any more; whether anything was added.

    Beside a coupling of two wrist joints that nobody declared (TX40) a rotor's inertia was not certain, and
    among all candidates it did not pass by itself.
    """
    asked = [s for s in search.scores if s.candidate.term.law.everyday]
    if search.everyday_again or not (search.steps and asked):
        return False
    search.everyday_again = True
    if not _add(search, asked):
        return False
    search.ask_again(None)
    return True


def _add(search: Search, scores: Sequence[Score]) -> bool:
    """Add what is confirmed of these; whether anything is."""
    together = add_everyday(search.current, search.folds, scores, search.rules)
    if together is None:
        return False
    search.progress("adding what every drive has")
    steps, search.current = together
    search.steps = [*search.steps, *steps]
    return True


def add_everyday(
    current: Estimate, crossfit: CrossFit, scores: Sequence[Score], rules: Rules
) -> tuple[list[Step], Estimate] | None:
    """The steps that add everyday effects together, and the fit with them; None where none is missing.

    Args:
        current: The model.
        crossfit: All folds of it.
        scores: Of the candidates that are everyday.
        rules: Thresholds; a joint's squared error has to fall by their share.
    """
    everyday = _more_than_clocks(scores, current, crossfit)
    moving = current.regression.moving
    noise, before = noise_of(current), _held_out(crossfit, moving)
    while everyday:
        terms = tuple(s.candidate.term for s in everyday)
        after = refit(current, (*current.model.terms, *terms))
        dropped = _least_certain(after, everyday, noise)
        if not dropped:
            left = _held_out(cross_fit(after), moving)
            lower = np.any(left < (1.0 - rules.share) * before, axis=0)
            dropped = [s for s in everyday if not lower[s.candidate.term.joint]]
        if not dropped:
            hidden = _hidden(after, everyday, scores)
            if hidden:
                everyday += hidden
                terms = tuple(s.candidate.term for s in everyday)
                after = refit(current, (*current.model.terms, *terms))
            steps = [
                Step(find_term(after, s.candidate.term), s, (), (), current, after, ())
                for s in everyday
            ]
            return steps, after
        everyday = [s for s in everyday if s not in dropped]
    return None


def _more_than_clocks(
    scores: Sequence[Score], current: Estimate, crossfit: CrossFit
) -> list[Score]:
    """Those that say anything of unseen time beside the clocks of joints, where a joint is near its noise.

    On a clean joint of a world whose drive was told the weight every fourth sample, viscous friction was seven
    standard errors from zero, and a tenth as large with those clocks free.
    """
    pairs = zip(scores, score_softly(scores, current, crossfit), strict=True)
    return [s for s, other in pairs if other is None or other.gain > 0 or s.gain <= 0]


def _hidden(after: Estimate, confirmed: Sequence[Score], asked: Sequence[Score]) -> list[Score]:
    """What half of the joints that were asked have, on joints that are left far from their noise without it.

    What is a part of the rigid body there, as a rotor's inertia on a vertical first axis, no fit can tell.
    """
    over = over_noise(after)
    found = [s.candidate.term.law for s in confirmed]
    candidates = [s.candidate.term.law for s in asked]
    return [
        s
        for s in asked
        if s not in confirmed
        and s.trained > 0.0
        and over[s.candidate.term.joint] > NEAR
        and 2 * found.count(s.candidate.term.law) >= candidates.count(s.candidate.term.law)
    ]


def _held_out(crossfit: CrossFit, moving: np.ndarray) -> np.ndarray:
    """Squared error of every joint [N m or N] on the rows that a fold was not fitted to, (2, n).

    Over all of them, and over those in which the joint moves, (T, n), which what friction leaves at rest hides.
    """
    weight = crossfit.weight
    total = np.zeros((2, weight.shape[1]))
    for fold in crossfit.halves:
        raw = np.divide(fold.residual, weight, where=weight > 0, out=0.0 * weight)
        square, unseen = raw**2, ~fold.train[:, None]
        total += [(square * unseen).sum(axis=0), (square * (unseen & moving)).sum(axis=0)]
    return total


def _least_certain(after: Estimate, everyday: Sequence[Score], noise: np.ndarray) -> list[Score]:
    """Of every joint the term that is least certain, where that is too little."""
    worst: dict[int, tuple[float, Score]] = {}
    for s in everyday:
        term = s.candidate.term
        certainty = _certainty(after, term, noise)
        if certainty < min(EVERYDAY_CERTAIN, worst.get(term.index, (np.inf, s))[0]):
            worst[term.index] = certainty, s
    return [s for _, s in worst.values()]


def _certainty(after: Estimate, term: Term, noise: np.ndarray) -> float:
    """A fitted term's value over its standard error; zero where it is against physics or within the noise."""
    number = number_of(term, after.model.terms)
    fitted, errors = after.model.terms[number], after.std_errors[number]
    values = np.array([fitted.values[p.name] for p in fitted.law.linear])
    doubts = np.nan_to_num([errors[p.name] for p in fitted.law.linear], nan=np.inf)
    torque = torque_at_joint(after, fitted)
    if (values < [p.lower for p in fitted.law.linear]).any():
        return 0.0
    if np.sqrt((torque**2).mean()) < EVERYDAY_MATERIAL * noise[term.joint]:
        return 0.0
    return float((np.abs(values) / np.maximum(doubts, 1e-300)).max())
