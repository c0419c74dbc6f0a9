"""A formula for what no law explains: search, prove, add; or say that there is none.

A formula passes by the rules of the catalog's laws, its chance divided by the number of programs that were
tried, and it has to reach what a smooth function of the same residual does: else it stands for a law that the
grammar does not hold. Then the model is refitted with it, and it must survive on other motion as any addition.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.remainder import material, remainders
from jaxswarm.diagnose.decision.rules import CLEARLY_LESS, LOUD, MOST_LEFT, OF_SMOOTH
from jaxswarm.diagnose.decision.score import Score, passes, score
from jaxswarm.diagnose.decision.unexplained import find_unexplained
from jaxswarm.diagnose.discovery.as_term import candidate_of
from jaxswarm.diagnose.discovery.candidates import candidates
from jaxswarm.diagnose.discovery.front import Point, front
from jaxswarm.diagnose.discovery.grammar import programs
from jaxswarm.diagnose.discovery.problem import Joint, joint_problem
from jaxswarm.diagnose.discovery.rivals import fit_alike, fitted_rivals
from jaxswarm.diagnose.discovery.stand_ins import Discovery, bared, without_stand_ins
from jaxswarm.diagnose.folds.other_motion import regions
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.elsewhere import errors_elsewhere
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import Step, find_term
from jaxswarm.diagnose.selection.survives import harmful, survives
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion

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


class Search(NamedTuple):
    """The outcome of a search: what was found, and the joints that were searched in vain."""

    found: tuple[Discovery, ...]
    vain: tuple[NoFormula, ...]


class _Open(NamedTuple):
    """A joint to be searched: what its residual depends on, and how much of it a smooth function explains.

    ``named``: laws of the catalog explain it nearly, and may have been bent to do so.
    """

    joint: int
    depends_on: tuple[str, ...]
    share: float
    named: bool = False


def discover(
    diagnosis: Diagnosis,
    other: Sequence[Motion] = (),
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
) -> tuple[Diagnosis, Search]:
    """Search a law for every joint whose residual is structured, or far from the noise.

    Args:
        diagnosis: The loop's outcome, in which nobody passed any more.
        other: Logs of other motion, on which a formula has to survive.
        seed: Of the swarms.
        progress: Called with one line per joint.

    Returns:
        The diagnosis with the formulas in its final model, and what was found and what was not.
    """
    found: list[Discovery] = []
    vain: list[NoFormula] = []
    done: set[int] = set()
    joints = diagnosis.final.model.robot.joints
    while True:
        waiting = [one for one in _to_be_searched(diagnosis, seed) if one.joint not in done]
        if not waiting:
            return diagnosis, Search(tuple(found), tuple(vain))
        done.add(waiting[0].joint)
        progress(f"searching a formula for {joints[waiting[0].joint]}")
        diagnosis, outcome = _discover_instead(diagnosis, waiting[0], other, seed)
        if isinstance(outcome, NoFormula):
            vain += [] if waiting[0].named else [outcome]
            continue
        diagnosis, outcome = without_stand_ins(diagnosis, outcome, seed)
        found.append(replace(outcome, rivals=fitted_rivals(outcome)))


def _to_be_searched(diagnosis: Diagnosis, seed: int) -> list[_Open]:
    """Joints that no law explains, then those on which laws were added and more than noise is left."""
    told = _unlawful(diagnosis, seed)
    known = {one.joint for one in told}
    added = {step.added.joint for step in diagnosis.kept} - known
    loud = [r for r in remainders(diagnosis.final) if r.over_noise > LOUD and r.joint in added]
    return told + [_Open(r.joint, (), 0.0, named=True) for r in loud]


def _unlawful(diagnosis: Diagnosis, seed: int) -> list[_Open]:
    """Joints that no law explains: those whose structure was found, then those only far from the noise."""
    final = diagnosis.final
    remains = remainders(final)
    found = material(find_unexplained(final, diagnosis.crossfit, seed), remains)
    told = [_Open(u.joint, u.depends_on, u.share) for u in sorted(found, key=lambda u: -u.share)]
    known = {one.joint for one in told}
    far = [r for r in remains if not r.near and r.joint not in known]
    return told + [_Open(r.joint, (), 0.0) for r in sorted(far, key=lambda r: -r.over_noise)]


def _discover_instead(
    diagnosis: Diagnosis, left: _Open, other: Sequence[Motion], seed: int
) -> tuple[Diagnosis, Discovery | NoFormula]:
    """Search one joint in place of what may stand in for its law; if that is not clearly better, beside it.

    Not beside it where it explains the joint nearly: what is left is then no law of its own.
    """
    bare = bared(diagnosis, left.joint)
    again = [] if bare is None else [o for o in _unlawful(bare, seed) if o.joint == left.joint]
    if again:
        outcome = _discover_on(bare, again[0], other, seed)
        if isinstance(outcome, Discovery) and _clearly_better(
            diagnosis.final, outcome.after, left.joint, other
        ):
            return bare, outcome
    if left.named:
        return diagnosis, NoFormula(left.joint, 0, None, "laws of the catalog explain it as well")
    return diagnosis, _discover_on(diagnosis, left, other, seed)


def _clearly_better(named: Estimate, found: Estimate, joint: int, other: Sequence[Motion]) -> bool:
    """Whether a formula leaves clearly less than named laws do, where they were fitted and elsewhere."""
    two, one = (remainders(fit)[joint].over_noise for fit in (found, named))
    pairs = [
        (float(b[joint]), float(a[joint])) for a, b, *_ in errors_elsewhere(named, found, other)
    ]
    return all(b < CLEARLY_LESS * a for b, a in [(two, one), *pairs])


def _discover_on(
    diagnosis: Diagnosis, left: _Open, other: Sequence[Motion], seed: int
) -> Discovery | NoFormula:
    """Search one joint."""
    final, j = diagnosis.final, left.joint
    label = regions(final)
    if label is None:
        return NoFormula(j, 0, None, "the log is too short to hold a region of its motion out")
    lin = Linearization(final, diagnosis.crossfit)
    ranked: list[tuple[Joint, Point]] = []
    tried = 0
    for partner, wanted in _variables(left, final.model.robot.joints):
        problem = joint_problem(lin, j, partner, wanted)
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
        term, item, after = outcome
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


def _variables(left: _Open, joints: tuple[str, ...]) -> list[tuple[int | None, list[str]]]:
    """Partner joint and further fields, as the residual's dependence names them: one search each."""
    own = joints[left.joint]
    named = [name.split("_", 1) if "_" in name else [name, own] for name in left.depends_on]
    wanted = [quantity for quantity, _ in named if quantity in ("t", "temperature")]
    partners = dict.fromkeys(joints.index(joint) for _, joint in named if joint != own)
    return [(partner, wanted) for partner in partners] or [(None, wanted)]


def _prove(
    diagnosis: Diagnosis,
    left: _Open,
    problem: Joint,
    one: Point,
    tried: int,
    other: Sequence[Motion],
) -> tuple[Term, Score, Estimate] | str:
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


def _known_shapes(one: Point) -> tuple[str, ...]:
    """Known laws whose shape a formula holds."""
    return tuple(dict.fromkeys(p.based_on for p in one.formula.pieces if p.based_on))
