"""Laws against values worked out by hand, physics over random samples, the Dahl bristle by an ODE solver."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from jaxswarm.effects import REGISTRY, Law, Parameter, get_law, make_sample, register
from jaxswarm.effects.series import law_torque, states
from jaxswarm.errors import InputError

BRAKES = sorted(law.name for law in REGISTRY.values() if getattr(law, "dissipative", False))


def value(name, parameters, **sample):
    return float(get_law(name).torque(parameters, make_sample(**sample)))


@pytest.mark.parametrize(
    ("name", "parameters", "sample", "expected"),
    [
        ("viscous_friction", {"b": 2.0}, {"dq": -0.5}, -1.0),
        ("coulomb_friction", {"fc": 3.0}, {"dq": -5.0, "direction": -1.0}, -3.0),
        ("torque_offset", {"tau0": 0.7}, {"q": 9.0}, 0.7),
        ("rotor_inertia", {"ia": 0.5}, {"ddq": 4.0}, 2.0),
        ("joint_spring", {"k": 10.0, "tau0": 1.0}, {"q": 0.2}, 3.0),
        ("quadratic_drag", {"c": 0.5}, {"dq": -2.0}, -2.0),
        (
            "load_dependent_friction",
            {"mu": 0.1, "inertial": 0.25},
            {"static_load": -30.0, "load": -50.0, "direction": -1.0},
            -3.5,
        ),
        ("nonlinear_viscous_friction", {"c": 2.0, "alpha": 3.0}, {"dq": 2.0, "direction": 1.0}, 16),
        ("thermal_drift", {"fc": 2.0, "tc": 9.0}, {"t": 9.0, "direction": 1.0}, 2.0 / np.e - 2.0),
        (
            "temperature_friction",
            {"a": 0.1, "b": 0.2},
            {"temperature": 35.0, "direction": -1.0, "dq": -2.0},
            -5.0,
        ),
        ("torque_ripple", {"sine": 2.0, "cosine": 1.0, "n": 3.0}, {"q": np.pi / 6}, 2.0),
        (
            "stribeck_friction",
            {"df": 2.0, "vs": 0.1, "delta": 2.0},
            {"dq": 0.1, "direction": 1.0},
            2.0 * np.exp(-1.0),
        ),
        (
            "asymmetric_friction",
            {"fc_pos": 1.0, "fc_neg": 2.0, "b_pos": 3.0, "b_neg": 4.0},
            {"dq": -0.5, "direction": -1.0},
            -4.0,
        ),
        (
            "cable_coupling",
            {"kc": 3.0, "k": 2.0, "tau0": 1.0},
            {"q": 0.5, "q_other": -1.0},
            -1.0,
        ),
        ("cubic_spring", {"k3": 2.0, "q0": 0.5}, {"q": -0.5}, -2.0),
        ("dead_zone_spring", {"k": 2.0, "q0": 0.5, "gap": 0.3}, {"q": -0.5}, -1.4),
        ("dead_zone_spring", {"k": 2.0, "q0": 0.5, "gap": 0.3}, {"q": 0.7}, 0.0),
        ("dead_zone_spring", {"k": 2.0, "q0": 0.5, "gap": 0.3}, {"q": 1.0}, 0.4),
        (
            "position_dependent_friction",
            {"sine": 2.0, "cosine": 1.0, "n": 3.0},
            {"q": np.pi / 6, "direction": -1.0},
            -2.0,
        ),
        ("gravity_compensator", {"a": 3.0, "b": 0.5, "q0": 0.2}, {"q": 0.2 + np.pi / 4},
         3.0 / np.sqrt(1.0 + 0.5 * np.sqrt(0.5))),
        ("offset_drift", {"rate": 2.0, "tc": 9.0}, {"t": 9.0}, 18.0 - 18.0 / np.e),
        ("offset_change", {"tau": 2.0, "t0": 9.0}, {"t": 9.1, "direction": -1.0}, 2.0),
        ("offset_change", {"tau": 2.0, "t0": 9.0}, {"t": 8.9, "direction": 1.0}, 0.0),
        ("friction_change", {"fc": 2.0, "t0": 9.0}, {"t": 9.1, "direction": -1.0}, -2.0),
        ("friction_change", {"fc": 2.0, "t0": 9.0}, {"t": 8.9, "direction": -1.0}, 0.0),
        (
            "transmission_coupling",
            {"b": 1.0, "fc": 2.0, "fd": 3.0, "ia": 0.5},
            {"dq_other": 3.0, "direction_sum": -1.0, "direction_difference": 0.5, "ddq_other": 2.0},
            3.5,
        ),
    ],
)  # fmt: skip
def test_by_hand(name, parameters, sample, expected):
    assert value(name, parameters, **sample) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("name", BRAKES)
@settings(max_examples=30, deadline=None)
@given(
    dq=st.floats(-10, 10, allow_subnormal=False),
    load=st.floats(-1e3, 1e3),
    static=st.floats(-1e3, 1e3),
    width=st.floats(1e-6, 1.0),
    unit=st.lists(st.floats(0, 1), min_size=6, max_size=6),
)
def test_friction_never_drives(name, dq, load, static, width, unit):
    law = REGISTRY[name]
    p = {
        q.name: q.lower + u * (q.upper - q.lower)
        for q, u in zip(law.parameters, unit, strict=False)
    }
    power = value(name, p, dq=dq, direction=np.tanh(dq / width), load=load, static_load=static) * dq
    assert power >= -1e-12 * abs(power)


@given(st.lists(st.floats(-10, 10, allow_subnormal=False), min_size=7, max_size=7))
def test_a_coupling_is_one_law_whichever_way_the_axes_point(drawn):
    b, fc, fd, ia, dq, dq_other, ddq_other = drawn

    def torque(dq, dq_other, ddq_other, **values):
        return value(
            "transmission_coupling", values, dq_other=dq_other, ddq_other=ddq_other,
            direction_sum=np.tanh(dq + dq_other), direction_difference=np.tanh(dq - dq_other),
        )  # fmt: skip

    here = torque(dq, dq_other, ddq_other, b=b, fc=fc, fd=fd, ia=ia)
    turned = {"b": -b, "fc": fd, "fd": fc, "ia": -ia}
    assert torque(dq, -dq_other, -ddq_other, **turned) == pytest.approx(here, abs=1e-4)
    assert torque(-dq, dq_other, ddq_other, **turned) == pytest.approx(-here, abs=1e-4)


def test_derived_parameters_state_the_same_law():
    spring = get_law("joint_spring")
    assert float(spring.derived({"k": 4.0, "tau0": -2.0})["q0"][0]) == 0.5
    ripple = get_law("torque_ripple")
    p = {"sine": 0.3, "cosine": -0.4, "n": 7.0}
    a, phase = (float(ripple.derived(p)[name][0]) for name in ("a", "phase"))
    for q in np.linspace(-3, 3, 13):
        assert a * np.sin(7 * q + phase) == pytest.approx(value("torque_ripple", p, q=q), abs=1e-12)


def bristle(x0, dq_of_t, t):
    """The literature's form with fc = 2, by an adaptive solver: dz/dt = sigma dq (1 - z sign(dq)/fc)."""
    fc, sigma = 2.0, 2.0 / x0

    def rate(time, z):
        dq = dq_of_t(time)
        return sigma * dq * (1.0 - z * np.sign(dq) / fc)

    return solve_ivp(rate, (t[0], t[-1]), [0.0], t_eval=t, rtol=1e-10, atol=1e-12, max_step=1e-3).y[
        0
    ]


