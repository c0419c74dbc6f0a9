"""A law as data: a sum of postfix programs, each times a constant, made a :class:`TorqueLaw` where it is used.

What was found on a log has no name in the registry. It is carried by its term, written into ``model.json`` as
tokens, and acts everywhere as any other law of a joint does.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from math import isfinite

import jax.numpy as jnp

from jaxswarm.effects.formula_text import infix, latex, latex_name, total
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.postfix import (
    WORDS,
    Program,
    check_program,
    constants_of,
    evaluate,
    fields_of,
)
from jaxswarm.effects.sample import Sample

# What a term is called whose law is no registered one.
DISCOVERED = "discovered"
_PARTNER = ("q_other", "dq_other", "ddq_other")
_SCALES = ("linear", "log")
# Programs of a formula that a file may hold.
_MOST_TERMS = 8


@dataclass(frozen=True)
class Formula:
    """A law of one joint in closed form.

    Attributes:
        terms: Programs, the torque being their sum, each times its own linear constant.
        parameters: The linear constants in the order of the terms, then those inside the programs.
        valid: Names of variables with the least and largest value at which the law was seen.
    """

    terms: tuple[Program, ...]
    parameters: tuple[Parameter, ...]
    valid: tuple[tuple[str, float, float], ...] = ()

    def __post_init__(self) -> None:
        """Refuse what is no formula.

        Raises:
            ValueError: If programs and parameters do not belong together.
        """
        if not 0 < len(self.terms) <= _MOST_TERMS:
            raise ValueError(f"a formula has 1 to {_MOST_TERMS} terms, this one {len(self.terms)}")
        inner = [p.name for p in self.parameters if not p.linear]
        for program in self.terms:
            check_program(program, inner)
        names = [p.name for p in self.parameters]
        if len(set(names)) < len(names) or WORDS & set(names):
            raise ValueError(f"parameters {names} are not different names of their own")
        used = {name for program in self.terms for name in constants_of(program)}
        if [p.linear for p in self.parameters] != [True] * len(self.terms) + [False] * len(inner):
            raise ValueError("a formula has one linear constant a term, before the others")
        if used != set(inner):
            raise ValueError(f"constants {sorted(used)} are used, {sorted(inner)} are stated")

    @property
    def fields(self) -> tuple[str, ...]:
        """Fields of a sample that it reads."""
        found = {name for program in self.terms for name in fields_of(program)}
        return tuple(name for name in Sample._fields if name in found)

    @property
    def couples(self) -> bool:
        """Whether it reads the motion of a partner joint."""
        return any(name in _PARTNER for name in self.fields)

    def torque(self, p: Mapping, s: Sample):
        """Torque [N m or N] of one sample with parameters ``p``, as :class:`TorqueLaw` wants it."""
        known = {**s._asdict(), **p}
        linear = [one.name for one in self.parameters[: len(self.terms)]]
        parts = (
            p[name] * evaluate(term, known, jnp)
            for name, term in zip(linear, self.terms, strict=True)
        )
        return sum(parts, jnp.zeros_like(s.q))

    def text(self, names: Mapping[str, str] | None = None) -> str:
        """The formula in one line, with other names for its fields where given."""
        linear = [one.name for one in self.parameters[: len(self.terms)]]
        return total([infix(term, names) for term in self.terms], linear)

    def latex(self, names: Mapping[str, str] | None = None) -> str:
        """The formula as LaTeX."""
        linear = [latex_name(one.name) for one in self.parameters[: len(self.terms)]]
        return total([latex(term, names) for term in self.terms], linear, r"\,")


@lru_cache(maxsize=1024)
def formula_law(formula: Formula) -> TorqueLaw:
    """The law of a formula: one object for equal formulas, so that it is compiled once.

    >>> b = Parameter("b", "N m s/rad^2", -1e6, 1e6, True, 1.0, "coefficient")
    >>> formula_law(Formula((("q", "dq", "*"),), (b,))).summary
    'b*q*dq'
    """
    fields = formula.fields
    velocity = {"dq", "direction"} & set(fields)
    axis = "velocity" if velocity else "time"
    if "q" in fields and not velocity:
        axis = "position"
    elif not velocity and {"load", "static_load"} & set(fields):
        axis = "load"
    return TorqueLaw(
        name=DISCOVERED,
        scope="pair" if formula.couples else "joint",
        parameters=formula.parameters,
        summary=formula.text(),
        reference="found on the log as a formula",
        torque=formula.torque,
        requires=("temperature",) if "temperature" in fields else (),
        shown_against=axis,
        uses_direction="direction" in fields,
        uses_load=bool({"load", "static_load"} & set(fields)),
    )


def to_json(formula: Formula) -> dict:
    """The formula as ``model.json`` holds it."""
    return {
        "text": formula.text(),
        "terms": [list(program) for program in formula.terms],
        "parameters": [
            {k: v for k, v in asdict(p).items() if k in _KEPT} for p in formula.parameters
        ],
        "valid": [list(item) for item in formula.valid],
    }


_KEPT = ("name", "unit", "lower", "upper", "linear", "nominal", "description", "scale")


def from_json(content: dict) -> Formula:
    """Read what :func:`to_json` wrote.

    Raises:
        ValueError: If it is no formula; nothing of it is run as code.
    """
    try:
        terms = tuple(tuple(program) for program in content["terms"])
        parameters = tuple(Parameter(**{k: p[k] for k in _KEPT}) for p in content["parameters"])
        valid = tuple((str(n), float(low), float(high)) for n, low, high in content["valid"])
    except (KeyError, TypeError) as error:
        raise ValueError(f"formula is incomplete or damaged ({error!r})") from None
    for p in parameters:
        numbers = (p.lower, p.upper, p.nominal)
        words = (p.name, p.unit, p.description)
        sound = all(isinstance(x, int | float) and isfinite(x) for x in numbers)
        sound = sound and all(isinstance(w, str) for w in words) and p.name.isidentifier()
        if not sound or p.scale not in _SCALES or not isinstance(p.linear, bool):
            raise ValueError(f"parameter {p.name!r} of a formula is damaged")
    formula = Formula(terms, parameters, valid)
    formula_law(formula).check()
    return formula


def with_values(formula: Formula, values: Mapping[str, float]) -> Formula:
    """The formula whose nominal values are the given ones."""
    table = tuple(replace(p, nominal=float(values[p.name])) for p in formula.parameters)
    return replace(formula, parameters=table)
