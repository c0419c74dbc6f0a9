"""Formulas as data: evaluated as NumPy and Python do, sound in their units, refused when damaged."""

import json
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jaxswarm.diagnose.discovery.machine import DEPTH, encode, length_for, run_many, stack_depth
from jaxswarm.effects import REGISTRY, Parameter, make_sample
from jaxswarm.effects.contract import check_unit
from jaxswarm.effects.dimensions import FIELD_UNITS, parse_unit, times, unit_of, unit_text
from jaxswarm.effects.formula import Formula, formula_law, from_json, to_json
from jaxswarm.effects.formula_text import infix, python
from jaxswarm.effects.postfix import UNARY, check_program, evaluate
from jaxswarm.effects.series import law_columns
from jaxswarm.effects.shapes import SHAPES
from jaxswarm.testing import check_effect

FIELDS = ("q", "dq", "direction", "load")
CONSTANTS = ("k", "s")
# What keeps numbers within a few orders of one: an exponent of an exponent does not.
TAME = tuple(name for name in UNARY if name != "exp")


def joined(parts):
    token, a, b = parts
    return (*a, *b, token)


LEAVES = st.sampled_from([*FIELDS, *CONSTANTS, "2"]).map(lambda name: (name,))
PROGRAMS = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(TAME)).map(lambda x: (*x[0], x[1])),
        inner.map(lambda x: (*x, "tanh", "exp")),
        st.tuples(st.sampled_from(("+", "-", "*")), inner, inner).map(joined),
    ),
    max_leaves=5,
).filter(lambda p: len(p) <= 24 and stack_depth(p) <= DEPTH)


def draw_values(seed: int, rows: int = 7) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    values = {name: rng.normal(size=rows) for name in FIELDS}
    return values | {name: rng.uniform(0.3, 2.0) for name in CONSTANTS}


@settings(max_examples=40, deadline=None)
@given(st.lists(PROGRAMS, min_size=1, max_size=5), st.integers(0, 1000))
def test_the_stack_machine_is_numpy(programs, seed):
    values = draw_values(seed)
    length = max(length_for(len(p)) for p in programs)
    codes = encode(programs, FIELDS, [CONSTANTS] * len(programs), length)
    constants = np.tile([values[name] for name in CONSTANTS], (len(programs), 1))
    rows = np.stack([values[name] for name in FIELDS])
    told = np.asarray(run_many(codes, constants, rows))
    for own, program in zip(told, programs, strict=True):
        direct = np.broadcast_to(evaluate(program, values, np), 7)
        np.testing.assert_allclose(own, direct, rtol=1e-9, atol=1e-9)


@settings(max_examples=60, deadline=None)
@given(PROGRAMS, st.integers(0, 1000))
def test_what_is_printed_is_what_is_evaluated(program, seed):
    values = draw_values(seed)
    names = {**values, "sign": lambda x: values["direction"], "abs": np.abs}
    names |= {name: getattr(np, name) for name in ("sin", "cos", "exp", "tanh")}
    names["sat"] = lambda x: np.clip(x, -1, 1)
    names["max"] = np.maximum
    names["root"] = lambda x: x / np.sqrt(np.abs(x) + 1e-12)
    text = infix(program).replace("^", "**")
    expected = np.broadcast_to(evaluate(program, values, np), 7)
    np.testing.assert_allclose(np.broadcast_to(eval(text, names), 7), expected, rtol=1e-9)
    sample = make_sample(**{name: jnp.asarray(values[name]) for name in FIELDS})
    again = eval(python(program), {"p": values, "s": sample, "jnp": jnp})
    np.testing.assert_allclose(np.broadcast_to(again, 7), expected, rtol=1e-9)


@pytest.mark.parametrize(
    "program", [(), ("q", "q"), ("q", "+"), ("sin",), ("q", "__import__"), ("q",) * 80, ("x",)]
)
def test_what_is_no_program_is_refused(program):
    with pytest.raises(ValueError):
        check_program(program, CONSTANTS)


def magnet() -> Formula:
    table = (
        Parameter("a", "N m/rad", -1e6, 1e6, True, 8.0, "factor"),
        Parameter("s", "rad", 0.01, 10.0, False, 0.3, "width", "log"),
    )
    program = ("q", "q", "s", "/", "square", "neg", "exp", "*")
    return Formula((program,), table, (("q", -1.0, 1.0),))


