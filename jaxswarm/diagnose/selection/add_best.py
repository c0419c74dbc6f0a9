"""Add the best of the candidates that passed, if it proves itself."""

from dataclasses import replace

from jaxswarm.diagnose.decision.competing import choose
from jaxswarm.diagnose.decision.worth import Score, runners_up
from jaxswarm.diagnose.selection.further import MOST_EVENTS, add_further
from jaxswarm.diagnose.selection.instead import far_less
from jaxswarm.diagnose.selection.readings import why_not
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.rivals_elsewhere import best_elsewhere, told_elsewhere
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import find_term, near_ones, step_between
from jaxswarm.diagnose.selection.sticking import leave_out_sticks
from jaxswarm.diagnose.selection.survives import one_place, stands_in
from jaxswarm.diagnose.selection.unseen_order import worse_than_waves
from jaxswarm.effects.kinds import MeasurementLaw, TorqueLaw
from jaxswarm.effects.term import Term


def add_best(search: Search, best: list[Score]) -> bool:
    """Add the best candidate if it proves itself; always another round."""
    current, crossfit = search.current, search.folds
    chosen, rivals = choose(best, search.rules, crossfit)
    term = chosen.candidate.term
    if stands_in(chosen, current, crossfit, search.seed):
        search.refuse(term)
        return True
    # A filter is late where friction turns, and takes up what that holds at rest: motion is asked first.
    if isinstance(term.law, MeasurementLaw) and term.law.slow and leave_out_sticks(search):
        return True
    search.progress(f"adding {term.label(current.model.robot.joints)}")
    after = refit_with(current, chosen) or told_elsewhere(current, chosen, search.other)
    if after is None:
        search.refuse(term)
        return True
    chosen, after, rivals = far_less(chosen, rivals, after, current)
    term = chosen.candidate.term
    near = near_ones(chosen, best, crossfit)
    if search.other and near:
        chosen, after, rivals = best_elsewhere(current, chosen, after, rivals, near, search.other)
        term, near = chosen.candidate.term, near_ones(chosen, best, crossfit)
    if why := why_not(search, chosen, after):
        search.refuse(term, why, by_all=bool(search.other))
        return True
    added = find_term(after, term)
    seen = one_place(after, added, search.rules, search.seed)
    if why := seen or worse_than_waves(search, chosen, after):
        search.refuse(term, why)
        return True
    others = runners_up(chosen, search.scores, search.banned)
    step = step_between(chosen, current, after, tuple(rivals), others, near)
    search.steps.append(step)
    search.current = after
    if added.law.recurring:
        add_further(search, replace(added, values={}), MOST_EVENTS)
    if added.law.mutual:
        add_further(search, Term(added.effect, added.other, added.joint), 1)
    search.ask_again(added.joint)
    # Rest came back, and a law of motion was found with it: what is left there may be friction's now. Laws of
    # friction are asked first.
    came_back = search.lent is not None and not search.lent
    if came_back and not isinstance(added.law, TorqueLaw):
        search.go_on(after)
        leave_out_sticks(search)
    return True
