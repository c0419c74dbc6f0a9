"""A refit begins again elsewhere where it comes to nothing that can be."""

from dataclasses import replace

import numpy as np
import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.selection import refit as refit_module
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.refit_starts import from_inside, starts
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.term import Term

STRIBECK = Term("stribeck_friction", 1, values={"df": 3.0, "vs": 0.12, "delta": 2.0})
DRAG = Term("quadratic_drag", 1, values={"c": 1.5})
LOAD = Term("load_dependent_friction", 1, values={"mu": 0.3, "inertial": 0.4})


@pytest.mark.parametrize(("hidden", "tries"), [(STRIBECK, 3), (DRAG, 1)], ids=["bends", "does not"])
def test_a_curve_of_usual_shape_begins_from_lower_speeds_too(monkeypatch, hidden, tries):
    """Of a joint that was led slowly it went to a fall of -87 N, and was refused for that."""
    before, crossfit = declared_fit(log_with(hidden))
    (score,) = score_terms(Linearization(before, crossfit), [Term(hidden.effect, 1)], 0)
    asked, holds = [], refit_module.holds

    def at_last(after, term, fall, beyond):
        asked.append(find_term(after, term))
        return len(asked) == 3 and holds(after, term, fall, beyond)

    monkeypatch.setattr(refit_module, "holds", at_last)
    after = refit_with(before, score)
    assert len(asked) == tries and (after is not None) == (tries == 3)
    for fitted in asked:
        for name, value in hidden.values.items():
            assert fitted.values[name] == pytest.approx(value, rel=0.1)


def test_what_ran_to_a_bound_begins_once_more_from_usual_values():
    at = replace(LOAD, values={"mu": 0.3, "inertial": 1.0})
    assert from_inside(at).values == {"mu": 0.3, "inertial": 0.5}
    assert from_inside(LOAD) is None and from_inside(DRAG) is None


@pytest.mark.parametrize("stuck", [True, False])
def test_a_fit_at_a_bound_is_left_for_one_that_leaves_less(monkeypatch, stuck):
    """Friction by the load of an upright axis came to a share of 1.0 at 2.4 times the error it may leave."""
    hidden = LOAD if stuck else replace(LOAD, values={"mu": 0.3, "inertial": 1.0})
    before, crossfit = declared_fit(log_with(hidden))
    (score,) = score_terms(Linearization(before, crossfit), [Term(LOAD.effect, 1)], 0)
    fits, refit = [], refit_module.refit

    def first_at_the_bound(*asked):
        found = refit(*asked)
        if stuck and not fits:
            left = 0.5 * before.fit.residual
            terms = found.model.terms
            terms = (*terms[:-1], replace(terms[-1], values={**terms[-1].values, "inertial": 1.0}))
            model = replace(found.model, terms=terms)
            found = replace(found, model=model, fit=replace(found.fit, residual=left))
        fits.append(found)
        return found

    monkeypatch.setattr(refit_module, "refit", first_at_the_bound)
    after = refit_with(before, score)
    told = find_term(after, Term(LOAD.effect, 1)).values
    assert told["inertial"] == pytest.approx(0.4 if stuck else 1.0, abs=0.15)
    assert after is fits[-1] if stuck else after in fits


@pytest.mark.parametrize(("wanted", "stiffness"), [(43.0, [7e3, 3e5]), (1.5, [3e5])])
def test_a_spring_wanted_many_times_over_begins_that_much_softer(wanted, stiffness):
    """A gear that stiffens was fitted from 3e5 N m/rad on, stuck at 24,000, and lost to an encoder's error."""
    term = Term("joint_elasticity", 1, values={"k": 43.0 * 7e3, "d": 64.0})
    begun = starts(term, np.array([wanted]))
    assert [s.values["k"] for s in begun] == pytest.approx(stiffness, rel=0.01)
    ratios = [s.values["d"] / np.sqrt(s.values["k"]) for s in begun]
    assert ratios == pytest.approx(ratios[:1] * len(ratios))


