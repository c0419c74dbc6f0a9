"""A found law, and the catalog laws that only stood in for it: what nobody needs beside it is taken back."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.worth import Score, passes
from jaxswarm.diagnose.discovery.front import Point
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.refit import fit_from, refit
from jaxswarm.diagnose.selection.step import Step, chain, find_term
from jaxswarm.effects.alike import has, without
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import Model


@dataclass(frozen=True)
class Rival:
    """A formula that fits like the chosen one.

    Attributes:
        point: The formula as the front has it.
        term: Its term.
        model: The model with it in place of the chosen one.
        rms: RMS difference of the two torques on the log [N m or N].
        over_noise: The same over the joint's noise.
    """

    point: Point
    term: Term
    model: Model
    rms: float
    over_noise: float


@dataclass(frozen=True)
class Discovery:
    """A law that was found as a formula.

    Attributes:
        added: Its term, with the values of the fit after it.
        score: What it was worth.
        chosen: The formula as the front has it.
        alternatives: What fits alike, with the terms they would be.
        front: The shortest formulas that reach each error on other motion.
        tried: Programs that were tried.
        based_on: Known laws whose shape it bends; empty: none.
        before, after: The estimates around it.
        removed: Terms that became superfluous.
        rest: As of a :class:`Step`, which the report takes it for.
        rivals: The alternatives, fitted in its place.
    """

    added: Term
    score: Score
    chosen: Point
    alternatives: tuple[tuple[Point, Term], ...]
    front: tuple[Point, ...]
    tried: int
    based_on: tuple[str, ...]
    before: Estimate
    after: Estimate
    removed: tuple[Term, ...] = ()
    rest: Model | None = None
    rivals: tuple[Rival, ...] = ()


# A sign so many times wider than those of the other joints of its kind has taken up something else.
_WIDE = 4.0


def bared(diagnosis: Diagnosis, joint: int, whole_arm: bool = False) -> Diagnosis | None:
    """The diagnosis without what may stand in for a law that nobody knows on a joint; None: there is nothing.

    That are laws of the catalog which were added there and together have bent themselves to it, and a sign far
    wider than those of other joints, which imitates any drag that saturates: what they leave of the law has
    another form than it has. With ``whole_arm`` also laws of the whole arm: what pulls on two joints looks like
    a tilt of the base to both; None then if there are none of these.
    """
    places = (joint, None) if whole_arm else (joint,)
    own = [step for step in diagnosis.kept if step.added.joint in places]
    final = diagnosis.final
    width = _usual_width(final.model, joint)
    if whole_arm:
        if all(step.added.joint == joint for step in own):
            return None
    elif not own and width is None:
        return None
    terms, steps = final.model.terms, list(diagnosis.steps)
    for step in own:
        terms, steps = _undone(diagnosis, step, terms, steps)
    if width is None:
        rest = refit(final, terms)
    else:
        start = np.asarray(final.model.robot.parameters).ravel()
        rest = fit_from(final, start, terms, width, refine_width=False)
    return replace(
        diagnosis,
        final=rest,
        steps=tuple(chain(steps)),
        crossfit=cross_fit(rest),
        withdrawn=(*diagnosis.withdrawn, *(step.added for step in own)),
    )


def _undone(
    diagnosis: Diagnosis, step: Step, terms: tuple[Term, ...], steps: Sequence[Step]
) -> tuple[tuple[Term, ...], list[Step]]:
    """A model's terms and its steps without one of these: declared terms that it had replaced come back.

    What was added before and had been replaced by it goes too. Of a damper that holds one way only asymmetric
    friction had taken the place of the declared Coulomb friction; with the damper's own formula its two levels
    were one, and it was told beside it.
    """
    gone = [step]
    for one in reversed(diagnosis.steps):
        if any(has(one.added, s.removed) for s in gone):
            gone.append(one)
    declared = diagnosis.declared.model.terms
    back = [t for s in gone for t in s.removed if has(t, declared) and not has(t, terms)]
    left = [s for s in steps if all(s is not one for one in gone)]
    return (*without(step.added, terms), *back), left


def _usual_width(model: Model, joint: int) -> tuple[float, ...] | None:
    """The widths of all signs with a far too wide one as those of the other joints; None: it is not wide."""
    kinds = model.robot.kinds
    others = [w for k, w in enumerate(model.width) if k != joint and kinds[k] == kinds[joint]]
    if not others or model.width[joint] < _WIDE * np.median(others):
        return None
    usual = float(np.median(others))
    return tuple(usual if k == joint else w for k, w in enumerate(model.width))


def shows_on(step: Step) -> int:
    """The joint of an added law; of one of the whole arm, such as a contact, that on which it shows most."""
    return step.score.joint if step.added.joint is None else step.added.joint


def without_stand_ins(
    diagnosis: Diagnosis, found: Discovery, seed: int
) -> tuple[Diagnosis, Discovery]:
    """The diagnosis with a found law, and without what was added before and is not needed beside it.

    An effect of the catalog that was added before, on whatever joint, is asked for again in its absence; if it
    does not pass, it had told a part of the law that was not known then. Of a power of the position times two
    of the load two short stretches were told as contacts; beside a balancer of joint 3 two drives had false
    gains.
    """
    after, steps, gone = found.after, list(diagnosis.steps), []
    for step in diagnosis.kept:
        terms, left = _undone(diagnosis, step, after.model.terms, steps)
        rest = refit(after, terms)
        lin = Linearization(rest, cross_fit(rest))
        scores = score_terms(lin, [replace(step.added, values={})], seed)
        if any(passes(s, diagnosis.asked, diagnosis.rules) for s in scores):
            continue
        after, steps = rest, left
        gone.append(step.added)
    before = found.before
    if gone:
        steps = chain(steps)
        before = steps[-1].after if steps else diagnosis.declared
    after = with_motion_noise(after, seed)
    added = find_term(after, found.added)
    return (
        replace(
            diagnosis,
            final=after,
            steps=tuple(steps),
            crossfit=cross_fit(after),
            withdrawn=(*diagnosis.withdrawn, *gone),
        ),
        replace(found, added=added, before=before, after=after),
    )
