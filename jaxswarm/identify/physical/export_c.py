"""The torques of a model's effects as a C function, translated from the laws themselves.

A law is a function of numbers; tracing it gives its program (a jaxpr) of elementary operations, and each
of these is one C expression. What runs in the controller is therefore the formula that was fitted, for
every registered law, with the identified values written in. The caller gives the motion and, for laws of
load, the torque of the rigid body. Laws with memory take their state and return its rate. Effects that are
no added torque (a soft joint, a delay, a tilted base) are told in the head of the file and left out.
"""

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import count
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.sample import Sample
from jaxswarm.effects.series import remembered
from jaxswarm.effects.term import of_kind
from jaxswarm.errors import InputError
from jaxswarm.robot.model import Robot

_INFIX = {"add": "+", "sub": "-", "mul": "*", "div": "/", "add_any": "+"}
_COMPARED = {"gt": ">", "lt": "<", "ge": ">=", "le": "<=", "eq": "==", "ne": "!="}
_LOGICAL = {"and": "&&", "or": "||"}
_CALLED = {
    **{name: name for name in ("sin", "cos", "tan", "tanh", "sinh", "cosh", "exp", "log", "sqrt")},
    **{name: name for name in ("expm1", "log1p", "floor", "ceil", "asin", "acos", "atan", "pow")},
    **{
        "abs": "fabs",
        "max": "fmax",
        "min": "fmin",
        "atan2": "atan2",
        "round": "rint",
        "erf": "erf",
    },
}
_INNER = ("jit", "pjit", "closed_call", "custom_jvp_call", "custom_vjp_call")
_SAME = ("convert_element_type", "copy", "stop_gradient", "broadcast_in_dim", "squeeze", "reshape")


def c_text(robot: Robot, effects: Iterable[Any], width: Sequence[float]) -> str:
    """The text of a C file that holds one function of the effects of a model.

    Args:
        robot: The robot.
        effects: Terms with values.
        width: Width of every joint's smooth sign [rad/s or m/s], (n,).

    Raises:
        InputError: If a law uses an operation that has no C expression here.
    """
    effects = list(effects)
    torques = of_kind(effects, TorqueLaw)
    left = [e for e in effects if e not in torques]
    states = [e for e in torques if e.law.rate is not None]
    name = re.sub(r"\W", "_", robot.name)
    body: list[str] = []
    used = 0
    for item in torques:
        law, slot = item.law, used if item in states else None
        body += [f"  /* {item.label(robot.joints)}: {law.summary} */"]
        body += _law(item, law.torque, width, slot, [f"tau[{item.joint}] +="])
        if slot is not None:
            used += law.memories
            own = range(slot, used)
            body += _law(item, law.rate, width, slot, [f"rate[{k}] =" for k in own])
            if math.isfinite(law.most):
                places = ", ".join(f"state[{k}]" for k in own)
                body += [
                    f"  /* keep {places} from {-law.most:g} to {law.most:g} after every step */"
                ]
    told = "".join(
        f"\n *   not in this file: {e.label(robot.joints)} ({e.law.summary})" for e in left
    )
    n = robot.num_joints
    return f"""/* Torques of the identified effects of {robot.name}, N m or N at the joint.
 *   joints: {", ".join(robot.joints)}{told}
 * t in s; q, dq, ddq in rad or m; load: torque of the rigid body, static_load: its part without
 * acceleration; temperature in deg C; state and rate: {used} memories of effects. Arrays that no
 * effect uses may be null. sign(x) is tanh(x / width), width {", ".join(f"{w:.6g}" for w in width)}.
 */
#include <math.h>

void {name}_effects(double t, const double *q, const double *dq, const double *ddq,
    const double *load, const double *static_load, const double *temperature,
    const double *state, double *tau, double *rate)
{{
  (void)t; (void)q; (void)dq; (void)ddq; (void)load; (void)static_load; (void)temperature;
  (void)state; (void)rate;
  for (int i = 0; i < {n}; ++i) tau[i] = 0.0;
{chr(10).join(body)}
}}
"""


def _fields(item: Any, width: Sequence[float], slot: int | None) -> dict[str, str]:
    """C expression of every field of a sample."""
    j, other = item.joint, item.other

    def sign(velocity: str) -> str:
        return f"tanh({velocity} / {width[j]:.17g})"

    def both(way: str) -> str:
        return f"dq[{j}]" if other is None else f"(dq[{j}] {way} dq[{other}])"

    return {
        "t": "t",
        **{
            name: f"{name}[{j}]"
            for name in ("q", "dq", "ddq", "load", "static_load", "temperature")
        },
        "direction": sign(f"dq[{j}]"),
        "q_other": "0.0" if other is None else f"q[{other}]",
        "dq_other": "0.0" if other is None else f"dq[{other}]",
        "ddq_other": "0.0" if other is None else f"ddq[{other}]",
        "direction_sum": sign(both("+")),
        "direction_difference": sign(both("-")),
        "state": "0.0" if slot is None else f"state[{slot}]",
    }


