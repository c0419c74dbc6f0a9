"""A law of fewer numbers in the place of one that was chosen beside another law, which is gone now."""

from collections.abc import Sequence

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.decision.evaluate import score_on
from jaxswarm.diagnose.decision.rules import SAVED, Rules
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.noise import row_weight
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import left_on, refit, refit_with
from jaxswarm.diagnose.selection.rivals_elsewhere import no_worse
from jaxswarm.effects.alike import without
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion


def plainer(
    added: Term, current: Estimate, rules: Rules, seed: int, other: Sequence[Motion]
) -> tuple[Score, Estimate] | None:
    """The plainest law on the joint of an added one that does as well, all fitted with it; None if none does.

    A quadratic drag was told as Stribeck friction and then a power of the speed, with the exponent 3 beside
    it and 2.003 (1.995 to 2.010) without: nobody had asked for the drag itself any more, and the exponent
    moved an arm's weight by 0.3 %. What fails beside a model that stands still may do so once all is fitted, so
    the signs and the chance of the candidates are not asked.
    """
    rest = refit(current, without(added, current.model.terms))
    size = numbers_of(added)
    terms = [
        t
        for t in eligible_terms(rest.model, rest.motions)
        if t.joint == added.joint
        and isinstance(t.law, TorqueLaw)
        and len(t.law.parameters) < size
        and not (t.law.everyday or t.law.in_one_log)
    ]
    scores = score_on(rest, terms, seed)
    telling = [s for s in scores if s.share >= rules.share]
    for score in sorted(telling, key=lambda s: (s.candidate.size, -s.share)):
        after = refit_with(rest, score)
        saved = size - score.candidate.size
        if after is None or not does_as_well(after, current, saved):
            continue
        if no_worse(after, current, score.joint, other):
            return score, after
    return None


def numbers_of(term: Term) -> int:
    """How many numbers a fitted term spends: no choice is one, and no shape that is as usual.

    >>> numbers_of(Term("torque_constant_saturation", 0, values={"c": 0.1, "n": 1.0, "at": 5.0}))
    1
    """
    usual = {p.name for p in term.law.parameters if p.usual and term.values[p.name] == p.nominal}
    return sum(p.fitted and p.name not in usual for p in term.law.parameters)


def does_as_well(simple: Estimate, full: Estimate, saved: int) -> bool:
    """Whether a plainer model leaves no more than two standard errors for each number it saves, on all joints.

    A shape that does not bend counts as one number: a spring left 0.1 % more than a cubic one on 796
    independent rows, which is less than one standard error.
    """
    price = 1.0 + SAVED * max(saved, 1) / cross_fit(full).effective
    return cost(simple, slice(None), full) <= price * cost(full, slice(None), full)


def cost(found: Estimate, joint: int | slice, weights: Estimate) -> float:
    """Squared error of a joint, or of several, in units of the noise; rare large residuals bounded."""
    return left_on(found, joint, row_weight(weights))
