"""The pieces that programs are made of: functions of one variable, with the ranges of their constants.

Every constant carries the unit that makes the argument of its function a pure number, and is searched over
the range that the data resolve: a scale between a part of the variable's range and a few times it, an order
of less than three waves over the range, a center within it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jaxswarm.effects.dimensions import Unit, over, unit_text
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.postfix import Program

# Scales, in parts of the largest value of their variable; and of bumps, in parts of its range.
_SCALE, _BUMP = (0.03, 2.0), (0.05, 1.0)
# Radians that the argument of a wave passes over the range of its variable: beyond three waves it is a ripple,
# which the catalog holds; exponents over that range.
_WAVES, _GROWTH = (1.0, 18.0), (0.3, 5.0)

# What the name of a mechanism costs: two tokens more than the wave or the bump of a variable.
NAMED = 10


class Piece(NamedTuple):
    """A program with the constants inside it.

    Attributes:
        program: Tokens.
        constants: Their table, with the ranges that are searched.
        based_on: The known law whose shape it is; empty: none.
        named: Whether it is a mechanism that has a name, whose description is that name: it costs no more than
            :data:`NAMED` tokens, and is refined whatever the survey's few points say of its narrow wells.
    """

    program: Program
    constants: tuple[Parameter, ...] = ()
    based_on: str = ""
    named: bool = False

    @property
    def tokens(self) -> int:
        """Tokens that its description costs."""
        return min(len(self.program), NAMED) if self.named else len(self.program)


class Range(NamedTuple):
    """Of a variable in the data: from, to, and the largest size."""

    low: float
    high: float
    most: float


def range_of(values: np.ndarray) -> Range:
    """The range of a variable, without the outermost hundredth."""
    low, high = np.quantile(values, (0.005, 0.995))
    return Range(float(low), float(high), float(max(abs(low), abs(high), 1e-12)))


def scale(x: Range, unit: Unit, name: str = "s") -> Parameter:
    """A scale by which a variable is divided."""
    low, high = (part * x.most for part in _SCALE)
    return Parameter(name, unit_text(unit), low, high, False, _mid(low, high), "scale", "log")


def _mid(low: float, high: float) -> float:
    return float(np.sqrt(low * high))


def width(x: Range, unit: Unit) -> Parameter:
    """The width of a bump or a step."""
    low, high = (part * (x.high - x.low) for part in _BUMP)
    return Parameter("s", unit_text(unit), low, high, False, _mid(low, high), "width", "log")


def center(x: Range, unit: Unit) -> Parameter:
    """A place within the range of a variable."""
    return Parameter(
        "c", unit_text(unit), x.low, x.high, False, 0.5 * (x.low + x.high), "center", "linear"
    )


def order(x: Range, unit: Unit) -> Parameter:
    """The order of a wave."""
    low, high = (part / (x.high - x.low) for part in _WAVES)
    text = unit_text(over({}, unit))
    return Parameter("k", text, low, high, False, 0.5 * (low + high), "order", "linear")


def rate(x: Range, unit: Unit) -> Parameter:
    """The rate of an exponential growth."""
    low, high = (part / (x.high - x.low) for part in _GROWTH)
    return Parameter(
        "k", unit_text(over({}, unit)), low, high, False, _mid(low, high), "rate", "log"
    )


PHASE = Parameter("p", "1", -np.pi, np.pi, False, 0.0, "phase", "linear")


def of_position(x: Program, r: Range, u: Unit, angle: bool) -> Iterator[Piece]:
    """Shapes over a position, or over a sum of two: what springs, magnets, cams and levers are made of."""
    yield Piece(x)
    yield Piece((*x, "square"))
    yield Piece((*x, "cube"))
    yield Piece((*x, "abs"))
    if angle:
        yield Piece((*x, "sin"))
        yield Piece((*x, "cos"))
        yield Piece((*x, "2", "*", "sin"))
        yield Piece((*x, "2", "*", "cos"))
    yield Piece((*x, "k", "*", "p", "+", "sin"), (order(r, u), PHASE))
    yield Piece((*x, "s", "/", "square", "neg", "exp"), (scale(r, u),))
    yield Piece((*x, "c", "-", "s", "/", "square", "neg", "exp"), (center(r, u), width(r, u)))
    bump = (*x, "c", "-", "s", "/", "square", "neg", "exp")
    yield Piece((*x, "c", "-", *bump, "*"), (center(r, u), width(r, u)))
    yield Piece((*x, "c", "-", "s", "/", "tanh"), (center(r, u), width(r, u)))
    yield Piece((*x, "c", "-", "s", "/", "sat"), (center(r, u), width(r, u)))
    yield Piece((*x, "c", "-", "abs"), (center(r, u),))
    yield Piece((*x, "c", "-", "cube"), (center(r, u),))
    yield Piece((*x, "k", "*", "exp"), (rate(r, u),))
    yield Piece((*x, "k", "*", "neg", "exp"), (rate(r, u),))
    yield from (Piece(one, (center(r, u),)) for one in hinges((*x, "c", "-")))
    if angle:  # what a lever bends or presses, from one side only
        yield from (Piece(one, (center(r, u),)) for one in hinges((*x, "c", "-", "sin")))


def of_span(x: Program, r: Range, u: Unit) -> Iterator[Piece]:
    """What acts over a span of the travel, alike on all of it: a row of magnets, a shoe, a guide.

    Its ends are as wide as a sixth of its half. Two hinges in its place are bent between them, and left 3 % of
    an eddy-current brake that acted between two angles, which was told as a sum of three terms.
    """
    near = (*x, "c", "-", "s", "/")
    yield Piece((*near, "cube", "square", "square", "neg", "exp"), (center(r, u), width(r, u)))


def hinges(beyond: Program) -> tuple[Program, Program]:
    """What lies beyond zero, on either side: stops, slack cables, shoes that engage."""
    return (*beyond, "pos"), (*beyond, "neg", "pos")


def of_velocity(x: Program, r: Range, u: Unit, direction: Program) -> Iterator[Piece]:
    """Shapes over a velocity, with its smooth sign where the model has one."""
    yield Piece(x)
    yield Piece((*x, "abs"))
    yield Piece((*x, "square"))
    yield Piece((*x, "cube"))
    yield Piece((*x, "abs", *x, "*"))
    yield Piece((*x, "s", "/", "tanh"), (scale(r, u),))
    yield Piece((*x, "s", "/", "sat"), (scale(r, u),))
    yield Piece((*x, "s", "/", "square", "neg", "exp"), (scale(r, u),))
    yield Piece((*x, "abs", "s", "/", "neg", "exp"), (scale(r, u),))
    yield Piece((*x, *x, "s", "/", "square", "2", "+", "/"), (scale(r, u),))
    yield Piece((*x, "s", "/", *x, "s", "/", "sat", "-"), (scale(r, u),))
    yield Piece((*x, "square", *x, "cube", "*"))
    if direction:
        yield Piece(direction)
        yield Piece((*x, "s", "/", "square", "neg", "exp", *direction, "*"), (scale(r, u),))
        yield Piece((*x, "abs", "s", "/", "neg", "exp", *direction, "*"), (scale(r, u),))


def of_load(x: Program, r: Range, u: Unit) -> Iterator[Piece]:
    """Shapes over a torque."""
    yield Piece(x)
    yield Piece((*x, "abs"))
    yield Piece((*x, "square"))
    yield Piece((*x, "s", "/", "tanh"), (scale(r, u),))


def of_time(x: Program, r: Range, u: Unit) -> Iterator[Piece]:
    """Shapes over the time since the start, or over a temperature."""
    yield Piece(x)
    yield Piece((*x, "s", "/", "neg", "exp"), (scale(r, u),))
    yield Piece((*x, "k", "*", "p", "+", "sin"), (order(r, u), PHASE))
    yield Piece((*x, "c", "-", "s", "/", "tanh"), (center(r, u), width(r, u)))


def of_product(x: Program, r: Range, u: Unit) -> Iterator[Piece]:
    """Functions of a product of two variables."""
    yield Piece((*x, "k", "*", "sin"), (order(r, u),))
    yield Piece((*x, "k", "*", "cos"), (order(r, u),))
    yield Piece((*x, "s", "/", "tanh"), (scale(r, u),))
    yield Piece((*x, "abs"))
    yield Piece((*x, "s", "/", "square", "neg", "exp"), (scale(r, u),))
    yield Piece((*x, "abs", "s", "/", "neg", "exp"), (scale(r, u),))
    yield Piece((*x, "k", "*", "exp"), (rate(r, u),))


def product(*pieces: Piece) -> Piece:
    """The product of pieces, constants of one name told apart by numbers.

    >>> k = Parameter("k", "1/rad", 0.1, 9.0, False, 1.0, "order")
    >>> product(Piece(("q", "k", "*", "sin"), (k,)), Piece(("dq", "k", "*", "cos"), (k,))).program
    ('q', 'k1', '*', 'sin', 'dq', 'k2', '*', 'cos', '*')
    """
    program: list[str] = []
    for number, one in enumerate(numbered(pieces)):
        program += [*one.program, "*"] if number else one.program
    constants = tuple(p for one in numbered(pieces) for p in one.constants)
    based = next((one.based_on for one in pieces if one.based_on), "")
    return Piece(tuple(program), constants, based)


def numbered(pieces: tuple[Piece, ...]) -> tuple[Piece, ...]:
    """The pieces with constants whose names are told apart by numbers where there are several."""
    roots = [p.name.rstrip("0123456789") for one in pieces for p in one.constants]
    seen: dict[str, int] = {}
    told = []
    for one in pieces:
        names = {}
        for p in one.constants:
            root = p.name.rstrip("0123456789")
            seen[root] = seen.get(root, 0) + 1
            names[p.name] = root if roots.count(root) == 1 else f"{root}{seen[root]}"
        told.append(renamed(one, names))
    return tuple(told)


def renamed(piece: Piece, names: Mapping[str, str]) -> Piece:
    """The piece with other names for its constants."""
    constants = tuple(replace(p, name=names[p.name]) for p in piece.constants)
    return piece._replace(
        program=tuple(names.get(token, token) for token in piece.program), constants=constants
    )
