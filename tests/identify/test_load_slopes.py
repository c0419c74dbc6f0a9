"""A law that goes by the load is fitted together with the parameters that the load follows from."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from jaxswarm.effects.formula import DISCOVERED, Formula
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.forward import compliance
from jaxswarm.identify.forward import load_slopes as load_slopes_module
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.load_slopes import load_slopes
from jaxswarm.identify.forward.measuring_chain import assemble
from jaxswarm.identify.forward.regression import build_regression
from jaxswarm.identify.forward.torque_along import torque_along
from jaxswarm.identify.synthetic import Noise, demo_case, synthetic_log
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.robot import rx60

NOISE, WIDTH = 0.2, (0.01,) * 3
SIZE = Parameter("a", "", -1e6, 1e6, True, 1.0, "factor")
PRODUCT = Formula((("q", "load", "static_load", "*", "*"),), (SIZE,), ())
FRICTION = Term("load_dependent_friction", 1, values={"mu": 0.2, "inertial": 0.6})
GAIN = Term("drive_gain", 1, values={"gain": 1.3})
DRAG = Term("viscous_friction", 1, values={"b": 3.0})
BENT = Term("torque_constant_saturation", 1, values={"c": 0.02})
SOFT = Term("base_compliance", values={"cx": 2e-3, "cy": 1e-3})
SWINGING = Term(
    "base_compliance", values={"cx": 2e-5, "cy": 1e-5, "fx": 9.0, "fy": 12.0, "zeta": 0.05}
)
LATE = Term("time_delay", None, values={"seconds": 0.004})


def by_load(joint, size):
    return Term(DISCOVERED, joint, values={"a": size}, formula=PRODUCT)


@cache
def case():
    arm, declared, _ = demo_case(rx60(), 201)
    return arm, declared


def log_with(*terms, noise=NOISE):
    arm, declared = case()
    terms = (*declared, *terms)
    return synthetic_log(arm, terms, 3, noise=Noise(0.0, noise), duration=12.0, rate=125.0)


@pytest.mark.parametrize(
    "terms",
    [
        (by_load(1, 0.05),),
        (FRICTION,),
        (by_load(0, 0.3), FRICTION, GAIN),
        (FRICTION, LATE),
        (DRAG, BENT),
        (DRAG, FRICTION, BENT, LATE),
        (SOFT,),
        (SWINGING,),
    ],
    ids=[
        "formula",
        "friction",
        "two and a gain",
        "late",
        "bent",
        "bent and late",
        "soft base",
        "swinging base",
    ],
)
def test_columns_and_slopes_are_the_derivative_of_the_torque(terms):
    arm, _ = case()
    motion = prepare(log_with(*terms), Filtering(20.0, 10.0))
    rigid, pi = rigid_of(arm, motion), np.asarray(arm.parameters).ravel()
    theta = np.concatenate([pi, [t.values[p.name] for t in terms for p in t.law.linear]])

    def torque(at):
        return motion.decimator.apply(torque_along(arm, terms, motion, WIDTH, at, rigid))

    made = load_slopes(arm, terms, motion, WIDTH, pi, rigid)
    plain = load_slopes(arm, terms, motion, WIDTH, pi)
    np.testing.assert_allclose(plain, made, atol=1e-6 * np.abs(made).max())
    whole = assemble(arm, terms, motion, WIDTH, pi, rigid, decimate=True) + made
    way = np.random.default_rng(0).normal(size=theta.size) * np.maximum(np.abs(theta), 0.1)
    step = 1e-6
    told = (torque(theta + step * way) - torque(theta - step * way)) / (2.0 * step)
    np.testing.assert_allclose(whole @ way, told, atol=1e-4 * np.abs(told).max())


def test_columns_of_links_that_a_joint_does_not_feel_are_not_asked_for(monkeypatch):
    """They are zeros: half of all numbers of six joints, which were multiplied and decimated all the same."""
    arm, _ = case()
    motion = prepare(log_with(FRICTION), Filtering(20.0, 10.0))
    rigid, pi = rigid_of(arm, motion), np.asarray(arm.parameters).ravel()
    told = load_slopes(arm, (FRICTION,), motion, WIDTH, pi, rigid)
    columns = load_slopes_module._columns

    def unknown(*of):
        made = [x.copy() for x in columns(*of)]
        for x in made:
            assert not x[:, 1, :10].any()
            x[:, 1, :10] = np.nan
        return made

    monkeypatch.setattr(load_slopes_module, "_columns", unknown)
    made = load_slopes(arm, (FRICTION,), motion, WIDTH, pi, rigid)
    np.testing.assert_array_equal(made, told)


def test_what_a_soft_base_keeps_of_a_motion_serves_all_parameters(monkeypatch):
    """Moments and their derivatives were made anew at every step of a fit, for half of its time."""
    arm, _ = case()
    motion = prepare(log_with(), Filtering(20.0, 10.0))
    rigid, pi = rigid_of(arm, motion), np.asarray(arm.parameters).ravel()
    load_slopes(arm, (SOFT,), motion, WIDTH, pi, rigid)
    other = replace(SOFT, values={"cx": 5e-4, "cy": 3e-3})
    plain = load_slopes(arm, (other,), motion, WIDTH, 1.2 * pi + 0.01)
    monkeypatch.setattr(compliance, "SwayResponse", None)
    again = load_slopes(arm, (other,), motion, WIDTH, 1.2 * pi + 0.01, rigid)
    np.testing.assert_allclose(again, plain, atol=1e-12 * np.abs(plain).max())


def test_the_target_is_met_by_the_true_model():
    arm, declared = case()
    terms = (*declared, by_load(1, 0.05))
    motion = prepare(log_with(by_load(1, 0.05), noise=0.0), Filtering(20.0, 10.0))
    pi = np.asarray(arm.parameters).ravel()
    rows = build_regression(arm, terms, [motion], WIDTH, pi)
    linear = [t.values[p.name] for t in terms for p in t.law.linear]
    left = rows.target - rows.columns @ np.concatenate([pi, linear])
    assert np.abs(left).max() < 0.01 * np.abs(rows.torque).max()


def test_a_law_larger_than_its_load_is_fitted_down_to_the_noise():
    _, declared = case()
    scale = Parameter("s", "", 0.1, 100.0, False, 4.0, "scale", "log")
    program = ("q", "square", "load", "s", "/", "tanh", "*", "static_load", "*")
    formula = Formula((program,), (SIZE, scale), ())
    truth = Term(DISCOVERED, 0, values={"a": 92.0, "s": 4.4}, formula=formula)
    blank = tuple(replace(t, values={}) for t in (*declared, truth))
    found = estimate(rx60(), blank, [prepare(log_with(truth), Filtering(20.0, 10.0))])
    told = estimate(rx60(), blank[:-1], [prepare(log_with(), Filtering(20.0, 10.0))])
    assert found.fit.sigma[0] < 1.2 * told.fit.sigma[0]
    assert found.model.terms[-1].values["a"] == pytest.approx(92.0, rel=0.05)


@pytest.mark.parametrize("truth", [replace(BENT, values={"c": 0.03}), SOFT], ids=["bent", "soft"])
def test_what_follows_from_the_whole_torque_is_fitted_down_to_the_noise(truth):
    """With the torque as a given number these ended at 1.8 and 6.3 times the noise on logs like this one."""
    _, declared = case()
    blank = tuple(replace(t, values={}) for t in (*declared, truth))
    found = estimate(rx60(), blank, [prepare(log_with(truth), Filtering(20.0, 10.0))])
    told = estimate(rx60(), blank[:-1], [prepare(log_with(), Filtering(20.0, 10.0))])
    assert (found.fit.sigma < 1.1 * told.fit.sigma).all()
    for name, value in truth.values.items():
        error = found.std_errors[-1][name]
        assert found.model.terms[-1].values[name] == pytest.approx(value, abs=4.0 * error)
