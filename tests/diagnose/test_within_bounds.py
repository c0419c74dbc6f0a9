"""Values that chance alone drives beyond physics are held; those the log insists on are not."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from planted import BAND, DECLARED, blank, diagnose_log, log_with, small_arm

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_on, score_terms
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection import holds as holding
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.tenable import (
    can_be,
    goes_beyond,
    is_within,
    unphysical_beside,
)
from jaxswarm.diagnose.selection.within_bounds import within_bounds
from jaxswarm.effects.base import get_law
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.motion import prepare

LOUD = Noise(2e-5, 3.0)


def frictionless(seed):
    """A short, noisy log of the arm whose second joint has dry friction only."""
    terms = tuple(t for t in DECLARED if (t.effect, t.joint) != ("viscous_friction", 1))
    return synthetic_log(
        small_arm(), terms, seed, noise=LOUD, duration=5.0, rate=125.0, motion_seed=7
    )


def fitted(log):
    return estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False)


def viscous(one):
    return next(
        t.values["b"] for t in one.model.terms if (t.effect, t.joint) == ("viscous_friction", 1)
    )


def test_friction_that_drives_by_chance_is_held_at_zero():
    driven = [one for one in (fitted(frictionless(seed)) for seed in range(6)) if viscous(one) < 0]
    assert driven  # about half of them
    for one in driven:
        held = within_bounds(one)
        assert viscous(held) == pytest.approx(0.0, abs=1e-12)
        assert held.fit.sigma == pytest.approx(one.fit.sigma, rel=0.05)


@pytest.mark.parametrize(("whole", "held"), [(True, True), (False, False)])
def test_chance_is_what_all_that_is_fitted_leaves_open(whole, held):
    """Beside a base out of level a shift had an error of 0.17 mm with the level held, and of 0.13 m with it."""
    driven = next(one for one in map(fitted, map(frictionless, range(6))) if viscous(one) < 0)
    sure = 1e-12 * driven.fit.covariance
    known = [{n: 1e-6 * e for n, e in one.items()} for one in driven.std_errors]
    errors = driven.std_errors if whole else tuple(known)
    asked = replace(driven, fit=replace(driven.fit, covariance=sure), std_errors=errors)
    assert (viscous(within_bounds(asked)) == pytest.approx(0.0, abs=1e-12)) is held


def test_what_the_log_insists_on_stays():
    negative = Term("viscous_friction", 1, values={"b": -6.0})
    one = fitted(log_with(negative))
    assert viscous(one) < -1.0
    assert within_bounds(one) is one


def test_what_was_declared_stays_beside_a_law_where_chance_has_it_below_zero(monkeypatch):
    """Without it the law's coefficient is told fifteen times as surely as the log knows it."""
    grease = Term("nonlinear_viscous_friction", 1, values={"c": 14.0, "alpha": 0.5})
    dry = tuple(t for t in DECLARED if (t.effect, t.joint) != ("viscous_friction", 1))
    log = synthetic_log(
        small_arm(),
        (*dry, grease),
        1,
        noise=Noise(2e-5, 0.1),
        duration=8.0,
        rate=125.0,
        motion_seed=7,
    )
    before = fitted(log)
    (score,) = score_on(before, [replace(grease, values={})], 0)
    first = iter([False])  # as where a fit beside viscous friction runs past the law
    monkeypatch.setattr(holding, "can_swing", lambda *_: next(first, True))
    after = refit_with(before, score)
    rows = zip(after.model.terms, after.std_errors, strict=True)
    told = {t.effect: (t.values, errors) for t, errors in rows if t.joint == 1}
    assert told["viscous_friction"][0]["b"] < 0.0
    values, errors = told["nonlinear_viscous_friction"]
    assert errors["c"] > 0.1
    assert abs(values["c"] - 14.0) < 3.0 * errors["c"]


def test_a_model_within_its_bounds_stays():
    one = fitted(log_with())
    assert within_bounds(one) is one


def test_a_diagnosis_ends_within_the_bounds():
    seed = next(s for s in range(6) if viscous(fitted(frictionless(s))) < 0)
    found = diagnose_log(frictionless(seed))
    assert viscous(found.final) >= 0.0
    assert np.isfinite(found.final.fit.sigma).all()


@pytest.mark.parametrize(
    ("backward", "error", "possible"),
    [(0.02, 0.01, True), (-0.05, 0.02, True), (-0.05, 0.005, False)],
)
def test_a_law_of_two_directions_may_be_below_its_bound_in_one_by_chance(backward, error, possible):
    values = {"fc_pos": 0.14, "fc_neg": 0.05, "b_pos": 0.12, "b_neg": backward}
    law = Term("asymmetric_friction", 1, values=values)
    assert can_be(law, dict.fromkeys(values, error)) is possible


def test_a_law_of_one_number_is_within_its_bound():
    drag = Term("quadratic_drag", 1, values={"c": -0.01})
    assert not can_be(drag, {"c": 0.02})


