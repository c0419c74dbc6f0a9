"""Who would be chosen for a change with the others in place, and whether that is better.

The first choice is made while all that changed is still left: a gain that takes a little of everything then
explains more than any one of two changes does, and what follows makes up for it.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.competing import accepted, choose
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import FIRST_NEAR, FIRST_TRIED
from jaxswarm.diagnose.folds.noise import noise_of
from jaxswarm.diagnose.selection.change_apply import (
    Change,
    Picked,
    as_picked,
    changes_of,
    with_changes,
)
from jaxswarm.diagnose.selection.change_fit import crossed
from jaxswarm.diagnose.selection.earlier_model import freeze, held_folds, lacking
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.least_squares import weighted_cost


def is_change(search: Search, term: Term) -> bool:
    """Whether a term is a change of what the earlier model holds, and so of either sign."""
    return term.identity in {t.identity for t in search.declared.model.terms}


def beside(search: Search, others: Sequence[Picked]) -> Picked | None:
    """Who is chosen where only the others are in place."""
    before = search.declared
    changes = changes_of(before, others)
    current = freeze(with_changes(before, changes), before.motions)
    crossfit = held_folds(before, current)
    held = {p[0].term.identity for p in others} | {t.identity for t, _ in search.refused}
    eligible = [
        t for t in eligible_terms(current.model, current.motions, True) if t.identity not in held
    ]
    lin = Linearization(current, crossfit, search.memory)
    scores = score_terms(lin, eligible, search.seed, partial(is_change, search))
    passed = accepted(scores, search.rules)
    if not passed:
        return None
    chosen, _ = choose(passed, search.rules, crossfit)
    return as_picked(chosen, scores, crossfit)


def might_have_been(search: Search, first: Picked) -> list[Picked]:
    """What gained nearly as much as a first change when it was chosen, beside nothing: the nearest ones."""
    _, worth, others = first
    near = [s for s in others if s.gain > FIRST_NEAR * worth.gain][:FIRST_TRIED]
    crossfit = held_folds(search.declared, search.declared)
    return [as_picked(s, (worth, *others), crossfit) for s in near]


def better(search: Search, trial: Sequence[Picked], now: Sequence[Picked]) -> bool:
    """Whether changes leave less of unseen blocks, joint by joint in their own measure.

    More of them have to be worth it, as any addition has.
    """
    before = search.declared
    left = [np.square(crossed(before, [p[0] for p in ps])).mean(axis=0) for ps in (trial, now)]
    asked = 1.0 if len(trial) <= len(now) else 1.0 - search.rules.share
    return bool(np.mean(left[0] / np.maximum(left[1], np.finfo(float).tiny)) < asked)


def worse(before: Estimate, current: Estimate, changes: tuple[Change, ...]) -> str | None:
    """Why changes are none: they leave more, as they are, than the model beside which they were found.

    They were found to first order: a base that gives way a little was fitted to 7 N of a slide, and left 86 N,
    swinging at 15 to 35 Hz, once its values were those of the model.

    Or they may have been there before: a bristle of 1.7 N, on a slide that the earlier model of an unchanged
    arm told to 2.3 N, would have been the same in the earlier log.
    """
    after = freeze(with_changes(before, changes), before.motions)
    one, two = (weighted_cost(e.fit.residual, noise_of(before)) for e in (current, after))
    if two >= one:
        return "leaves more with the values found for it than without it"
    # On the rows in use, as what the earlier model left of its own log.
    size, left = (current.regression.rms(e.fit.residual) for e in (current, after))
    taken = size**2 - left**2
    event = any(c.term.law.in_one_log for c in changes[-1:])
    if event or (taken > lacking(before) ** 2).any():
        return None
    return "is no larger than what the earlier model left of its own log"
