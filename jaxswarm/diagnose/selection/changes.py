r"""The loop against a model identified before: what changed since.

The earlier model is not refitted; it absorbs nothing. What is left, :math:`\tau - \hat\tau`, is put to
every candidate, among them now a payload and a change of what the model already holds, which may have
either sign. The changes found are fitted together, the earlier parameters held; their standard errors
respect autocorrelation as everywhere.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.journal import Journal
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.competing import choose
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.score import Rules, Score, accepted
from jaxswarm.diagnose.folds.partial_out import CrossFit, cross_fit
from jaxswarm.diagnose.selection.budget import Budget, Spent
from jaxswarm.diagnose.selection.change_apply import Change, changes_of, doubt_of, with_changes
from jaxswarm.diagnose.selection.change_fit import crossed
from jaxswarm.diagnose.selection.earlier_model import freeze
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.usable import check_usable
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Motion

_MOST_STEPS = 6


@dataclass(frozen=True)
class Comparison:
    """Outcome of a comparison with an earlier model.

    Attributes:
        before, after: The earlier model on the logs, and with the changes.
        changes: In the order they were found.
        stages: The estimates after each change.
        unseen: After each change, the residual (T, n) of every second block of time with the changes
            fitted to the others.
        last: Scores of the final round.
        background: Folds of the final round.
        asked: Candidates asked in the first round.
        refused: Candidates that explain something with values that cannot be believed, and why.
        spent: The budget that ended the search; None: it came to its own end.
    """

    before: Estimate
    after: Estimate
    changes: tuple[Change, ...]
    stages: tuple[Estimate, ...]
    unseen: tuple[np.ndarray, ...]
    last: tuple[Score, ...]
    background: CrossFit
    asked: int
    refused: tuple[tuple[Term, str], ...] = ()
    spent: Spent | None = None


def compare(
    model: Model,
    motions: Sequence[Motion],
    *,
    rules: Rules | None = None,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    journal: Journal | None = None,
    budget: Budget | None = None,
) -> Comparison:
    """Find what changed since a model was identified.

    Args:
        model: The earlier model.
        motions: New logs of the same robot, with torque.
        rules: Thresholds of the decision.
        seed: Seed of the searches.
        progress: Called with one line per stage.
        journal: Keeps the searches on disk, so that an interrupted comparison can go on.
        budget: Time after which no further round begins; None: no limit.
    """
    rules = rules or Rules()
    # An event happened in the earlier log alone.
    model = replace(model, terms=tuple(t for t in model.terms if not t.law.recurring))
    check_usable(model.terms, motions)
    before = current = freeze(model, motions)
    held = {t.identity for t in before.model.terms}
    picked: list[tuple[Candidate, Score, tuple[Score, ...]]] = []
    stages: list[Estimate] = []
    unseen: list[np.ndarray] = []
    refused: list[tuple[Term, str]] = []
    changes: tuple[Change, ...] = ()
    asked, memory = 0, Memory(journal, rules.share)
    budget, spent, scores = budget or Budget(), None, []
    for number in range(_MOST_STEPS + 1):
        progress(f"round {number + 1}: asking what changed")
        background = cross_fit(current, frozen=True)
        done = {t.identity for t in (*(c.term for c, _, _ in picked), *(t for t, _ in refused))}
        if budget.spent:
            spent = Spent(budget.seconds, number)
            progress(spent.sentence)
            scores = [s for s in scores if s.candidate.term.identity not in done]
            break
        scores = _ask(current, background, held, seed, done, memory)
        asked = asked or len(scores)
        passed = accepted(scores, rules)
        if number == _MOST_STEPS:
            break
        added = None
        while passed and added is None:
            chosen, _ = choose(passed, rules, background)
            others = tuple(s for s in sorted(scores, key=lambda s: -s.gain) if s is not chosen)[:6]
            trial = [*picked, (_raw(chosen.candidate, background), chosen, others)]
            fitted = changes_of(before, trial)
            doubts = [d for d in map(doubt_of, fitted) if d]
            if doubts:
                refused.append((fitted[-1].term, doubts[-1]))
                passed = [s for s in passed if s is not chosen]
            else:
                added, picked, changes = chosen, trial, fitted
        if added is None:
            break
        current = freeze(with_changes(before, changes), before.motions)
        stages.append(current)
        unseen.append(crossed(before, [c for c, _, _ in picked]))
    return Comparison(
        before, current, changes, tuple(stages), tuple(unseen), tuple(scores), background, asked,
        tuple(refused), spent,
    )  # fmt: skip


def _raw(candidate: Candidate, background: CrossFit) -> Candidate:
    """The candidate with the columns of the whole log in units of torque."""
    # Rows that a touch spoils weigh nothing.
    weight = background.weight[:, :, None]
    raw = np.divide(candidate.columns[0], weight, where=weight > 0, out=0.0 * candidate.columns[0])
    return replace(candidate, columns=(raw,) * len(candidate.columns))


def _ask(found: Estimate, background: CrossFit, held, seed: int, done, memory) -> list[Score]:
    terms = [t for t in eligible_terms(found.model, found.motions, True) if t.identity not in done]
    return score_terms(
        Linearization(found, background, memory),
        terms,
        seed,
        signed=lambda term: term.identity in held,
    )
