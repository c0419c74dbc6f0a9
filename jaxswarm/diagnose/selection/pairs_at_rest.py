"""Laws of a partner that moments in which dry friction holds their joint tell alone.

A drive that winds up while its joint sticks goes through all torques of its friction, and its partners move
meanwhile: on a cycle that repeats itself the two go along. A clean slide that stuck was told as turned along by
another one, which took 70 % off its squared error, 11 % where it moved, and left 2.1 times the declared model's
error on another log. What friction does at rest is a matter of its own joint; a partner that acts on a joint
acts while it moves, too.
"""

import numpy as np

from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import LOUD
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.selection.refit import refit_once
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.diagnose.selection.sticking import fit_of_rows, go_on_from, is_held
from jaxswarm.diagnose.selection.without_steps import go_on_without, terms_without
from jaxswarm.effects.alike import has
from jaxswarm.identify.estimation.standing import hardly_moving, leave_out


def leave_out_instead_of_pairs(search: Search) -> bool:
    """Leave out where a joint hardly moves, and take back the law of its partner that explained that.

    That is so where friction may be what holds it there, and what moves is near its noise without that law.
    Whether one was taken back; nothing is refused by that.
    """
    current = search.current
    rows = hardly_moving(current.motions)
    for step in filter(lambda one: _is_asked(one, search), search.steps):
        joint = step.added.index
        terms = terms_without([step], current.model.terms)
        before = with_motion_noise(refit_once(current, terms), search.seed)
        moving = leave_out(current.motions, rows, np.arange(rows[0].shape[1]) == joint)
        after = fit_of_rows(search, before, moving)
        if is_held(before, after)[joint] and over_noise(after)[joint] <= LOUD:
            search.sticking.add(joint)
            go_on_without(search, [step])
            go_on_from(search, after, {joint})
            return True
    return False


def _is_asked(step: Step, search: Search) -> bool:
    """Whether an addition is the law of a partner alone, on a joint that was not yet found to be held."""
    term = step.added
    pair = term.law.scope == "pair" and not term.law.mutual
    return pair and term.joint not in search.sticking and has(term, search.current.model.terms)
