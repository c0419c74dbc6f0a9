r"""The loop against a model identified before: what changed since.

The earlier model is not refitted; it absorbs nothing. What is left, :math:`\tau - \hat\tau`, is put to
every candidate, among them now a payload and a change of what the model already holds, which may have
either sign. The changes found are fitted together, the earlier parameters held; their standard errors
respect autocorrelation as everywhere.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.journal import Journal
from jaxswarm.diagnose.decision.competing import choose
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.diagnose.selection.budget import Budget, Spent
from jaxswarm.diagnose.selection.change_again import (
    beside,
    better,
    is_change,
    might_have_been,
    worse,
)
from jaxswarm.diagnose.selection.change_apply import (
    Change,
    Picked,
    as_picked,
    changes_of,
    doubt_of_any,
    with_changes,
)
from jaxswarm.diagnose.selection.change_fit import crossed
from jaxswarm.diagnose.selection.change_rest import without_held
from jaxswarm.diagnose.selection.earlier_model import freeze, held_folds, on_new_logs
from jaxswarm.diagnose.selection.rounds import Question, run_rounds
from jaxswarm.diagnose.selection.stand import in_all_motion
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.usable import check_usable
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Motion

# Changes that are added; another look follows where one was chosen anew.
_MOST_STEPS = 7


@dataclass(frozen=True)
class Comparison:
    """Outcome of a comparison with an earlier model.

    Attributes:
        before, after: The earlier model on the logs, and with the changes.
        changes: In the order they were found.
        after_each: The estimates after each change.
        unseen: After each change, the residual (T, n) of every second block of time with the changes
            fitted to the others.
        last: Scores of the final round.
        crossfit: Folds of the final round.
        asked: Candidates asked in the first round.
        refused: Candidates that explain something with values that cannot be believed, and why.
        spent: The budget that ended the search; None: it came to its own end.
        rules: Thresholds that decided.
    """

    before: Estimate
    after: Estimate
    changes: tuple[Change, ...]
    after_each: tuple[Estimate, ...]
    unseen: tuple[np.ndarray, ...]
    last: tuple[Score, ...]
    crossfit: CrossFit
    asked: int
    refused: tuple[tuple[Term, str], ...] = ()
    spent: Spent | None = None
    rules: Rules = Rules()


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
    # What happened in the earlier log alone.
    model = replace(model, terms=tuple(t for t in model.terms if not t.law.in_one_log))
    check_usable(model.terms, motions)
    before = on_new_logs(model, motions, seed)
    memory = Memory(journal, rules.share)
    search = Search(before, before, rules, seed, memory, (), progress, budget or Budget())
    found = _Found()
    run_rounds(search, _changed(found), _MOST_STEPS)
    return Comparison(
        search.declared, search.current, found.changes, tuple(found.after_each), tuple(found.unseen),
        tuple(search.scores), search.folds, search.asked, tuple(search.refused), search.spent,
        rules,
    )  # fmt: skip


@dataclass
class _Found:
    """The changes so far, as :class:`Comparison` tells them, and the candidates they were picked as."""

    picked: list[Picked] = field(default_factory=list)
    changes: tuple[Change, ...] = ()
    after_each: list[Estimate] = field(default_factory=list)
    unseen: list[np.ndarray] = field(default_factory=list)
    settled: bool = False

    def take(self, search: Search, picked: list[Picked]) -> None:
        """Let these be the changes; what they do one after the other is told of each."""
        before = search.declared
        self.picked, self.after_each, self.unseen = picked, [], []
        for count in range(1, len(picked) + 1):
            self.changes = changes_of(before, picked[:count])
            after = freeze(with_changes(before, self.changes), before.motions)
            self.after_each.append(after)
            self.unseen.append(crossed(before, [c for c, _, _ in picked[:count]]))
        search.current = self.after_each[-1]


def _changed(found: _Found) -> Question:
    """What changed since the earlier model, which absorbs nothing, and whose effects may change by any sign."""

    def done(search: Search) -> set:
        picked = (c.term.identity for c, _, _ in found.picked)
        return {*picked, *(t.identity for t, _ in search.refused)}

    def eligible(search: Search) -> list[Term]:
        known = done(search)
        terms = eligible_terms(search.current.model, search.current.motions, True)
        return [t for t in terms if t.identity not in known]

    def act(search: Search, passed: list[Score]) -> bool:
        passed = in_all_motion(search, passed, partial(held_folds, search.declared))
        return _add_change(search, found, passed) or _choose_again(search, found)

    return Question(
        told=lambda search: "asking what changed",
        cross_fit=lambda search: held_folds(search.declared, search.current),
        eligible=eligible,
        held=done,
        act=act,
        signed=is_change,
    )


def _leave_out_held(search: Search, found: _Found) -> bool:
    """Leave out where friction holds joints, before a law is told to have changed; whether so."""
    without = without_held(search)
    if without is None:
        return False
    search.current, search.declared = without
    if found.picked:
        found.take(search, found.picked)
    return True


def _add_change(search: Search, found: _Found, passed: list[Score]) -> bool:
    """Add the best change whose values can be believed, or leave out what no change is; whether it did.

    What happened while an arm stood is told by more than friction can hold, and goes before it: a push of 0.3 s
    at one rest of 14 was left out with the rest, and told of nowhere. Laws go after it.
    """
    before, asked = search.declared, False
    while True:
        chosen = choose(passed, search.rules, search.folds)[0] if passed else None
        if not asked and (chosen is None or not chosen.candidate.term.law.recurring):
            asked = True
            if _leave_out_held(search, found):
                return True
        if chosen is None:
            return False
        picked = [*found.picked, as_picked(chosen, search.scores, search.folds)]
        changes = changes_of(before, picked)
        doubt = doubt_of_any(changes, before.model.robot.kinds) or worse(
            before, search.current, changes
        )
        if doubt is None:
            found.take(search, picked)
            return True
        search.refused.append((changes[-1].term, doubt))
        passed = [s for s in passed if s is not chosen]


def _choose_again(search: Search, found: _Found) -> bool:
    """Ask who would be chosen for each change with the others in place; whether that led to others.

    One whom nobody would choose any more is left out. From another one the search is begun anew, as those
    after it were chosen beside the first; and where none is another, from those that might have been the first:
    laws that take a little of everything may stand together, each the best beside the others.
    """
    if found.settled or len(found.picked) < 2 or search.budget.spent:
        return False
    found.settled = True
    search.progress("making every choice again with the others in place")
    former = found.picked
    for one in former:
        others = [p for p in found.picked if p is not one]
        new = beside(search, others) if others else one
        if new is None:
            if worse(search.declared, search.declared, changes_of(search.declared, others)) is None:
                found.take(search, others)
        elif new[0].term.identity != one[0].term.identity and _begin_with(search, found, new):
            break
    if found.picked is former:
        for new in might_have_been(search, former[0]):
            _begin_with(search, found, new)
    return found.picked is not former


def _begin_with(search: Search, found: _Found, new: Picked) -> bool:
    """Search from another first change on; whether the outcome is better, and taken."""
    before = search.declared
    first = changes_of(before, [new])
    if doubt_of_any(first, before.model.robot.kinds) or worse(before, before, first):
        return False
    branch = Search(
        before, before, search.rules, search.seed, search.memory, (), search.progress, search.budget
    )
    trial = _Found(settled=True)
    trial.take(branch, [new])
    run_rounds(branch, _changed(trial), _MOST_STEPS - 1)
    taken = better(search, trial.picked, found.picked)
    if taken:
        found.take(search, trial.picked)
        search.refused = branch.refused
    return taken