def test_a_formula_keeps_the_contract_of_a_law():
    law = formula_law(magnet())
    check_effect(law)
    assert law is formula_law(magnet()), "equal formulas are one law, compiled once"
    assert (law.summary, law.shown_against, law.scope) == ("a*q*exp(-(q/s)^2)", "position", "joint")


def test_a_formula_comes_back_from_json():
    formula = magnet()
    assert from_json(json.loads(json.dumps(to_json(formula)))) == formula


DAMAGE = {
    "an unknown token": lambda c: c["terms"][0].append("import os"),
    "a missing operand": lambda c: c["terms"][0].append("+"),
    "a constant nobody states": lambda c: c["parameters"].pop(),
    "bounds the wrong way round": lambda c: c["parameters"][1].update(lower=11.0),
    "a number that is none": lambda c: c["parameters"][1].update(nominal=float("nan")),
    "a scale that is none": lambda c: c["parameters"][1].update(scale="cubic"),
    "a name that is code": lambda c: c["parameters"][0].update(name="a;b"),
    "nothing": lambda c: c.clear(),
}


@pytest.mark.parametrize("damage", sorted(DAMAGE))
def test_a_damaged_formula_is_refused(damage):
    content = json.loads(json.dumps(to_json(magnet())))
    DAMAGE[damage](content)
    with pytest.raises(ValueError):
        from_json(content)


def test_units_of_a_law_by_hand():
    inner = {"k": {"s": 1, "rad": -2}, "s": {"rad": 1, "s": -1}}
    assert unit_of(("q", "dq", "*", "k", "*", "sin", "load", "*"), inner) == {"N m": 1}
    assert unit_text(unit_of(("ddq", "q", "square", "*"), {})) == "rad^3/s^2"
    with pytest.raises(ValueError, match="no pure number"):
        unit_of(("dq", "sin"), {})
    with pytest.raises(ValueError, match="are added"):
        unit_of(("q", "dq", "+"), {})


@settings(max_examples=50, deadline=None)
@given(st.dictionaries(st.sampled_from(["N m", "rad", "s", "K"]), st.integers(-3, 3), max_size=4))
def test_units_are_written_and_read(powers):
    unit = times({}, powers)
    assert parse_unit(unit_text(unit)) == unit
    if abs(unit.get("N m", 1)) == 1:
        check_unit(unit_text(unit))


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_shapes_of_known_laws_are_their_columns(name):
    law = REGISTRY[name]
    rng = np.random.default_rng(3)
    series = make_sample(
        **{f: jnp.asarray(rng.uniform(0.2, 2.0, 40)) for f in FIELD_UNITS if f != "direction"},
        direction=jnp.asarray(rng.choice([-1.0, 1.0], 40)),
    )
    series = series._replace(static_load=series.load)  # a law may take a part of the inertial load
    nonlinear = {p.name: p.nominal for p in law.nonlinear}
    columns = np.asarray(law_columns(law, nonlinear, series))
    # Scales of a shape stand for those of the law, whatever their names; exponents are at their usual values.
    scales = [p.nominal for p in law.nonlinear]
    base = [np.ones(40), np.asarray(series.direction), np.asarray(series.dq)]
    ones = np.stack([*base, *columns.T], axis=1)
    for shape in SHAPES[name]:
        known = {
            **series._asdict(),
            **{n: s for (n, _), s in zip(shape.scales, scales, strict=False)},
        }
        own = np.asarray(evaluate(shape.program, known, jnp))
        left = own - ones @ np.linalg.lstsq(ones, own, rcond=None)[0]
        assert np.linalg.norm(left) < 1e-9 * np.linalg.norm(own), shape


def test_a_formula_differs_by_its_values_alone_as_a_term():
    from jaxswarm.effects.term import Term

    one = Term("discovered", 0, values={"a": 1.0, "s": 0.3}, formula=magnet())
    assert one.law is replace(one, values={"a": 2.0, "s": 0.1}).law
    assert one.label(("j",)) == "discovered@j" and one.columns(("j",)) == ("a_j:discovered",)
    jax.tree.leaves(one.law.torque(one.values, make_sample(q=jnp.asarray(0.1))))
