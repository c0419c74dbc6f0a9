"""One joint searched for a formula: who is asked, what is put to the proof, and what becomes of it.

A formula passes by the rules of the catalog's laws, its chance divided by the number of programs that were
tried, and it has to reach what a smooth function of the same residual does: else it stands for a law that the
grammar does not hold. Then the model is refitted with it, and it must survive on other motion as any addition.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.remainder import material, remainders
from jaxswarm.diagnose.decision.rules import CLEARLY_LESS, MOST_LEFT, OF_SMOOTH
from jaxswarm.diagnose.decision.score import Score, passes, score
from jaxswarm.diagnose.decision.unexplained import find_unexplained
from jaxswarm.diagnose.discovery.as_term import candidate_of
from jaxswarm.diagnose.discovery.candidates import candidates
from jaxswarm.diagnose.discovery.front import Point, front, point, region_folds, strict
from jaxswarm.diagnose.discovery.grammar import programs
from jaxswarm.diagnose.discovery.partner import (
    Variables,
    named_partners,
    neighbors,
    without_joint,
)
from jaxswarm.diagnose.discovery.problem import Joint, joint_problem
from jaxswarm.diagnose.discovery.rivals import fit_alike
from jaxswarm.diagnose.discovery.stand_ins import Discovery
from jaxswarm.diagnose.discovery.sums import polished, without_term
from jaxswarm.diagnose.folds.other_motion import regions
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.elsewhere import errors_elsewhere
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import Step, find_term
from jaxswarm.diagnose.selection.survives import harmful, survives
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion

# A formula that was proved: its term, its score, and the model with it.
Proved = tuple[Term, Score, Estimate]
# Formulas of one joint that are put to the proof.
_PROVED = 5


@dataclass(frozen=True)
class NoFormula:
    """A joint that was searched in vain.

    Attributes:
        joint: Index.
        tried: Programs that were tried.
        nearest: The best formula; None: none explains anything.
        because: Why it was not added.
    """

    joint: int
    tried: int
    nearest: Point | None
    because: str


class Open(NamedTuple):
    """A joint to be searched: what its residual depends on, and how much of it a smooth function explains.

    ``named``: laws of the catalog explain it nearly, and may have been bent to do so.
    """

    joint: int
    depends_on: tuple[str, ...]
    share: float
    named: bool = False


def unlawful(diagnosis: Diagnosis, seed: int) -> list[Open]:
    """Joints that no law explains: those whose structure was found, then those only far from the noise."""
    final = diagnosis.final
    remains = remainders(final)
    found = material(find_unexplained(final, diagnosis.crossfit, seed), remains)
    told = [Open(u.joint, u.depends_on, u.share) for u in sorted(found, key=lambda u: -u.share)]
    known = {one.joint for one in told}
    far = [r for r in remains if not r.near and r.joint not in known]
    return told + [Open(r.joint, (), 0.0) for r in sorted(far, key=lambda r: -r.over_noise)]


def search_joint(
    diagnosis: Diagnosis, left: Open, other: Sequence[Motion], seed: int
) -> Discovery | NoFormula:
    """Search one joint: the best formula that proves itself, or why none does."""
    final, j = diagnosis.final, left.joint
    label = regions(final)
    if label is None:
        return NoFormula(j, 0, None, "the log is too short to hold a region of its motion out")
    named = named_partners(j, left.depends_on, final.model.robot.joints)
    outcome = _search(diagnosis, left, named, label, other, seed)
    beside = neighbors(j, named, final.model.robot.num_joints)
    near = isinstance(outcome, Discovery) and remainders(outcome.after)[j].near
    if left.named or left.depends_on or near or not beside:
        return outcome
    again = _search(diagnosis, left, beside, label, other, seed, outcome.tried)
    if isinstance(again, NoFormula):
        return replace(outcome, tried=again.tried)
    if isinstance(outcome, NoFormula) or clearly_better(outcome.after, again.after, j, other):
        return again
    return outcome


def _search(
    diagnosis: Diagnosis,
    left: Open,
    variables: Sequence[Variables],
    label: np.ndarray,
    other: Sequence[Motion],
    seed: int,
    tried: int = 0,
) -> Discovery | NoFormula:
    """Search one joint with each of the given partners and further fields, after ``tried`` programs."""
    final, j = diagnosis.final, left.joint
    ranked: list[tuple[Joint, Point]] = []
    for partner, wanted in variables:
        problem = _problem(diagnosis, j, partner, wanted)
        pieces = programs(problem.data, problem.units, problem.angles)
        points, count = candidates(problem, pieces, label, seed)
        tried += count
        ranked += [(problem, one) for one in points]
    ranked.sort(key=lambda pair: pair[1].length)
    why = "no program explains anything of it"
    for problem, one in ranked[:_PROVED]:
        outcome = _prove(diagnosis, left, problem, one, tried, other)
        if isinstance(outcome, str):
            why = why if one is not ranked[0][1] else outcome
            continue
        one, (term, item, after) = _needed(diagnosis, left, problem, one, tried, other, outcome)
        return Discovery(
            find_term(after, term),
            item,
            one,
            fit_alike(problem, one, [p for own, p in ranked if own is problem]),
            tuple(front([p for _, p in ranked])),
            tried,
            _known_shapes(one),
            final,
            after,
        )
    return NoFormula(j, tried, ranked[0][1] if ranked else None, why)


def _problem(diagnosis: Diagnosis, joint: int, partner: int | None, wanted: list[str]) -> Joint:
    """A joint with a partner, whose rows are left out if it lacks something as well."""
    final, both = diagnosis.final, diagnosis.crossfit
    if partner is None or remainders(final)[partner].near:
        return joint_problem(Linearization(final, both), joint, partner, wanted)
    lin = Linearization(final, without_joint(both, partner))
    return replace(joint_problem(lin, joint, partner, wanted), both=both)


def _prove(
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


def _needed(
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
    label = regions(diagnosis.final)
    assert label is not None  # it was when the formula was found
    folds = region_folds(problem.lin.crossfit.whole, label)
    for k in range(len(one.formula.pieces) if len(one.formula.pieces) > 1 else 0):
        formula = polished(problem, without_term(one.formula, k), problem.lin.crossfit.whole)
        less = strict(problem, point(problem, formula, folds), folds)
        shorter = _prove(diagnosis, left, problem, less, tried, other)
        if isinstance(shorter, str) or clearly_better(shorter[2], outcome[2], left.joint, other):
            continue
        return _needed(diagnosis, left, problem, less, tried, other, shorter)
    return one, outcome


def _known_shapes(one: Point) -> tuple[str, ...]:
    """Known laws whose shape a formula holds."""
    return tuple(dict.fromkeys(p.based_on for p in one.formula.pieces if p.based_on))


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
