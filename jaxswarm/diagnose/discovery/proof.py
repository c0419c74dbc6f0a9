"""A formula put to the proof: what it has to pass, and which of its terms the refitted model needs.

A formula passes by the rules of the catalog's laws, its chance divided by the number of programs that were
tried, and it has to reach what a smooth function of the same residual does: else it stands for a law that the
grammar does not hold. Then the model is refitted with it, and it must survive on other motion as any addition.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.remainder import remainders
from jaxswarm.diagnose.decision.rules import CLEARLY_LESS, MOST_LEFT, OF_SMOOTH
from jaxswarm.diagnose.decision.score import score
from jaxswarm.diagnose.decision.worth import Score, passes
from jaxswarm.diagnose.discovery.as_term import candidate_of
from jaxswarm.diagnose.discovery.front import Point, point, region_folds, strict
from jaxswarm.diagnose.discovery.open_joints import Open
from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.sums import polished, without_term
from jaxswarm.diagnose.folds.other_motion import regions
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.elsewhere import errors_elsewhere
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.diagnose.selection.survives import harmful, survives
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion

# A formula that was proved: its term, its score, and the model with it.
Proved = tuple[Term, Score, Estimate]


def parts_held_out(diagnosis: Diagnosis, other: Sequence[Motion]) -> np.ndarray | None:
    """Part of the motion of every row (T,), each predicted by a fit to the others; None: none can be.

    A log too short for regions of its states is searched by its blocks of time if other logs show what holds
    on other motion: on 15 s in a band of 1.5 Hz a magnet at 8 times the noise was not searched at all.
    """
    label = regions(diagnosis.final)
    return diagnosis.crossfit.block if label is None and other else label


def prove(
    diagnosis: Diagnosis,
    left: Open,
    problem: Joint,
    one: Point,
    tried: int,
    other: Sequence[Motion],
) -> Proved | str:
    """Put a formula to the proof: its term, its score and the model with it, or why it failed."""
    final = diagnosis.final
    if one.error > MOST_LEFT:
        return "the best formula leaves most of the error in regions of the motion it was not fitted to"
    candidate, term = candidate_of(problem, one.formula)
    item = score(candidate, diagnosis.crossfit, max(m.interval for m in final.motions))
    if not passes(item, tried + diagnosis.asked, diagnosis.rules):
        return "the best formula may be chance, given how many programs were tried, or is too small"
    if item.share < OF_SMOOTH * left.share:
        return "a smooth function explains clearly more than the best formula"
    after = refit_with(final, item)
    if after is None:
        return "the refit did not confirm the best formula"
    why = survives(final, after, problem.joint, other)
    if why is None:
        # Nothing more is added after it, so that no joint may lose by it.
        harm = harmful(final, [Step(term, item, (), (), final, after, ())], after, other)
        why = harm and harm[1]
    return f"the best formula {why}" if why else (term, item, after)


def needed(
    diagnosis: Diagnosis,
    left: Open,
    problem: Joint,
    one: Point,
    tried: int,
    other: Sequence[Motion],
    outcome: Proved,
) -> tuple[Point, Proved]:
    """A formula that was proved, without the terms that are not needed once all of the model is refitted.

    The load, the widths of signs and the parameters of the arm that a formula is searched with are those of a
    model that lacks it; what they are off by looks like a term more. Beside dq^3 tanh(load/s) that was a
    product of three variables, and with all refitted the law alone left as little.
    """
    label = parts_held_out(diagnosis, other)
    assert label is not None  # it was when the formula was found
    folds = region_folds(problem.lin.crossfit.whole, label)
    for k in range(len(one.formula.pieces) if len(one.formula.pieces) > 1 else 0):
        formula = polished(problem, without_term(one.formula, k), problem.lin.crossfit.whole)
        less = strict(problem, point(problem, formula, folds), folds)
        shorter = prove(diagnosis, left, problem, less, tried, other)
        if isinstance(shorter, str) or clearly_better(shorter[2], outcome[2], left.joint, other):
            continue
        return needed(diagnosis, left, problem, less, tried, other, shorter)
    return one, outcome


def clearly_better(named: Estimate, found: Estimate, joint: int, other: Sequence[Motion]) -> bool:
    """Whether a formula leaves clearly less than named laws do, where they were fitted and elsewhere."""
    two, one = (remainders(fit)[joint].over_noise for fit in (found, named))
    pairs = [
        (float(b[joint]), float(a[joint])) for a, b, *_ in errors_elsewhere(named, found, other)
    ]
    return all(b < CLEARLY_LESS * a for b, a in [(two, one), *pairs])


def stays_near(named: Estimate, found: Estimate) -> bool:
    """Whether every joint that named laws bring near its noise is there with a formula in their place."""
    pairs = zip(remainders(named), remainders(found), strict=True)
    return all(after.near for before, after in pairs if before.near)
