"""What drives and sensors do to a torque is named by its law, and a clean torque by none."""

from dataclasses import replace

import pytest
from elbow import ask, elbow, elbow_log, fitted, passing
from planted import BAND
from scipy import signal

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.decision.competing import accepted
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

LAWS = (
    *("torque_constant_saturation", "torque_dead_band", "torque_lag", "time_delay", "drive_gain"),
    "drive_lag",
)
DOUBLES = ("load_dependent_friction", "joint_spring", "cubic_spring", "asymmetric_friction")
PLANTED = [
    Term("torque_constant_saturation", 1, values={"c": 0.004}),
    Term("torque_constant_saturation", 2, values={"c": -0.02}),
    Term("torque_dead_band", 1, values={"d": 0.6}),
    Term("torque_lag", values={"tc": 0.012, "seconds": 0.006}),
    Term("drive_lag", 1, values={"tc": 0.01}),
    Term("drive_lag", 2, values={"tc": 0.08}),
]


def named(log, *laws):
    """The first fit, the best that passes, the fit with it; a filter is asked beside its delay."""
    found = fitted(log)
    best = passing(ask(found, *laws))[0]
    after = refit_with(found, best)
    further = passing(ask(after, "torque_lag"))
    return (found, further[0], refit_with(after, further[0])) if further else (found, best, after)


@pytest.mark.parametrize("truth", PLANTED, ids=lambda t: f"{t.effect}@{t.joint}")
def test_what_is_done_to_a_torque_is_named_with_its_values(truth):
    found, best, after = named(elbow_log(truth), *LAWS, *DOUBLES)
    assert best.candidate.term.place == truth.place
    values = find_term(after, best.candidate.term).values
    for name, value in truth.values.items():
        assert values[name] == pytest.approx(value, rel=0.1), name
    assert (after.fit.sigma < 0.85 * found.fit.sigma).any()


@pytest.mark.parametrize(
    ("truth", "share"),
    [
        (Term("torque_dead_band", 1, values={"d": 3.0}), 0.7),
        (Term("torque_constant_saturation", 1, values={"c": 0.02}), 0.98),
        (Term("torque_constant_saturation", 2, values={"c": 0.06}), 0.92),
    ],
    ids=["dead", "bent", "bent to half"],
)
def test_what_is_large_is_asked_and_fitted_with_the_torque_that_it_leaves(truth, share):
    """With the torque of the model without them they took 0.47, 0.976 and 0.90; the last was not confirmed."""
    found = fitted(elbow_log(truth))
    (own,) = [s for s in ask(found, truth.effect) if s.candidate.term.place == truth.place]
    ((name, value),) = truth.values.items()
    assert own.share > share
    assert own.coefficients[0] == pytest.approx(value, rel=0.05)
    after = refit_with(found, own)
    assert find_term(after, own.candidate.term).values[name] == pytest.approx(value, rel=0.05)


@pytest.mark.parametrize("c", [0.006, -0.006])
def test_a_gain_that_falls_with_the_square_of_the_torque_is_named_and_leaves_nothing(c):
    """A fall in proportion to the torque left 0.046 N m of a noise of 0.041, and had no exponent to tell."""
    bent = Term("torque_constant_saturation", 1, values={"c": c, "n": 2.0, "at": 20.0})
    _, best, after = named(elbow_log(bent), *LAWS, *DOUBLES, "contact")
    assert best.candidate.term.place == bent.place
    values = find_term(after, bent).values
    assert values["n"] == pytest.approx(2.0, abs=0.1)
    assert values["c"] * 20.0 / values["at"] == pytest.approx(c, rel=0.1)
    assert not passing(ask(after, *LAWS, *DOUBLES, "contact"))


@pytest.mark.parametrize(
    ("seed", "joint", "d", "share"), [(6, 2, 3.0, 0.3), (6, 2, 8.0, 0.55), (3, 1, 3.0, 0.8)]
)
def test_a_dead_band_is_asked_from_where_the_measured_torque_crosses_zero(seed, joint, d, share):
    """From where the model without it does, turn by turn, they took 0.09, 0.305 and 0.652."""
    band = Term("torque_dead_band", joint, values={"d": d})
    scores = ask(fitted(elbow_log(band, seed=seed)), band.effect)
    (own,) = [s for s in scores if s.candidate.term.place == band.place]
    assert own.share > share


