"""One joint searched for a formula: who is asked, what is put to the proof, and what becomes of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.remainder import remainders
from jaxswarm.diagnose.decision.rules import LOUD
from jaxswarm.diagnose.discovery.candidates import MOST_TERMS, candidates
from jaxswarm.diagnose.discovery.front import Point, front
from jaxswarm.diagnose.discovery.grammar import programs
from jaxswarm.diagnose.discovery.open_joints import Open
from jaxswarm.diagnose.discovery.partner import (
    Variables,
    named_partners,
    neighbors,
    without_joint,
)
from jaxswarm.diagnose.discovery.problem import Joint, joint_problem
from jaxswarm.diagnose.discovery.proof import (
    Proved,
    clearly_better,
    needed,
    parts_held_out,
    prove,
)
from jaxswarm.diagnose.discovery.refitted import (
    alike_refitted,
    better_elsewhere,
    descriptions,
    shorter,
)
from jaxswarm.diagnose.discovery.rivals import fit_alike
from jaxswarm.diagnose.discovery.seen_again import (
    alike_in_form,
    bare_of,
    shapes_of,
)
from jaxswarm.diagnose.discovery.stand_ins import Discovery
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion

# Formulas of one joint that are put to the proof.
_PROVED = 5
_TOO_SHORT = (
    "the log is too short to hold a region of its motion out, and there is none of other motion: "
    "give one with --validation"
)


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


def search_joint(
    diagnosis: Diagnosis, left: Open, other: Sequence[Motion], seed: int
) -> Discovery | NoFormula:
    """Search one joint: the best formula that proves itself, or why none does."""
    final, j = diagnosis.final, left.joint
    label = parts_held_out(diagnosis, other)
    if label is None:
        return NoFormula(j, 0, None, _TOO_SHORT)
    named = named_partners(j, left.depends_on, final.model.robot.joints)
    outcome = _search(diagnosis, left, named, label, other, seed)
    beside = neighbors(j, named, final.model.robot.num_joints)
    if left.named or not beside:
        return outcome
    most, near = MOST_TERMS, False
    if isinstance(outcome, Discovery) and remainders(outcome.after)[j].near:
        # Beside a law that leaves noise only one with fewer terms is better, as one law of two joints is.
        near, most = True, min(MOST_TERMS, len(outcome.chosen.formula.pieces) - 1)
        if not most:
            return outcome
    again = _search(diagnosis, left, beside, label, other, seed, outcome.tried, most)
    if isinstance(again, NoFormula):
        return replace(outcome, tried=again.tried)
    if isinstance(outcome, NoFormula) or clearly_better(outcome.after, again.after, j, other):
        return again
    return again if near and _shorter(again, outcome) else outcome


def _shorter(one: Discovery, other: Discovery) -> bool:
    """Whether a formula and what it leaves are described in fewer bits than another one, all refitted.

    Of dq^2 abs(load) cos(q_other) two terms without the partner left a sixth more than the noise.
    """
    first, second = descriptions([(d.chosen, d.after) for d in (one, other)])
    return first < second


def _search(
    diagnosis: Diagnosis,
    left: Open,
    variables: Sequence[Variables],
    label: np.ndarray,
    other: Sequence[Motion],
    seed: int,
    tried: int = 0,
    terms: int = MOST_TERMS,
) -> Discovery | NoFormula:
    """Search one joint with each of the given partners and further fields, after ``tried`` programs."""
    final, j = diagnosis.final, left.joint
    ranked: list[tuple[Joint, Point]] = []
    for partner, wanted in variables:
        problem = problem_of(diagnosis, j, partner, wanted)
        pieces = programs(problem.data, problem.units, problem.angles)
        problem, points, count = candidates(problem, pieces, label, seed, terms)
        tried += count
        ranked += [(problem, one) for one in points]
    ranked.sort(key=lambda pair: pair[1].length)
    why = "no program explains anything of it"
    for problem, one in ranked[:_PROVED]:
        outcome = prove(diagnosis, left, problem, one, tried, other)
        if isinstance(outcome, str):
            why = why if one is not ranked[0][1] else outcome
            continue
        points = [p for own, p in ranked if own is problem]
        one, outcome = needed(diagnosis, left, problem, one, tried, other, outcome)
        again = _seen_again(diagnosis, left, problem, one, points, tried, other, seed, outcome)
        if again is not None:
            problem, points, count, outcome = again
            one, tried = points[0], tried + count
        one, outcome = _refitted(diagnosis, left, problem, one, points, tried, other, outcome)
        term, item, after = outcome
        return Discovery(
            find_term(after, term),
            item,
            one,
            fit_alike(problem, one, points),
            tuple(front([p for _, p in ranked])),
            tried,
            _known_shapes(one),
            final,
            after,
        )
    return NoFormula(j, tried, ranked[0][1] if ranked else None, why)


def problem_of(
    diagnosis: Diagnosis,
    joint: int,
    partner: int | None,
    wanted: list[str],
    seen: Estimate | None = None,
) -> Joint:
    """A joint with a partner, whose rows are left out if it lacks something as well.

    ``seen``: the model whose loads all laws on the joint go by; None: the present one.
    """
    final, both = diagnosis.final, diagnosis.crossfit
    rows = both
    if partner is not None and not remainders(final)[partner].near:
        rows = without_joint(both, partner)
    lin = Linearization(final, rows)
    if seen is not None:
        lin.loads = Linearization(seen, lin.crossfit).loads
    problem = joint_problem(lin, joint, partner, wanted)
    return problem if rows is both else replace(problem, both=both)


def _seen_again(
    diagnosis: Diagnosis,
    left: Open,
    problem: Joint,
    one: Point,
    others: Sequence[Point],
    tried: int,
    other: Sequence[Motion],
    seed: int,
    outcome: Proved,
) -> tuple[Joint, list[Point], int, Proved] | None:
    """The joint, the formulas and the proof of another shape that a proved formula takes; None: it stays.

    Its loads and widths are then those of the model with the law.
    """
    term, _, after = outcome
    bare = bare_of(diagnosis, after, find_term(after, term))
    wanted = [name for name in ("t", "temperature") if name in problem.data]
    own = problem_of(bare, left.joint, problem.other, wanted, after)
    label = parts_held_out(bare, other)
    assert label is not None  # it was when the formula was found
    # Of a law that leaves more than noise, what was next to it may come nearer in the model that it led to.
    loud = remainders(after)[left.joint].over_noise > LOUD
    starts = [one.formula, *(p.formula for p in others if loud)]
    points, count = shapes_of(own, starts, label, seed)
    if alike_in_form(points[0].formula, one.formula):
        return None
    proved = prove(bare, left, own, points[0], tried + count, other)
    if isinstance(proved, str) or clearly_better(proved[2], after, left.joint, other):
        return None
    return own, points, count, proved


def _refitted(
    diagnosis: Diagnosis,
    left: Open,
    problem: Joint,
    one: Point,
    points: Sequence[Point],
    tried: int,
    other: Sequence[Motion],
    outcome: Proved,
) -> tuple[Point, Proved]:
    """Of formulas that fit alike and prove themselves the one that other motion speaks for.

    Without other logs, or where they do not tell, it is the one that says most of the log with all refitted.
    """
    term, _, after = outcome
    fits = alike_refitted(problem, one, points, after, find_term(after, term))
    told = better_elsewhere(fits, diagnosis.final, left.joint, other)
    for point in told or shorter(fits):
        proved = prove(diagnosis, left, problem, point, tried, other)
        if not isinstance(proved, str):
            return point, proved
    return one, outcome


def _known_shapes(one: Point) -> tuple[str, ...]:
    """Known laws whose shape a formula holds."""
    return tuple(dict.fromkeys(p.based_on for p in one.formula.pieces if p.based_on))
