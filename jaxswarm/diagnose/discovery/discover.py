"""A formula for what no law explains: search, prove, add; or say that there is none.

Joints are searched one after the other, those first that leave most. Laws of the catalog that have bent
themselves to a law that nobody knows are taken away first, and stay away if the formula is clearly better. A
law between two joints acts on both, and what it does on one bends what is seen of it on the other: a formula
that was found before another one is searched again with that one in place.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

from jaxswarm.diagnose.decision.remainder import remainders
from jaxswarm.diagnose.decision.rules import LOUD
from jaxswarm.diagnose.discovery.joint_search import NoFormula, search_joint
from jaxswarm.diagnose.discovery.open_joints import Open, unlawful
from jaxswarm.diagnose.discovery.proof import clearly_better, stays_near
from jaxswarm.diagnose.discovery.rivals import fitted_rivals
from jaxswarm.diagnose.discovery.stand_ins import (
    Discovery,
    bared,
    shows_on,
    without_stand_ins,
)
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.effects.alike import without
from jaxswarm.logs.motion import Motion


class Search(NamedTuple):
    """The outcome of a search: what was found, and the joints that were searched in vain."""

    found: tuple[Discovery, ...]
    vain: tuple[NoFormula, ...]


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
            break
        done.add(waiting[0].joint)
        progress(f"searching a formula for {joints[waiting[0].joint]}")
        diagnosis, outcome = _discover_instead(diagnosis, waiting[0], other, seed)
        if isinstance(outcome, NoFormula):
            vain += [] if waiting[0].named else [outcome]
            continue
        diagnosis, outcome = without_stand_ins(diagnosis, outcome, seed)
        found.append(outcome)
    for earlier in tuple(found):
        if earlier is found[-1]:  # nothing was found after it
            break
        progress(f"searching the formula for {joints[earlier.added.index]} again")
        diagnosis, found = _searched_again(diagnosis, found, earlier, other, seed)
    told = (replace(one, rivals=fitted_rivals(one)) for one in found)
    return diagnosis, Search(tuple(told), tuple(vain))


def _searched_again(
    diagnosis: Diagnosis,
    found: list[Discovery],
    earlier: Discovery,
    other: Sequence[Motion],
    seed: int,
) -> tuple[Diagnosis, list[Discovery]]:
    """A formula searched anew beside those found after it; it stays unless another one is clearly better."""
    joint = earlier.added.index
    rest = refit(diagnosis.final, without(earlier.added, diagnosis.final.model.terms))
    bare = replace(diagnosis, final=rest, crossfit=cross_fit(rest))
    for left in [one for one in unlawful(bare, seed) if one.joint == joint]:
        outcome = search_joint(bare, left, other, seed)
        if isinstance(outcome, Discovery) and clearly_better(
            diagnosis.final, outcome.after, joint, other
        ):
            after = replace(diagnosis, final=outcome.after, crossfit=cross_fit(outcome.after))
            return after, [*(one for one in found if one is not earlier), outcome]
    return diagnosis, found


def _to_be_searched(diagnosis: Diagnosis, seed: int) -> list[Open]:
    """Joints that no law explains, then those on which laws were added and more than noise is left, or several.

    Two laws that nobody had declared are on one joint less often than one that nobody knows: of a rubber buffer
    a gravity compensator and a ripple left as little as its own form, of magnets a dead band and these two.
    """
    told = unlawful(diagnosis, seed)
    known = {one.joint for one in told}
    added = {shows_on(step) for step in diagnosis.kept} - known
    places = [step.added.joint for step in diagnosis.kept]
    doubted = [
        r
        for r in remainders(diagnosis.final)
        if r.joint in added and (r.over_noise > LOUD or places.count(r.joint) > 1)
    ]
    return told + [Open(r.joint, (), 0.0, named=True) for r in doubted]


def _discover_instead(
    diagnosis: Diagnosis, left: Open, other: Sequence[Motion], seed: int
) -> tuple[Diagnosis, Discovery | NoFormula]:
    """Search one joint in place of what may stand in for its law; if that is no better, beside it.

    Not beside it where it explains the joint nearly: what is left is then no law of its own.
    """
    for whole_arm in (False, True):
        bare = bared(diagnosis, left.joint, whole_arm)
        if bare is None:
            continue
        again = [o for o in unlawful(bare, seed) if o.joint == left.joint]
        if not again:
            continue
        outcome = search_joint(bare, again[0], other, seed)
        if (
            isinstance(outcome, Discovery)
            and (
                clearly_better(diagnosis.final, outcome.after, left.joint, other)
                or _one_for_several(diagnosis, outcome, other)
            )
            and (not whole_arm or stays_near(diagnosis.final, outcome.after))
        ):
            return bare, outcome
    if left.named:
        return diagnosis, NoFormula(left.joint, 0, None, "laws of the catalog explain it as well")
    return diagnosis, search_joint(diagnosis, left, other, seed)


def _one_for_several(diagnosis: Diagnosis, found: Discovery, other: Sequence[Motion]) -> bool:
    """Whether one term with fewer constants says what several laws of the catalog do on its joint."""
    joint, formula = found.added.index, found.added.found_formula
    laws = [s.added.law for s in diagnosis.kept if s.added.joint == joint and not s.removed]
    fewer = len(formula.parameters) < sum(len(law.parameters) for law in laws)
    return (
        len(laws) > 1
        and len(formula.terms) == 1
        and fewer
        and not clearly_better(found.after, diagnosis.final, joint, other)
    )
