"""Forward stepwise selection: score every candidate, add the best that passes, refit, score again.

When nobody passes, one law of the whole arm is tried in the place of all that was added; then every choice is
made once more; when that changes nothing, the search is over.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.journal import Journal
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import CrossFit, cross_fit
from jaxswarm.diagnose.selection.add_best import add_best
from jaxswarm.diagnose.selection.both_ends import add_both_ends
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.clock import allow_for_skew
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.everyday import allow_for_everyday, everyday_again
from jaxswarm.diagnose.selection.finish import finish
from jaxswarm.diagnose.selection.from_declared import declared_alone
from jaxswarm.diagnose.selection.laws_at_rest import leave_out_instead_of_laws
from jaxswarm.diagnose.selection.motion_first import found_in_motion
from jaxswarm.diagnose.selection.one_for_several import one_for_several
from jaxswarm.diagnose.selection.reselect import choose_again
from jaxswarm.diagnose.selection.rounds import Question, run_rounds
from jaxswarm.diagnose.selection.stand import that_may_stand
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.sticking import leave_out_sticks, leave_out_where_lost
from jaxswarm.diagnose.selection.sticking_beside import leave_out_beside_laws, put_back
from jaxswarm.diagnose.selection.take_back import take_back
from jaxswarm.diagnose.selection.two_laws import add_two_laws
from jaxswarm.diagnose.selection.with_rest import with_rest
from jaxswarm.diagnose.selection.within_bounds import within_bounds
from jaxswarm.effects.alike import has
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import estimate
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot

# Rounds per joint, and for any arm.
_ROUNDS_PER_JOINT, _LEAST_ROUNDS = 4, 12


def diagnose(
    robot: Robot,
    declared: tuple[Term, ...],
    motions: Sequence[Motion],
    *,
    rules: Rules | None = None,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    journal: Journal | None = None,
    other: Sequence[Motion] = (),
    budget: Budget | None = None,
) -> Diagnosis:
    """Find what a declared model lacks.

    Args:
        robot: Kinematics.
        declared: Terms the user knows of.
        motions: Prepared logs with torque.
        rules: Thresholds of the decision.
        seed: Seed of the searches.
        progress: Called with one line per stage.
        journal: Keeps the searches on disk, so that an interrupted diagnosis can go on.
        other: Prepared logs of other motion, with torque: what is added has to survive on them.
        budget: Time after which no further round begins; None: no limit.

    Returns:
        The :class:`Diagnosis`.
    """
    rules, budget = rules or Rules(), budget or Budget()
    memory = Memory(journal, rules.share)

    def searched(
        logs: Sequence[Motion],
        most: int,
        goes_on: Callable = _always,
        sticks: Callable[[Search], bool] | None = None,
        in_motion: bool = False,
    ) -> Search:
        question = replace(_LACKING, act=partial(_act_if, goes_on))
        with declared_alone(robot, declared, logs) as alone:
            progress("fitting the declared model")
            start = estimate(robot, declared, logs, bounded=False)
            given = rules, seed, memory, other, progress, budget
            search = Search(start, start, *given)
            found = in_motion and found_in_motion(
                Search(start, start, *given), partial(run_rounds, question=question, most=most)
            )
            if found:
                search = found
            else:
                run_rounds(search, question, most)
            at_once, in_the_end = sticks or leave_out_sticks, sticks or _sticks
            while not search.given_up and (
                leave_out_where_lost(search, at_once) or take_back(search) or in_the_end(search)
            ):
                run_rounds(search, question, most)
            if not search.given_up:
                finish(search, alone)
        return search

    most = max(_LEAST_ROUNDS, _ROUNDS_PER_JOINT * robot.num_joints)
    search = with_rest(searched(motions, most, in_motion=True), motions, searched)
    return Diagnosis(
        within_bounds(search.declared) if search.steps else search.current,
        search.current,
        tuple(search.steps),
        tuple(search.scores),
        search.folds,
        search.asked,
        search.withdrawn,
        tuple((t, why) for t, why in search.refused if not has(t, search.current.model.terms)),
        tuple(search.outdone),
        search.ended,
        rules,
        search.spent,
    )


def _told(search: Search) -> str:
    """What is done, with the relative error [%] of all joints."""
    rows = search.current
    size = np.linalg.norm(rows.regression.torque)
    error = float(100.0 * np.linalg.norm(rows.fit.residual) / max(float(size), 1e-300))
    return f"scoring candidates, {error:.3g} % error so far"


def _cross_fit(search: Search) -> CrossFit:
    search.current = with_motion_noise(search.current, search.seed)
    return cross_fit(search.current)


def _eligible(search: Search) -> list[Term]:
    eligible = eligible_terms(search.current.model, search.current.motions)
    return [t for t in eligible if t.identity not in search.banned | search.barred]


def _held(search: Search) -> set:
    return {t.identity for t in search.current.model.terms}


def _act(search: Search, passed: list[Score]) -> bool:
    """Add the best of those that passed and show in all motion; if nobody did, make every choice again.

    What shows at both of its ends at once goes first where it explains more. Where nothing changes any more,
    two laws may hide each other.
    """
    passed = that_may_stand(search, passed)
    if add_both_ends(search, passed):
        return True
    if passed:
        return add_best(search, passed)
    if everyday_again(search) or one_for_several(search) or _choose_again(search):
        return True
    return not search.budget.spent and add_two_laws(search)


def _sticks(search: Search) -> bool:
    """Leave out where friction holds joints for moments, alone or beside laws; whether it does."""
    known = put_back(search) or leave_out_sticks(search) or leave_out_beside_laws(search)
    return known or leave_out_instead_of_laws(search)


def _always(search: Search, passed: list[Score]) -> bool:
    return True


def _act_if(
    goes_on: Callable[[Search, list[Score]], bool], search: Search, passed: list[Score]
) -> bool:
    """Act on those that passed, unless the search does not go on with them: then it is given up."""
    search.given_up = not goes_on(search, passed)
    return not search.given_up and _act(search, passed)


def _allow(search: Search, lin: Linearization, eligible: Sequence[Term]) -> bool:
    """Allow for what every drive has, once, and for clocks that are apart; whether either was there."""
    return allow_for_everyday(search, lin, eligible) or allow_for_skew(search, eligible)


def _choose_again(search: Search) -> bool:
    """Make every choice once more, with all effects in place; whether one changed."""
    if search.settled or not search.steps:
        return False
    if search.budget.spent:
        return True  # it would be another round, which does not begin
    search.settled = True
    former = search.steps
    search.steps, search.current, changed = choose_again(
        former,
        search.current,
        search.folds,
        search.asked,
        search.rules,
        search.seed,
        search.progress,
        search.other,
    )
    held = {s.added.identity for s in search.steps}
    if changed:
        search.withdrawn = tuple(s.added for s in former if s.added.identity not in held)
    return changed


_LACKING = Question(_told, _cross_fit, _eligible, _held, _act, _allow)