@pytest.mark.parametrize(("x0", "step"), [(0.05, 1e-3), (0.005, 1e-3), (0.05, 1e-2)])
def test_dahl_bristle_follows_its_differential_equation(x0, step):
    t = np.arange(0.0, 2.0, step)
    velocity = lambda time: 0.4 * np.cos(5.0 * time) + 0.1 * np.sin(11.0 * time)  # noqa: E731
    series = make_sample(t=jnp.asarray(t), dq=jnp.asarray(velocity(t)))
    found = law_torque(get_law("hysteresis"), {"fc": 2.0, "x0": x0}, series)
    # Second order in the step: the error is that of the motion between samples.
    distance = 0.5 * step / x0
    np.testing.assert_allclose(found, bristle(x0, velocity, t), atol=2.0 * (0.02 * distance + 1e-3))


def test_dahl_bristle_is_exact_under_constant_velocity():
    t = jnp.linspace(0.0, 1.0, 21)
    series = make_sample(t=t, dq=jnp.full(21, 0.3))
    law, p = get_law("hysteresis"), {"fc": 1.0, "x0": 0.05}
    np.testing.assert_allclose(states(law, p, series), 1.0 - jnp.exp(-0.3 * t / 0.05), atol=1e-12)
    # Stiff: 300 bristle lengths in one step stay on the plateau.
    stiff = states(law, {"fc": 1.0, "x0": 1e-4}, make_sample(t=t * 2, dq=jnp.full(21, 0.3)))
    np.testing.assert_allclose(stiff[1:], 1.0, atol=1e-12)


