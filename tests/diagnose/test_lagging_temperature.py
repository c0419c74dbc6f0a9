"""Friction that follows the sensor's temperature late is told from friction that follows it at once."""

from dataclasses import replace

import numpy as np
import pytest
from elbow import ask, elbow_log, fitted, passing
from scipy import signal

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.decision.competing import choose
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.identify.synthetic import fourier_motion
from jaxswarm.logs.log import Log

A, B, LAG = -0.15, -0.08, 3.0


def warm_log(lag: float) -> Log:
    """Heat that comes and goes, 20 to 45 deg C, and friction of the second joint by it, late by SciPy."""
    log = elbow_log()
    t, _, dq, _ = fourier_motion(3, np.random.default_rng(1), 12.0, 125.0)
    heat = 20.0 + 25.0 * np.clip(t / 4.0, 0.0, 1.0) * (0.6 + 0.4 * np.cos(0.9 * t))
    late = heat
    if lag:
        _, late, _ = signal.lsim(([1.0], [lag, 1.0]), heat - heat[0], t)
        late = late + heat[0]
    tau = log.tau.copy()
    tau[:, 1] += (A * np.tanh(dq[:, 1] / 0.01) + B * dq[:, 1]) * (late - 25.0)
    channel = np.repeat(heat[:, None], 3, axis=1)
    return replace(log, tau=tau, channels={"temperature": channel})


RIVALS = ("temperature_friction", "thermal_drift", "friction_change")


def chosen(log: Log):
    """What is chosen among all that may follow a temperature, the names of its rivals, and the fit with it."""
    found = fitted(log)
    passed = passing(ask(found, "lagging_temperature_friction", *RIVALS))
    best, rivals = choose(passed, Rules(), cross_fit(found))
    return best.candidate.term, [s.candidate.term.effect for s in rivals], refit_with(found, best)


def test_a_lubricant_that_warms_late_is_named_with_its_time():
    term, rivals, after = chosen(warm_log(LAG))
    assert not rivals
    term = find_term(after, term)
    assert term.place == ("lagging_temperature_friction", 1, None)
    assert term.values["tl"] == pytest.approx(LAG, rel=0.1)
    assert term.values["a"] == pytest.approx(A, rel=0.1)


def test_a_sensor_in_the_lubricant_is_not_late():
    term, rivals, after = chosen(warm_log(0.0))
    assert (term.place, rivals) == (("temperature_friction", 1, None), [])
    assert not passing(ask(after, "lagging_temperature_friction"))


def test_it_is_not_asked_of_a_log_without_a_sensor():
    found = fitted(elbow_log())
    asked = {t.effect for t in eligible_terms(found.model, found.motions)}
    assert "lagging_temperature_friction" not in asked