def _law(
    item: Any, function, width: Sequence[float], slot: int | None, targets: Sequence[str]
) -> list[str]:
    values = {name: float(value) for name, value in item.values.items()}
    with jax.enable_x64(True):
        sample = Sample(*[jnp.ones(()) for _ in Sample._fields])
        sample = sample._replace(state=remembered(item.law, sample.state))
        program = jax.make_jaxpr(lambda s: jax.tree.map(jnp.asarray, function(values, s)))(sample)
    known: Sample[Any] = Sample(**_fields(item, width, slot))
    if slot is not None and item.law.memories > 1:
        own = range(slot, slot + item.law.memories)
        known = known._replace(state=tuple(f"state[{k}]" for k in own))
    lines: list[str] = []
    counter = count()
    results = _run(program.jaxpr, program.consts, jax.tree.leaves(known), lines, counter)
    told = [f"{target} {one};" for target, one in zip(targets, results, strict=True)]
    return ["  {", *(f"    {line}" for line in (*lines, *told)), "  }"]


def _run(
    jaxpr, consts, arguments: list[str], lines: list[str], counter: Iterator[int]
) -> list[str]:
    """Append the statements of a program and return the expressions of its results."""
    table = dict(zip(jaxpr.invars, arguments, strict=True))
    table |= {v: _literal(c) for v, c in zip(jaxpr.constvars, consts, strict=True)}

    def read(atom) -> str:
        return _literal(atom.val) if hasattr(atom, "val") else table[atom]

    for equation in jaxpr.eqns:
        inputs = [read(v) for v in equation.invars]
        name = equation.primitive.name
        if name in _INNER:
            inner = equation.params.get("jaxpr") or equation.params["call_jaxpr"]
            results = _run(inner.jaxpr, inner.consts, inputs, lines, counter)
            table |= dict(zip(equation.outvars, results, strict=True))
            continue
        text = _expression(name, inputs, equation.params)
        if name not in _SAME:
            variable = f"x{next(counter)}"
            lines.append(f"const double {variable} = {text};")
            text = variable
        table[equation.outvars[0]] = text
    return [read(v) for v in jaxpr.outvars]


def _expression(name: str, inputs: list[str], params: dict) -> str:
    if name in _INFIX:
        return f"{inputs[0]} {_INFIX[name]} {inputs[1]}"
    if name in _COMPARED:
        return f"{inputs[0]} {_COMPARED[name]} {inputs[1]}"
    if name in _LOGICAL:
        return f"{inputs[0]} {_LOGICAL[name]} {inputs[1]}"
    if name in _CALLED:
        return f"{_CALLED[name]}({', '.join(inputs)})"
    if name in _SAME:
        return inputs[0]
    x = inputs[0]
    special = {
        "neg": lambda: f"-{x}",
        "not": lambda: f"!{x}",
        "sign": lambda: f"({x} > 0.0) - ({x} < 0.0)",
        "square": lambda: f"{x} * {x}",
        "integer_pow": lambda: f"pow({x}, {params['y']})",
        "exp2": lambda: f"exp2({x})",
        "rsqrt": lambda: f"1.0 / sqrt({x})",
        "logistic": lambda: f"1.0 / (1.0 + exp(-{x}))",
        "rem": lambda: f"fmod({x}, {inputs[1]})",
        "is_finite": lambda: f"isfinite({x})",
        "clamp": lambda: f"fmin(fmax({inputs[1]}, {x}), {inputs[2]})",
        "select_n": lambda: f"{x} != 0.0 ? {inputs[2]} : {inputs[1]}",
    }
    if name not in special or (name == "select_n" and len(inputs) != 3):
        raise InputError(
            f"a law uses the operation {name}, which has no C expression; write it with elementary "
            "functions, or export yaml"
        )
    return special[name]()


def _literal(value: Any) -> str:
    number = float(np.asarray(value))
    if not np.isfinite(number):
        return "NAN" if np.isnan(number) else "INFINITY" if number > 0 else "(-INFINITY)"
    text = f"{number:.17g}"
    text = text if any(c in text for c in ".en") else f"{text}.0"
    return f"({text})" if number < 0 else text