@pytest.mark.parametrize("less", [True, False])
def test_without_a_new_law_a_fit_begins_again_where_other_widths_leave_less(monkeypatch, less):
    """Of 48 fits from widths that left more each came back to where it was, for half of their time."""
    before, _ = declared_fit(log_with(DRAG))
    width = tuple((5.0 if less else 1.0) * w for w in before.model.width)
    fits, fit_from = [], refit_module.fit_from
    best = before.model.width if less else tuple(5.0 * w for w in before.model.width)

    def counted(current, start, terms, width):
        fits.append(width)
        return fit_from(current, start, terms, width, refine_width=False)

    monkeypatch.setattr(refit_module, "fit_from", counted)
    monkeypatch.setattr(refit_module, "best_widths", lambda *a: best)
    found = replace(before, model=replace(before.model, width=width))
    refit_module.refit(found, before.model.terms)
    assert fits == [width, best][: 1 + less]
    fits.clear()
    refit_module.refit(found, (*before.model.terms, Term("joint_spring", 0)))
    assert fits == [width, best]


@pytest.mark.parametrize(("kept", "fits"), [(True, 2), (False, 3)], ids=["short", "long"])
def test_what_a_model_is_without_an_addition_is_fitted_once(monkeypatch, kept, fits):
    """Of 42 fits of a slide ten had been made before; of a long log none is held."""
    before, _ = declared_fit(log_with(DRAG))
    terms, made, refit = before.model.terms[1:], [], refit_module.refit
    monkeypatch.setattr(refit_module, "is_kept", lambda motion: kept)
    monkeypatch.setattr(refit_module, "refit", lambda *of: made.append(of) or refit(*of))
    other = tuple(replace(t, values={n: 2.0 * x for n, x in t.values.items()}) for t in terms)
    found = [refit_module.refit_once(before, asked).model for asked in (terms, other, terms)]
    assert len(made) == fits
    assert found[0].terms == found[2].terms
    assert not replace(before, motions=before.motions).refits


@pytest.mark.parametrize(("way", "fits"), [(0.0, 1), (1e-3, 2)])
def test_a_bristle_that_became_dry_friction_is_not_fitted_once_more(monkeypatch, way, fits):
    """Of seven bristles beside a filter five ran to the least way, and did so once more, in 11 s each."""
    before, _ = declared_fit(log_with(DRAG))
    least = Term("hysteresis", 0).law.nonlinear[0].lower
    bristle = Term("hysteresis", 0, values={"x0": least + way, "fc": 1.0})
    found = replace(before, model=replace(before.model, terms=(*before.model.terms, bristle)))
    done = []
    monkeypatch.setattr(refit_module, "fit_from", lambda *a: done.append(1) or found)
    monkeypatch.setattr(
        refit_module, "best_widths", lambda *a: tuple(5.0 * w for w in before.model.width)
    )
    monkeypatch.setattr(refit_module, "_leaves_less", lambda *a: False)
    refit_module.refit(before, found.model.terms)
    assert len(done) == fits


@pytest.mark.parametrize(("errors", "kept"), [(2.6, True), (3.2, False)])
def test_signs_keep_their_width_beside_a_new_law_where_the_log_hardly_tells_another(
    monkeypatch, errors, kept
):
    """One of 2.6 standard errors, shared by a joint that it said nothing of, had a true bristle refused."""
    before, _ = declared_fit(log_with(DRAG))
    wide = tuple(5.0 * w for w in before.model.width)
    gain = errors**2 / before.fit.effective_samples

    def fit_from(current, start, terms, width, **more):
        left = before.fit.residual * np.sqrt(1.0 - gain * (width == wide))
        model = replace(before.model, terms=terms, width=width)
        return replace(before, model=model, fit=replace(before.fit, residual=left))

    monkeypatch.setattr(refit_module, "fit_from", fit_from)
    monkeypatch.setattr(refit_module, "best_widths", lambda *a: wide)
    spring = Term("joint_spring", 0, values={"k": 1.0, "tau0": 0.0})
    found = refit_module.refit(before, (*before.model.terms, spring))
    assert found.model.width == (before.model.width if kept else wide)
