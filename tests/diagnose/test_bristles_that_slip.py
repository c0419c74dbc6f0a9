"""Bristles that slip early and elements that slip one by one are told from plain ones, beside them alone."""

from dataclasses import replace

import numpy as np
import pytest
from elbow import ask, elbow, elbow_log, fitted, passing
from planted import BAND
from scipy.integrate import solve_ivp

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation.estimate import TOLD, untold
from jaxswarm.identify.synthetic import fourier_motion
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import prepare

FC, X0, RISE, VS = 8.0, 0.05, 0.8, 0.15
DOUBLES = ("hysteresis", "stribeck_friction", "dwell_friction", "nonlinear_viscous_friction")
DAHL = Term("hysteresis", 1, values={"fc": FC, "x0": X0})


def log_of_lugre() -> Log:
    """Bristles of the second joint integrated by SciPy along the motion of the log."""
    log = elbow_log()
    t, _, dq, _ = fourier_motion(3, np.random.default_rng(1), 12.0, 125.0)

    def bend(now, z):
        v = np.interp(now, t, dq[:, 1])
        return (v - abs(v) * z / (1.0 + RISE * np.exp(-((v / VS) ** 2)))) / X0

    path = solve_ivp(bend, (0.0, t[-1]), [0.0], t_eval=t, max_step=2e-3, rtol=1e-6)
    tau = log.tau.copy()
    tau[:, 1] += FC * path.y[0]
    return replace(log, tau=tau)


def with_bristles(log: Log):
    """The fit with the bristles that are found first."""
    found = fitted(log)
    best = passing(ask(found, *DOUBLES))[0]
    assert best.candidate.term.place == DAHL.place
    return refit_with(found, best)


def test_bristles_that_slip_early_are_named_with_their_values():
    plain = with_bristles(log_of_lugre())
    best = passing(ask(plain, "lugre_friction", *DOUBLES))[0]
    after = refit_with(plain, best)
    term = find_term(after, best.candidate.term)
    assert term.place == ("lugre_friction", 1, None)
    assert not [t for t in after.model.terms if t.effect == "hysteresis"]
    for name, value in {"fc": FC, "x0": X0, "rise": RISE, "vs": VS}.items():
        assert term.values[name] == pytest.approx(value, rel=0.1), name


def test_bristles_of_dahl_stay_what_they_are():
    assert not passing(ask(with_bristles(elbow_log(DAHL)), "lugre_friction", "maxwell_slip"))


def test_elements_that_slip_one_by_one_are_named_with_their_values():
    levels = {"fc1": 8.0, "fc2": 6.0, "x1": 0.2, "part": 0.2}
    plain = with_bristles(elbow_log(Term("maxwell_slip", 1, values=levels)))
    best = passing(ask(plain, "maxwell_slip", "lugre_friction", *DOUBLES))[0]
    after = refit_with(plain, best)
    term = find_term(after, best.candidate.term)
    assert term.place == ("maxwell_slip", 1, None)
    assert not [t for t in after.model.terms if t.effect == "hysteresis"]
    for name, value in levels.items():
        assert term.values[name] == pytest.approx(value, rel=0.1), name


def test_a_rise_that_jumps_at_a_reversal_is_no_slip_of_bristles():
    jump = Term("stribeck_friction", 1, values={"df": 4.0, "vs": VS, "delta": 2.0})
    plain = with_bristles(elbow_log(DAHL, jump))
    best = passing(ask(plain, "lugre_friction", *DOUBLES))[0]
    assert best.candidate.term.place == jump.place


@pytest.mark.parametrize(
    ("levels", "lost"),
    [((8.0, 6.0), []), ((8.0, 0.1), ["part"]), ((0.1, 6.0), ["x1", "part"])],
)
def test_a_way_is_told_by_its_level(levels, lost):
    values = {"fc1": levels[0], "fc2": levels[1], "x1": 0.2, "part": 0.3}
    errors = dict.fromkeys(values, 0.1)
    assert untold(Term("maxwell_slip", 1, values=values), errors) == lost


def test_the_way_of_an_element_that_is_not_there_is_not_told():
    one = {"fc1": 8.0, "fc2": 0.0, "x1": 0.2, "part": 0.3}
    declared = parse_terms("viscous_friction,coulomb_friction", elbow().joints)
    log = elbow_log(Term("maxwell_slip", 1, values=one))
    found = estimate(
        elbow(), (*declared, Term("maxwell_slip", 1)), [prepare(log, BAND)], bounded=False
    )
    errors = found.std_errors[-1]
    levels = {name: found.model.terms[-1].values[name] / errors[name] for name in ("fc1", "fc2")}
    assert min(abs(x) for x in levels.values()) < TOLD < max(abs(x) for x in levels.values())
    assert np.isnan(errors["part"])
    assert np.isnan(errors["x1"]) == (abs(levels["fc1"]) < TOLD)


@pytest.mark.parametrize("start", [{"x1": 0.3, "part": 0.3}, {"x1": 0.09, "part": 0.3}])
def test_an_element_that_is_alone_is_the_first_wherever_the_search_begins(start):
    declared = parse_terms("viscous_friction,coulomb_friction", elbow().joints)
    alone = {"fc1": 0.0, "fc2": 6.0, "x1": 0.3, "part": 0.3}
    log = elbow_log(Term("maxwell_slip", 1, values=alone))
    law = Term("maxwell_slip", 1, values=start)
    found = estimate(elbow(), (*declared, law), [prepare(log, BAND)], bounded=False)
    values, errors = found.model.terms[-1].values, found.std_errors[-1]
    for name, value in {"fc1": 6.0, "fc2": 0.0, "x1": 0.09}.items():
        assert abs(values[name] - value) < TOLD * errors[name], name
    assert abs(values["fc1"]) > TOLD * errors["fc1"]
    assert np.isnan(errors["part"])


def test_they_are_asked_beside_bristles_alone():
    found = fitted(elbow_log())
    asked = {t.effect for t in eligible_terms(found.model, found.motions)}
    assert not asked & {"lugre_friction", "maxwell_slip"}
