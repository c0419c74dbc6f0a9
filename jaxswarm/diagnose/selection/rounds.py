"""The driver of a selection, whatever it is asked: what a model lacks, or what changed since a model.

One round is one look at all candidates against the current model; what passes is acted on, and the next round
sees the model with it. The search is over when nothing is done any more.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from jaxswarm import memory
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.competing import accepted
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.diagnose.selection.budget import Spent
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.term import Term


def _never(search: Search, lin: Linearization, eligible: Sequence[Term]) -> bool:
    return False


def _signless(search: Search, term: Term) -> bool:
    return False


@dataclass(frozen=True)
class Question:
    """What is asked, as functions of the selection under way.

    Attributes:
        told: What a round does, in words.
        cross_fit: The current model on all folds.
        eligible: Terms that are asked in this round.
        held: Identities of what the model has by now.
        act: Do something about those that passed, or about nobody having passed; whether another round
            is worth it.
        allow: Allow for something that is no effect; whether the round begins anew with it.
        signed: Whether a term is a change of something known, of either sign.
    """

    told: Callable[[Search], str]
    cross_fit: Callable[[Search], CrossFit]
    eligible: Callable[[Search], list[Term]]
    held: Callable[[Search], set]
    act: Callable[[Search, list[Score]], bool]
    allow: Callable[[Search, Linearization, Sequence[Term]], bool] = _never
    signed: Callable[[Search, Term], bool] = _signless


def run_rounds(search: Search, question: Question, most: int) -> None:
    """Ask until nothing is done any more, at most so many rounds and a last look, or the time is over.

    Where a round left the model as it was, since what it would have added was refused, all others are worth
    what they were: on seven joints eight rounds in a row asked 290 laws each, and refused one.
    """
    looked, asked = None, frozenset[Term]()
    for number in range(1, most + 2):
        memory.give_back()
        search.left = most - number
        search.progress(f"round {number}: {question.told(search)}")
        same = search.current is looked
        if not same:
            search.crossfit = question.cross_fit(search)
        if search.budget.spent:
            search.spent = Spent(search.budget.seconds, number - 1)
            search.progress(search.spent.sentence)
            held = question.held(search)
            search.scores = [s for s in search.scores if s.candidate.term.identity not in held]
            return
        eligible = question.eligible(search)
        if same and asked.issuperset(eligible):
            search.scores = [s for s in search.scores if s.candidate.term in eligible]
        # The last look is at the model as it will be told.
        elif not _scored(search, question, eligible, number <= most):
            continue
        looked, asked = search.current, frozenset(eligible)
        search.asked = search.asked or len(search.scores)
        passed = accepted(search.scores, search.rules, search.added)
        if number > most:
            search.ended = bool(passed)
            return
        if not question.act(search, passed):
            return


def _scored(search: Search, question: Question, eligible: Sequence[Term], allows: bool) -> bool:
    """Score what is asked; False where something that is no effect was allowed for first, if it may be."""
    lin = Linearization(search.current, search.folds, search.memory)
    if allows and question.allow(search, lin, eligible):
        return False
    signed = partial(question.signed, search)
    search.scores = []  # their columns are as large as those of the scores to come
    search.scores = score_terms(lin, eligible, search.seed, signed)
    return True