@pytest.mark.parametrize(("seed", "joint", "d"), [(4, 2, 3.0), (1, 1, 8.0)])
def test_a_dead_band_that_is_declared_is_fitted_where_the_torque_crosses_zero_slowly(
    seed, joint, d
):
    """From a model that had none it came to -7.8 N m at 12 times the noise, and to 7.8 at ten times it."""
    band, friction = "torque_dead_band", "viscous_friction,coulomb_friction"
    log = elbow_log(Term(band, joint, values={"d": d}), seed=seed)
    declared = (*parse_terms(friction, elbow().joints), Term(band, joint))
    found = estimate(elbow(), declared, [prepare(log, BAND)])
    assert found.model.terms[-1].values["d"] == pytest.approx(d, rel=0.01)
    assert found.fit.sigma[joint] < 0.05


def test_a_clean_torque_is_left_as_it_is():
    assert not passing(ask(fitted(elbow_log()), *LAWS))


def test_a_filter_of_scipy_is_named_with_its_time_constant():
    log, tc = elbow_log(), 0.015
    step = log.t[1] - log.t[0]
    b, a, _ = signal.cont2discrete(([1.0], [tc, 1.0]), step, "foh")
    slow = signal.lfilter(b.ravel(), a, log.tau - log.tau[0], axis=0) + log.tau[0]
    _, best, after = named(replace(log, tau=slow), "torque_lag", "time_delay")
    assert best.candidate.term.effect == "torque_lag"
    assert find_term(after, best.candidate.term).values["tc"] == pytest.approx(tc, rel=0.05)


def test_a_pure_delay_is_no_filter():
    _, best, after = named(elbow_log(Term("time_delay", values={"seconds": 0.012})), *LAWS)
    assert best.candidate.term.effect == "time_delay"
    assert find_term(after, best.candidate.term).values["seconds"] == pytest.approx(0.012, rel=0.01)


def test_a_filter_takes_the_place_of_the_delay_it_was_taken_for():
    log = elbow_log(Term("torque_lag", values={"tc": 0.02, "seconds": 0.0}))
    _, _, both = named(log, "time_delay")
    (lag,) = [t for t in both.model.terms if t.joint is None]
    assert lag.effect == "torque_lag"
    assert lag.values["tc"] == pytest.approx(0.02, rel=0.05)


@pytest.mark.parametrize(
    ("truth", "law"),
    [
        (Term("drive_lag", 1, values={"tc": 0.03}), "drive_lag"),
        (Term("hysteresis", 1, values={"fc": 4.0, "x0": 0.05}), "hysteresis"),
        (Term("torque_lag", values={"tc": 0.03, "seconds": 0.0}), "time_delay"),
    ],
    ids=lambda x: x if isinstance(x, str) else x.effect,
)
def test_a_filter_in_one_drive_is_told_from_what_is_late_beside_it(truth, law):
    asked = ("drive_lag", "hysteresis", "time_delay")
    best = passing(ask(fitted(elbow_log(truth)), *asked))[0]
    assert best.candidate.term.effect == law


@pytest.mark.parametrize("earlier", [False, True])
def test_a_filter_in_one_drive_is_no_change_since_an_earlier_model(earlier):
    """A measured torque holds all that changed: a load that was put down was told as others."""
    found = fitted(elbow_log())
    asked = {t.effect for t in eligible_terms(found.model, found.motions, earlier)}
    assert ("drive_lag" in asked) != earlier


def test_what_extends_an_addition_is_asked_with_its_like_alone():
    """That a delay is missing was proven; that it is a filter needs no proof against all other laws again."""
    found = fitted(elbow_log(Term("torque_lag", values={"tc": 0.02, "seconds": 0.0})))
    delayed = refit_with(found, passing(ask(found, "time_delay"))[0])
    scores = ask(delayed, "torque_lag", "joint_spring")
    hardly = [replace(s, p_value=0.5 * Rules().significance) for s in scores]
    (lag,) = accepted(hardly, Rules(), [Term("time_delay")])
    assert lag.candidate.term.effect == "torque_lag"
    assert not accepted(hardly, Rules())
