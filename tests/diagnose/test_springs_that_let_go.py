"""A spring that lets go with time is named with its values, and none is seen in what only resembles it."""

from dataclasses import replace

import numpy as np
import pytest
from elbow import ask, elbow_log, fitted, passing
from scipy.integrate import solve_ivp

from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.term import Term
from jaxswarm.identify.synthetic import fourier_motion
from jaxswarm.logs.log import Log

K, TC = 15.0, 0.3
DOUBLES = (
    *("hysteresis", "joint_spring", "nonlinear_viscous_friction", "stribeck_friction"),
    *("quadratic_drag", "cubic_spring", "dead_zone_spring", "torque_lag", "time_delay"),
)


def log_of_a_hose() -> Log:
    """A spring and a damper in series on the second joint, integrated by SciPy along the motion of the log."""
    log = elbow_log()
    t, _, dq, _ = fourier_motion(3, np.random.default_rng(1), 12.0, 125.0)
    path = solve_ivp(
        lambda now, z: np.interp(now, t, dq[:, 1]) - z / TC,
        *((0.0, t[-1]), [TC * dq[0, 1]]),
        **{"t_eval": t, "max_step": 2e-3, "rtol": 1e-6},
    )
    tau = log.tau.copy()
    tau[:, 1] += K * path.y[0]
    return replace(log, tau=tau)


def test_it_is_named_with_its_values():
    found = fitted(log_of_a_hose())
    best = passing(ask(found, "relaxing_spring", *DOUBLES))[0]
    assert best.candidate.term.place == ("relaxing_spring", 1, None)
    values = find_term(refit_with(found, best), best.candidate.term).values
    assert values["k"] == pytest.approx(K, rel=0.1)
    assert values["tc"] == pytest.approx(TC, rel=0.1)


@pytest.mark.parametrize(
    "term",
    [
        Term("joint_spring", 1, values={"k": 15.0, "tau0": 0.0}),
        Term("hysteresis", 1, values={"fc": 5.0, "x0": 0.06}),
        Term("quadratic_drag", 1, values={"c": 2.0}),
    ],
    ids=lambda term: term.effect,
)
def test_what_resembles_it_keeps_its_name(term):
    found = fitted(elbow_log(term))
    best = passing(ask(found, "relaxing_spring", *DOUBLES))[0]
    assert best.candidate.term.place == term.place


def test_a_log_without_it_stays_as_it_is():
    assert not passing(ask(fitted(elbow_log()), "relaxing_spring"))
