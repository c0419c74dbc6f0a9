"""The outcome of the selection."""

from dataclasses import dataclass
from typing import NamedTuple

from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.diagnose.selection.budget import Spent
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate

_ENDED = "the search ended by its number of rounds: more would be added; declare what is known and ask again"


class Outdone(NamedTuple):
    """A law, and waves of its joint that leave clearly less though no whole period of them is seen.

    Attributes:
        law, waves: Both as fitted.
        period: Way on which the waves repeat [rad or m].
    """

    law: Term
    waves: Term
    period: float


@dataclass(frozen=True)
class Diagnosis:
    """The outcome of the loop.

    Attributes:
        declared: The estimate of the declared model.
        final: The estimate after the last step.
        steps: What was added, in order.
        last: Scores of all candidates in the final round, in which nobody passed.
        crossfit: The folds of the final model.
        asked: Candidates asked in the first round.
        withdrawn: What was added and later exchanged or dropped, with all effects in place.
        ended: Whether the search ended by its number of rounds, and more might be added.
        rules: Thresholds that decided.
        refused: What was found and not kept, and why.
        outdone: What was refused for such waves.
        spent: The budget that ended the search; None: it came to its own end.
    """

    declared: Estimate
    final: Estimate
    steps: tuple[Step, ...]
    last: tuple[Score, ...]
    crossfit: CrossFit
    asked: int
    withdrawn: tuple[Term, ...] = ()
    refused: tuple[tuple[Term, str], ...] = ()
    outdone: tuple[Outdone, ...] = ()
    ended: bool = False
    rules: Rules = Rules()
    spent: Spent | None = None

    @property
    def kept(self) -> tuple[Step, ...]:
        """The steps whose effect was not removed again by a later one."""
        gone = {t.identity for step in self.steps for t in step.removed}
        return tuple(step for step in self.steps if step.added.identity not in gone)

    @property
    def cut_short(self) -> list[str]:
        """Why the search did not come to its own end, in a sentence; empty: it did."""
        return [_ENDED] * self.ended + ([self.spent.sentence] if self.spent else [])