def test_dahl_bristle_loses_energy_over_a_cycle():
    t = jnp.linspace(0.0, 4 * np.pi, 4001)
    q, dq = jnp.sin(t), jnp.cos(t)
    torque = law_torque(get_law("hysteresis"), {"fc": 2.0, "x0": 0.02}, make_sample(t=t, dq=dq))
    lost = float(jnp.trapezoid(torque[2000:] * dq[2000:], t[2000:]))
    # Nearly Coulomb's loss 4 fc amplitude, less what the bristle gives back at each reversal.
    assert 0.93 * 8.0 < lost < 8.0
    assert float(jnp.abs(torque).max()) <= 2.0
    assert float(jnp.abs(q).max()) <= 1.0


def test_states_are_differentiable():
    t = jnp.linspace(0.0, 1.0, 50)
    series = make_sample(t=t, dq=jnp.sin(7 * t))
    law = get_law("hysteresis")

    def total(x0):
        return (states(law, {"fc": 1.0, "x0": x0}, series) ** 2).sum()

    slope = (total(0.05 + 1e-6) - total(0.05 - 1e-6)) / 2e-6
    assert float(jax.grad(total)(0.05)) == pytest.approx(float(slope), rel=1e-6)


def test_unknown_sample_fields_and_laws_are_named():
    with pytest.raises(ValueError, match="velocity"):
        make_sample(velocity=1.0)
    with pytest.raises(InputError, match="coulomb_friction"):
        get_law("coulomb")


def law(**changes) -> Law:
    p = Parameter("b", "1", 0.0, 1.0, True, 0.5, "x")
    fields = {"name": "trial", "scope": "joint", "parameters": (p,), "summary": "", "reference": ""}
    return Law(**{**fields, "torque": lambda p, s: p["b"] * s.dq, **changes})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": "viscous_friction"}, "registered already"),
        ({"scope": "link"}, "scope"),
        ({"scope": "global"}, "scope is 'joint' or 'pair'"),
        ({"torque": None}, "needs a torque"),
        ({"shown_against": "weather"}, "shown against"),
        ({"parameters": (Parameter("b", "1", 1.0, 0.0, True, 0.5, ""),)}, "lower < upper"),
        ({"parameters": (Parameter("b", "1", 0.0, 1.0, True, 2.0, ""),)}, "nominal"),
        ({"parameters": (Parameter("b", "1", 0.0, 1.0, True, 0.5, "", "log"),)}, "scale"),
        ({"parameters": (Parameter("b", "1", 0.0, 1.0, True, 0.5, "", "cubic"),)}, "scale"),
        ({"parameters": (Parameter("b", "1", 0.0, 1.0, True, 0.5, ""),) * 2}, "two parameters"),
        (
            {
                "parameters": (
                    Parameter("v", "1", 0.0, 1.0, False, 0.5, ""),
                    Parameter("b", "1", 0.0, 1.0, True, 0.5, ""),
                )
            },
            "linear parameters first",
        ),
        ({"begins": "T0"}, "refers to a parameter 'T0'; it has 'b'"),
        ({"identity": ("n",)}, "refers to a parameter 'n'"),
        ({"motor_inertia": "ia"}, "refers to a parameter 'ia'"),
        (
            {"parameters": (Parameter("b", "1", 0.0, 1.0, True, 0.5, "", shown_by=("fc",)),)},
            "refers to a parameter 'fc'",
        ),
    ],
)
def test_contradictory_laws_are_refused(changes, message):
    before = dict(REGISTRY)
    with pytest.raises(ValueError, match=message):
        register(law(**changes))
    assert before == REGISTRY


def test_registering_makes_a_law_known(monkeypatch):
    monkeypatch.setattr("jaxswarm.effects.base.REGISTRY", dict(REGISTRY))
    made = register(law())
    assert get_law("trial") is made
    assert "trial" not in REGISTRY
