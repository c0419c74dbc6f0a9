"""Shapes of known laws as programs: where a search for formulas starts, and how a bent known law is told.

Only laws without memory that are no plain power of one variable; each shape is what one linear parameter
multiplies.
"""

from typing import NamedTuple

from jaxswarm.effects.postfix import Program, fields_of


class Shape(NamedTuple):
    """One column of a known law.

    Attributes:
        program: Tokens.
        scales: Its inner constants, each with the field it is a scale of.
    """

    program: Program
    scales: tuple[tuple[str, str], ...] = ()

    @property
    def fields(self) -> tuple[str, ...]:
        """Fields of a sample that it reads."""
        return fields_of(self.program)


_FALL = ("dq", "s", "/", "square", "neg", "exp", "direction", "*")
SHAPES: dict[str, tuple[Shape, ...]] = {
    "viscous_friction": (Shape(("dq",)),),
    "coulomb_friction": (Shape(("direction",)),),
    "stribeck_friction": (Shape(_FALL, (("s", "dq"),)),),
    "quadratic_drag": (Shape(("dq", "abs", "dq", "*")),),
    "load_dependent_friction": (
        Shape(("load", "abs", "direction", "*")),
        Shape(("static_load", "abs", "direction", "*")),
    ),
    "thermal_drift": (Shape(("t", "s", "/", "neg", "exp", "direction", "*"), (("s", "t"),)),),
    "offset_drift": (Shape(("t", "s", "/", "neg", "exp"), (("s", "t"),)),),
    "temperature_friction": (
        Shape(("temperature", "direction", "*")),
        Shape(("temperature", "dq", "*")),
    ),
    "rotor_inertia": (Shape(("ddq",)),),
    "joint_spring": (Shape(("q",)),),
    "transmission_coupling": (Shape(("dq_other",)), Shape(("ddq_other",))),
    "cable_coupling": (Shape(("q_other",)),),
}
