"""Laws that were told by moments in which dry friction holds their joints, and that motion does not need.

Before such moments are known they are most of what is left, and laws that come near them are added. On a clean
arm of which no friction was declared these were an asymmetric friction, whose halves were one once only motion
counted (0.53 +- 0.08 and 0.54 +- 0.07 N m), and a coupling in the place of a wrist's dry friction, which left
unseen motion with ten times its noise.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import LOUD
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.diagnose.selection.without_steps import go_on_without, terms_without
from jaxswarm.effects.alike import has
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate


def take_back_told_at_rest(search: Search, joints: Collection[int]) -> None:
    """Take back laws of joints held for moments, where friction alone leaves these near their noise.

    Nothing is refused by that: what motion needs is found in the rounds to come.

    Args:
        search: Fitted to rows in which the joints move.
        joints: Those that were found to be held.
    """
    asked = {int(j) for j in joints}
    while gone := [s for s in search.steps if _is_of(s, asked, search.current)]:
        terms = terms_without(gone, search.current.model.terms)
        plain = with_motion_noise(_with_friction(search.current, terms, asked), search.seed)
        loud = set(map(int, np.flatnonzero(over_noise(plain) > LOUD)))
        if not asked & loud:
            go_on_without(search, gone)
            return
        asked -= loud


def _is_of(step: Step, joints: Collection[int], current: Estimate) -> bool:
    """Whether an addition that a model has is one of some joints, and no everyday one."""
    law = step.added.law
    plain = law.everyday or law.in_one_log
    return step.added.joint in joints and not plain and has(step.added, current.model.terms)


def _with_friction(current: Estimate, terms: Sequence[Term], joints: Collection[int]) -> Estimate:
    """The fit of some terms with the everyday laws of some joints beside them."""
    plain = replace(current.model, terms=tuple(terms))
    eligible = eligible_terms(plain, current.motions)
    everyday = (t for t in eligible if t.joint in joints and t.law.everyday)
    return refit(current, (*terms, *everyday))