@pytest.mark.parametrize(
    ("part", "error", "possible", "within"),
    [(0.1, 0.01, True, True), (1.9, 0.5, True, False), (1.9, 0.1, False, False)],
)
def test_a_law_may_be_above_its_bound_by_chance(part, error, possible, within):
    """A number 4.5 times its bound was told beside that bound."""
    most = get_law("base_compliance").linear[0].upper
    values, error = {"cx": part * most, "cy": 0.0}, error * most
    term = Term("base_compliance", values=values)
    assert can_be(term, dict.fromkeys(values, error)) is possible
    assert is_within(term) is within


@pytest.mark.parametrize(("turn", "stays"), [(0.2, True), (0.8, False)])
def test_no_law_is_told_at_a_bound_that_the_log_is_far_beyond(turn, stays):
    turned = Term("link_geometry", 1, values={"x": 0.0, "y": 0.0, "turn_x": turn, "turn_y": 0.0})
    before = fitted(log_with(turned))
    (score,) = score_on(before, [Term("link_geometry", 1)], 0)
    assert score.share > 0.2
    assert (refit_with(before, score) is not None) is stays


@pytest.mark.parametrize(
    ("values", "stays"), [((-0.1, 0.1, 0.2, -0.2), False), ((0.1, 0.4, 0.2, 0.0), True)]
)
def test_a_law_stands_within_its_bounds(values, stays):
    """What drives in one direction and brakes in the other is no friction, though chance may have done it."""
    planted = dict(zip(("fc_pos", "fc_neg", "b_pos", "b_neg"), values, strict=True))
    other = tuple(t for t in DECLARED if t.joint == 0)
    terms = (*other, Term("asymmetric_friction", 1, values=planted))
    log = synthetic_log(
        small_arm(), terms, 1, noise=Noise(2e-5, 0.4), duration=12.0, rate=125.0, motion_seed=7
    )
    found = estimate(small_arm(), blank(other), [prepare(log, BAND)], bounded=False)
    asked = [Term("asymmetric_friction", 1)]
    (one,) = score_terms(Linearization(found, cross_fit(found)), asked, 0)
    assert one.share > 0.2
    assert (refit_with(found, one) is not None) is stays


@pytest.mark.parametrize(("level", "possible"), [(1.5, True), (-3.5, False)])
def test_no_law_may_drive_friction_of_its_joint_below_zero(level, possible):
    """A bent curve is not made of two laws one of which drives: an eddy brake was told as such a pair."""
    friction = {"b": 6.0}, {"fc": level}, {"df": 5.0, "vs": 0.5, "delta": 2.0}
    names = "viscous_friction", "coulomb_friction", "stribeck_friction"
    bent = tuple(Term(n, 1, values=v) for n, v in zip(names, friction, strict=True))
    own = (*(t for t in DECLARED if t.joint == 0), *bent)
    log = synthetic_log(
        small_arm(), own, 1, noise=Noise(2e-5, 0.1), duration=12.0, rate=125.0, motion_seed=7
    )
    before = fitted(log)
    (score,) = score_terms(
        Linearization(before, cross_fit(before)), [Term("stribeck_friction", 1)], 0
    )
    assert score.share > 0.2
    assert (refit_with(before, score) is not None) is possible


@pytest.mark.parametrize(
    ("effect", "values", "there"),
    [
        ("cable_coupling", {"kc": -0.04, "k": 0.3, "tau0": 3.3}, False),
        ("cable_coupling", {"kc": -0.4, "k": 0.0, "tau0": 0.0}, True),
        ("joint_spring", {"k": 0.1, "tau0": 3.3}, False),
        ("dead_zone_spring", {"k": 0.1, "q0": 1.7, "gap": 0.4}, False),
        ("dead_zone_spring", {"k": 0.5, "q0": 1.7, "gap": 0.4}, True),
        ("torque_offset", {"tau0": 0.1}, True),
        ("asymmetric_friction", {"fc_pos": 0.3, "fc_neg": 0.3, "b_pos": 0.0, "b_neg": 0.0}, True),
    ],
)
def test_a_law_is_certain_in_what_those_it_contains_have_not(effect, values, there):
    """A constant torque was told as a cable from another joint, with a second log's consent."""
    assert goes_beyond(Term(effect, 1, values=values), dict.fromkeys(values, 0.1)) is there


@pytest.mark.parametrize(
    ("before", "doubt", "after", "refused"),
    [
        (0.2, 0.1, -0.5, True),
        (0.2, 0.1, -0.3, False),  # by chance
        (-1.6, 0.1, 0.3, False),
        (-1.6, 0.1, -1.9, False),  # by chance
        (-1.6, 0.1, -4.1, True),
        (-0.6, 0.3, -0.5, False),  # nearer, and known better
        (-0.6, 0.3, -0.7, True),
    ],
)
def test_no_law_drives_friction_further_below_zero(before, doubt, after, refused):
    """Viscous friction of -1.6 went to -4.1 beside a quadratic drag: the joint's friction fell with speed."""

    def fit(b, doubt, *added):
        terms = (Term("viscous_friction", 1, values={"b": b}), *added)
        return SimpleNamespace(
            model=SimpleNamespace(terms=terms),
            std_errors=tuple(dict.fromkeys(t.values, doubt) for t in terms),
        )

    drag = Term("quadratic_drag", 1, values={"c": 17.0})
    assert unphysical_beside(fit(before, doubt), fit(after, 0.1, drag), drag) is refused
