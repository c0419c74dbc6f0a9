"""The steps of the loop, and the chain of models they make."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from jaxswarm.diagnose.decision.competing import overlap, tell_one_lag
from jaxswarm.diagnose.decision.rules import ASKED_AGAIN, OVERLAP
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.effects.alike import has, lacking, number_of, without
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import Model

# Competitors of an effect that are asked again.
_MOST = 3


class Addition(Protocol):
    """What the report tells of everything that was added: a law of the catalog, or one found as a formula."""

    @property
    def added(self) -> Term:
        """The term, with the values of the fit after it."""

    @property
    def score(self) -> Score:
        """What it was worth."""

    @property
    def before(self) -> Estimate:
        """The estimate before it."""

    @property
    def after(self) -> Estimate:
        """The estimate after it."""

    @property
    def removed(self) -> tuple[Term, ...]:
        """Terms that became superfluous."""

    @property
    def rest(self) -> Model | None:
        """The final model without it, where that is not the model without the term."""


@dataclass(frozen=True)
class Step:
    """An added effect with the evidence for it.

    Attributes:
        added: The term, with the values of the fit after it.
        score: What it was worth.
        rivals: Terms the data did not tell from it.
        others: Scores of the runners-up.
        near: Those of them that passed too and say much the same on the same joint.
        before, after: The estimates around it.
        removed: Terms that became superfluous.
        rest: The final model without the effect, where that is not the model without the term.
    """

    added: Term
    score: Score
    rivals: tuple[Score, ...]
    others: tuple[Score, ...]
    before: Estimate
    after: Estimate
    removed: tuple[Term, ...]
    near: tuple[Score, ...] = ()
    rest: Model | None = None


def step_between(
    score: Score,
    before: Estimate,
    after: Estimate,
    rivals: tuple[Score, ...] = (),
    others: tuple[Score, ...] = (),
    near: tuple[Score, ...] = (),
) -> Step:
    """The step from one fit to the next, which has the term of a score in it."""
    added = find_term(after, score.candidate.term)
    removed = lacking(before.model.terms, after.model.terms)
    return Step(added, score, rivals, others, before, after, removed, near)


def near_ones(chosen: Score, passed: Sequence[Score], crossfit: CrossFit) -> tuple[Score, ...]:
    """Competitors of a chosen effect: what passed too, gains as much and says the same, the best first.

    Of each law the best: six cables from one joint left no room for the spring that they all contain.
    An encoder and the gear of one joint are two causes of one thing, a link elsewhere than it seems.
    """

    def says_the_same(s: Score) -> bool:
        alike = s.joint == chosen.joint
        return alike and overlap(chosen.candidate, s.candidate, crossfit) > OVERLAP

    best: dict[str, Score] = {}
    for s in sorted(passed, key=lambda s: -s.gain):
        if (
            s is not chosen
            and s.gain > ASKED_AGAIN * chosen.gain
            and not s.candidate.term.law.recurring
            and (tell_one_lag(chosen, s) or says_the_same(s))
        ):
            best.setdefault(s.candidate.term.effect, s)
    return tuple(best.values())[:_MOST]


def competitors(step: Step) -> list[Term]:
    """Terms that came near a chosen one when it was added.

    It may be one of them, where it has come in the place of another one since.
    """
    known = {s.candidate.term.identity: s.candidate.term for s in (*step.rivals, *step.near)}
    own = replace(step.added, values={}).identity
    return [t for t in known.values() if replace(t, values={}).identity != own]


def chain(steps: Sequence[Step]) -> list[Step]:
    """The same steps with the estimates before and after each as the exchanged effects make them."""
    done: list[Step] = []
    for step in steps:
        before = done[-1].after if done else step.before
        gone = {t.identity for t in step.removed}
        kept = tuple(t for t in before.model.terms if t.identity not in gone)
        after = refit(before, (*kept, step.added))
        done.append(replace(step, added=find_term(after, step.added), before=before, after=after))
    return done


def terms_before(step: Step, terms: Sequence[Term]) -> tuple[Term, ...]:
    """The terms of a model that has an addition without it, and with what it took the place of.

    Friction of both directions takes the place of the declared one, which no joint may lose with it.
    """
    return (*without(step.added, terms), *(t for t in step.removed if not has(t, terms)))


def with_errors(term: Term, found: Estimate) -> tuple[Term, dict[str, float]] | None:
    """A term as a model has it, with its standard errors; None: the model has none in its place."""
    terms = found.model.terms
    if not has(term, terms):
        return None
    number = number_of(term, terms)
    return terms[number], found.std_errors[number]


def find_term(found: Estimate, term: Term) -> Term:
    """A term of a model with its fitted values."""
    return found.model.terms[number_of(term, found.model.terms)]
