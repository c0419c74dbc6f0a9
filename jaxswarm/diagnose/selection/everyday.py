"""What every drive has, proposed for all joints at once.

Where viscous and dry friction are missing on several joints, each joint's residual is their sum, and laws of
more parameters compete to be bent into it. Effects marked ``everyday`` are therefore added together before
anything rarer, wherever they are seen, and what the common fit does not confirm is dropped again.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.rules import EVERYDAY_CERTAIN, EVERYDAY_MATERIAL, Rules
from jaxswarm.diagnose.decision.score import Score, passes
from jaxswarm.diagnose.folds.noise import noise_of
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.diagnose.selection.step import Step, find_term
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate

_TURNS = 4


def add_everyday(
    current: Estimate, scores: Sequence[Score], asked: int, rules: Rules
) -> tuple[list[Step], Estimate] | None:
    """The steps that add everyday effects together, and the fit with them; None where none is missing.

    Args:
        current: The model.
        scores: Of all candidates against it.
        asked: How many candidates there were.
        rules: Thresholds; at least one everyday effect has to pass them alone.
    """
    everyday = [s for s in scores if s.candidate.term.law.everyday]
    if not any(passes(s, asked, rules) for s in everyday):
        return None
    seen = [
        s for s in everyday if s.allowed and s.gain > 0 and s.p_value * asked < rules.significance
    ]
    noise = noise_of(current)
    for _ in range(_TURNS):
        terms = tuple(s.candidate.term for s in seen)
        after = refit(current, (*current.model.terms, *terms))
        kept = [s for s in seen if _is_needed(after, s.candidate.term, noise)]
        if len(kept) == len(seen):
            break
        seen = kept
        if not seen:
            return None
    steps = [Step(find_term(after, s.candidate.term), s, (), (), current, after, ()) for s in seen]
    return steps, after


def _is_needed(after: Estimate, term: Term, noise: np.ndarray) -> bool:
    """Whether a fitted term is certain, physical and more than a part of the noise."""
    number = next(k for k, t in enumerate(after.model.terms) if t.identity == term.identity)
    fitted, errors = after.model.terms[number], after.std_errors[number]
    names = after.regression.names
    own = [names.index(name) for name in fitted.columns(after.model.robot.joints)]
    values = np.array([fitted.values[p.name] for p in fitted.law.linear])
    doubts = np.array([errors[p.name] for p in fitted.law.linear])
    torque = after.regression.columns[:, term.joint, own] @ values
    return bool(
        (values >= [p.lower for p in fitted.law.linear]).all()
        and (np.abs(values) > EVERYDAY_CERTAIN * np.nan_to_num(doubts, nan=np.inf)).any()
        and np.sqrt((torque**2).mean()) > EVERYDAY_MATERIAL * noise[term.joint]
    )
