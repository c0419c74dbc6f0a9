"""Every registered law keeps the contract, and the contract finds each kind of broken law."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.effects import REGISTRY, Law, Parameter, TorqueLaw
from jaxswarm.effects.contract import check_unit, draw_series
from jaxswarm.effects.series import law_columns, law_torque
from jaxswarm.effects.term import physical_unit
from jaxswarm.testing import check_effect

LAWS = sorted(REGISTRY)
TORQUES = [name for name in LAWS if isinstance(REGISTRY[name], TorqueLaw)]
B = Parameter("b", "N m s/rad", 0.0, 10.0, True, 1.0, "coefficient")
V = Parameter("v", "rad/s", 0.1, 1.0, False, 0.5, "velocity", "log")


@pytest.mark.parametrize("name", LAWS)
def test_every_law_keeps_the_contract(name):
    check_effect(REGISTRY[name])


@pytest.mark.parametrize("name", LAWS)
def test_what_a_law_is_linear_in_is_zero_where_it_does_nothing(name):
    law = REGISTRY[name]
    assert not any(law.neutral()[p.name] for p in law.linear)


def broken(**changes) -> Law:
    fields = {
        "name": "trial",
        "scope": "joint",
        "parameters": (B, V),
        "summary": "trial",
        "reference": "none",
        "torque": lambda p, s: p["b"] * s.dq * jnp.exp(-((s.dq / p["v"]) ** 2)),
    }
    return Law(**{**fields, **changes})


def test_a_sound_law_passes():
    check_effect(broken())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"torque": lambda p, s: p["b"] ** 2 * s.dq}, "not linear"),
        ({"torque": lambda p, s: p["b"] * s.dq + 0.1}, "leaves a torque"),
        ({"torque": lambda p, s: p["b"] * jnp.sqrt(s.dq**2)}, "no finite derivative at rest"),
        ({"torque": lambda p, s: p["b"] / s.dq}, "no finite torque"),
        ({"torque": lambda p, s: -p["b"] * s.dq, "dissipative": True}, "drives"),
        ({"torque": lambda p, s: jnp.stack([p["b"] * s.dq] * 2)}, "one torque per sample"),
        ({"parameters": (V,), "torque": lambda p, s: s.dq / p["v"]}, "no linear parameter"),
        (
            {"torque": lambda p, s: p["b"] * s.state, "rate": lambda p, s: p["b"] * s.dq},
            "(not linear|depends on its linear)",
        ),
        (
            {"torque": lambda p, s: p["b"] * s.state, "rate": lambda p, s: 1e3 * s.state + s.dq},
            "(finite)",
        ),
        ({"begins": "v"}, "before it begins"),
    ],
)
def test_broken_laws_are_found(changes, message):
    with pytest.raises(AssertionError, match=message):
        check_effect(broken(**changes))


@pytest.mark.parametrize("unit", ["Nm", "N m s/rad/s", "N m (s/rad", "kg m^x", "", "lb", "N-m"])
def test_units_that_cannot_be_read_are_found(unit):
    with pytest.raises(AssertionError, match="cannot be read"):
        check_unit(unit, ["b"])


@pytest.mark.parametrize("name", LAWS)
def test_units_have_a_prismatic_form(name):
    for p in REGISTRY[name].parameters:
        moved = physical_unit(p.unit, "prismatic")
        check_unit(moved, [other.name for other in REGISTRY[name].parameters])
        assert "rad" not in moved
        assert physical_unit(p.unit, "revolute") == p.unit


@pytest.mark.parametrize("name", TORQUES)
def test_columns_are_derivatives_of_the_torque(name):
    # The contract compares sums; here each column stands alone, against one unit of its parameter.
    law = REGISTRY[name]
    series = draw_series(np.random.default_rng(3), 16)
    nonlinear = {p.name: p.nominal for p in law.nonlinear}
    columns = law_columns(law, nonlinear, series)
    for k, unit in enumerate(law.linear):
        values = {p.name: float(p.name == unit.name) for p in law.linear}
        alone = law_torque(law, {**values, **nonlinear}, series)
        np.testing.assert_allclose(columns[:, k], alone, rtol=1e-12, atol=1e-12)
