"""Exponents stay at the usual ones unless a log tells others."""

import importlib
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from small_problems import make_motion, planar_arm

from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate

estimating = importlib.import_module("jaxswarm.identify.estimation.estimate")
PLAIN = [Term(e, j) for e in ("coulomb_friction", "viscous_friction") for j in range(2)]
WIDTH = 0.05


def log_of(delta: float, noise: float):
    """A log whose first joint has a curve 1.5 N m high at rest and gone beyond 0.4 rad/s."""

    def friction(q, dq, ddq):
        curve = 1.5 * np.exp(-((np.abs(dq) / 0.4) ** delta)) * np.array([1.0, 0.0])
        return (2.0 + curve) * np.tanh(dq / WIDTH) + 0.5 * dq

    return make_motion(planar_arm(), friction, length=1500, noise=noise)


@cache
def fitted(delta: float, noise: float):
    """Values and errors of that curve."""
    motion = log_of(delta, noise)
    found = estimate(planar_arm(), (*PLAIN, Term("stribeck_friction", 0)), [motion], width=WIDTH)
    return found.model.terms[-1].values, found.std_errors[-1]


def test_where_the_log_does_not_tell_another_it_is_the_usual_one_and_has_no_error():
    values, errors = fitted(2.0, 0.5)
    assert values["delta"] == 2.0 and np.isnan(errors["delta"])
    assert abs(values["df"] - 1.5) < 3.0 * errors["df"] and errors["df"] < 0.3


@pytest.mark.parametrize("delta", [0.8, 1.2])
def test_where_the_log_tells_another_it_is_that_one(delta):
    values, errors = fitted(delta, 0.02)
    assert abs(values["delta"] - delta) < 4.0 * errors["delta"] < 0.4


@pytest.mark.parametrize(("delta", "noise", "fits"), [(0.8, 0.02, 1), (2.0, 0.5, 2)])
def test_what_a_fit_near_told_is_asked_whether_it_is_usual_after_all(
    monkeypatch, delta, noise, fits
):
    """A filter that is late besides was fitted as one that is not first, for half the time of each fit."""
    values, errors = fitted(delta, noise)
    curve = Term("stribeck_friction", 0, values={**values, "delta": min(delta, 1.2)})
    counted, plain = [], estimating.fitted_at_width
    monkeypatch.setattr(estimating, "fitted_at_width", lambda *a: counted.append(1) or plain(*a))
    terms = (*PLAIN, curve)
    again = estimate(planar_arm(), terms, [log_of(delta, noise)], width=WIDTH, near=terms)
    assert len(counted) == fits
    told, doubts = again.model.terms[-1].values, again.std_errors[-1]
    assert told == pytest.approx(values, rel=0.01)
    assert doubts["delta"] == pytest.approx(errors["delta"], rel=0.01, nan_ok=True)


def test_a_width_that_made_up_for_the_usual_exponent_is_asked_again_beside_the_true_one():
    """Beside an exponent of 2 the first joint's sign came out sharper than the second's: 1.45, and 1.3 N m."""

    def friction(q, dq, ddq):
        curve = 2.0 * np.exp(-np.abs(dq) / 0.2) * np.array([1.0, 0.0])
        return (2.0 + curve) * np.tanh(dq / WIDTH) + 0.5 * dq

    motion = make_motion(planar_arm(), friction, length=3000, noise=0.01)
    found = estimate(planar_arm(), (*PLAIN, Term("stribeck_friction", 0)), [motion])
    values = found.model.terms[-1].values
    assert abs(values["delta"] - 1.0) < 0.05
    assert abs(values["df"] - 2.0) < 0.1
    assert np.allclose(found.model.width, WIDTH, rtol=0.02)


def bent(n: float, c: float, noise: float):
    """The law of a drive whose gain falls with a power of the torque, as fitted to a log of two joints."""

    motion = make_motion(planar_arm(), length=1500)
    largest = np.abs(motion.tau[:, 0]).max()
    size = np.abs(motion.tau[:, 0]) / largest
    rng, tau = np.random.default_rng(4), motion.tau.copy()
    tau[:, 0] *= 1.0 - c * size**n
    tau += noise * rng.standard_normal(tau.shape)
    law = Term("torque_constant_saturation", 0)
    found = estimate(planar_arm(), (law,), [replace(motion, tau=tau)], width=WIDTH)
    return found.model.terms[0].values, found.std_errors[0], largest


@pytest.mark.parametrize("c", [0.2, -0.2])
def test_how_a_gain_falls_is_told_where_the_log_tells_it(c):
    """With a fall in proportion alone a drive that saturates by the square was told beside false contacts."""
    values, errors, largest = bent(2.0, c, 1e-3)
    assert abs(values["n"] - 2.0) < 4.0 * errors["n"] < 0.2
    # What is lost of the largest torque, told at about that.
    lost = values["c"] * largest * (largest / values["at"]) ** (values["n"] - 1.0)
    assert lost == pytest.approx(c, rel=0.03)
    assert values["at"] == pytest.approx(largest, rel=0.3)
    assert errors["c"] < 0.1 * abs(values["c"])


def test_a_gain_that_falls_in_proportion_has_no_exponent_of_its_own():
    values, errors, largest = bent(1.0, 0.2, 0.02)
    assert values["n"] == 1.0 and np.isnan(errors["n"])
    assert abs(values["c"] * largest - 0.2) < 4.0 * errors["c"] * largest
