"""A law of more numbers stands in the place of a simpler one where it leaves less by more than they cost."""

import pytest
from planted import BAND, blank, declared_fit, log_with, small_arm

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.instead import replacement
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.reselect import reconsider
from jaxswarm.diagnose.selection.step import step_between
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare


@pytest.mark.parametrize(("alpha", "named"), [(2.0, None), (1.6, "nonlinear_viscous_friction")])
def test_a_free_exponent_replaces_a_law_only_where_it_is_worth_its_number(alpha, named):
    """The exponent of a drag came to 2.0 within its doubt, and was told for having been ahead by chance."""
    hidden = Term("nonlinear_viscous_friction", 1, values={"c": 1.5, "alpha": alpha})
    before, crossfit = declared_fit(log_with(hidden))
    asked = [Term("quadratic_drag", 1), Term("nonlinear_viscous_friction", 1)]
    drag, bent = score_terms(Linearization(before, crossfit), asked, 0)
    current = refit_with(before, drag)
    found = replacement([bent], bent, drag.candidate.size, before, current, ())
    assert (found and found[0].candidate.term.effect) == named


@pytest.mark.parametrize("falls", [False, True], ids=["equal halves", "harder one way"])
def test_what_took_the_place_of_other_terms_is_asked_again_beside_them(falls):
    """Viscous friction was told as friction of each direction, with equal halves, beside a tilt yet unknown."""
    values = {"fc_pos": 1.6, "fc_neg": -0.9, "b_pos": 1.5, "b_neg": 0.3}
    log = log_with(*[Term("asymmetric_friction", 1, values=values)] * falls)
    declared = tuple(t for t in blank() if (t.effect, t.joint) != ("viscous_friction", 1))
    before = estimate(small_arm(), declared, [prepare(log, BAND)], bounded=False)
    asked = [Term("asymmetric_friction", 1), Term("viscous_friction", 1)]
    halves, viscous = score_terms(Linearization(before, cross_fit(before)), asked, 0)
    step = step_between(halves, before, refit_with(before, halves), near=(viscous,))
    assert [t.effect for t in step.removed] == ["coulomb_friction"]
    steps, found, changed = reconsider([step], step.after, 60, Rules())
    assert changed != falls
    assert [s.added.effect for s in steps] == [
        "asymmetric_friction" if falls else "viscous_friction"
    ]
    held = {t.effect for t in found.model.terms if t.joint == 1}
    assert ("coulomb_friction" in held) != falls
    assert ("coulomb_friction" in {t.effect for t in steps[0].removed}) == falls
