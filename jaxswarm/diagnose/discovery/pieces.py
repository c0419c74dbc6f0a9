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


class Piece(NamedTuple):
    """A program with the constants inside it.

    Attributes:
        program: Tokens.
        constants: Their table, with the ranges that are searched.
        based_on: The known law whose shape it is; empty: none.
    """

    program: Program
    constants: tuple[Parameter, ...] = ()
    based_on: str = ""


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


def _width(x: Range, unit: Unit) -> Parameter:
    low, high = (part * (x.high - x.low) for part in _BUMP)
    return Parameter("s", unit_text(unit), low, high, False, _mid(low, high), "width", "log")


def _center(x: Range, unit: Unit) -> Parameter:
    return Parameter(
        "c", unit_text(unit), x.low, x.high, False, 0.5 * (x.low + x.high), "center", "linear"
    )


def _order(x: Range, unit: Unit) -> Parameter:
    low, high = (part / (x.high - x.low) for part in _WAVES)
    text = unit_text(over({}, unit))
    return Parameter("k", text, low, high, False, 0.5 * (low + high), "order", "linear")


def _rate(x: Range, unit: Unit) -> Parameter:
    low, high = (part / (x.high - x.low) for part in _GROWTH)
    return Parameter(
        "k", unit_text(over({}, unit)), low, high, False, _mid(low, high), "rate", "log"
    )


_PHASE = Parameter("p", "1", -np.pi, np.pi, False, 0.0, "phase", "linear")
# How narrow the wells of a wave are: from a plain wave to a tenth of its length.
_NARROW = Parameter("w", "1", 0.3, 10.0, False, 2.0, "narrowness", "log")
# What a partner's position counts for beside the joint's own.
_RATIO = Parameter("r", "1", -3.0, 3.0, False, 1.0, "ratio", "linear")


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
    yield Piece((*x, "k", "*", "p", "+", "sin"), (_order(r, u), _PHASE))
    yield Piece((*x, "s", "/", "square", "neg", "exp"), (scale(r, u),))
    yield Piece((*x, "c", "-", "s", "/", "square", "neg", "exp"), (_center(r, u), _width(r, u)))
    bump = (*x, "c", "-", "s", "/", "square", "neg", "exp")
    yield Piece((*x, "c", "-", *bump, "*"), (_center(r, u), _width(r, u)))
    yield Piece((*x, "c", "-", "s", "/", "tanh"), (_center(r, u), _width(r, u)))
    yield Piece((*x, "c", "-", "s", "/", "sat"), (_center(r, u), _width(r, u)))
    yield Piece((*x, "c", "-", "abs"), (_center(r, u),))
    yield Piece((*x, "c", "-", "cube"), (_center(r, u),))
    yield Piece((*x, "k", "*", "exp"), (_rate(r, u),))
    yield Piece((*x, "k", "*", "neg", "exp"), (_rate(r, u),))
    yield from (Piece(one, (_center(r, u),)) for one in _hinges((*x, "c", "-")))


def _hinges(beyond: Program) -> tuple[Program, Program]:
    """Twice what lies beyond zero, on either side: stops, slack cables, shoes that engage."""
    return (*beyond, "abs", *beyond, "+"), (*beyond, "abs", *beyond, "-")


def of_devices(x: Program, r: Range, u: Unit) -> Iterator[Piece]:
    """What stands by itself: buffers, springs with a play, and magnets.

    The wells of magnets have the tails of a power law; several poles repeat every so many parts of a turn.
    """
    for hinge in _hinges((*x, "c", "-")):
        yield Piece((*hinge, "square"), (_center(r, u),))
        yield Piece((*hinge, "cube"), (_center(r, u),))
    near = (*x, "c", "-", "s", "/")
    yield Piece((*near, *near, "sat", "-"), (_center(r, u), _width(r, u)))
    table = (_center(r, u), _width(r, u))
    for steeper in ((), ("square",), ("cube",)):
        yield Piece((*near, *near, "square", "2", "+", *steeper, "/"), table)
    turned = (*x, "c", "-", "k", "*")
    yield Piece(
        (*turned, "sin", *turned, "cos", "w", "*", "exp", "*"),
        (_center(r, u), _order(r, u), _NARROW),
    )


def of_ratio(r: Range, u: Unit, angle: bool) -> Iterator[Piece]:
    """Shapes over a joint's position with an unknown part of its partner's: belts, cables, differentials."""
    x = ("q", "q_other", "r", "*", "-")
    yield Piece((*x, "square"), (_RATIO,))
    yield Piece((*x, "cube"), (_RATIO,))
    if angle:
        yield Piece((*x, "sin"), (_RATIO,))
        yield Piece((*x, "cos"), (_RATIO,))
    yield Piece((*x, "s", "/", "tanh"), (_RATIO, scale(r, u)))
    yield Piece((*x, "k", "*", "p", "+", "sin"), (_RATIO, _order(r, u), _PHASE))
    yield Piece((*x, "c", "-", "cube"), (_RATIO, _center(r, u)))
    yield Piece((*x, "c", "-", "abs"), (_RATIO, _center(r, u)))
    for hinge in _hinges((*x, "c", "-")):
        yield Piece(hinge, (_RATIO, _center(r, u)))
        yield Piece((*hinge, "square"), (_RATIO, _center(r, u)))


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
    yield Piece((*x, "k", "*", "p", "+", "sin"), (_order(r, u), _PHASE))
    yield Piece((*x, "c", "-", "s", "/", "tanh"), (_center(r, u), _width(r, u)))


def of_product(x: Program, r: Range, u: Unit) -> Iterator[Piece]:
    """Functions of a product of two variables."""
    yield Piece((*x, "k", "*", "sin"), (_order(r, u),))
    yield Piece((*x, "k", "*", "cos"), (_order(r, u),))
    yield Piece((*x, "s", "/", "tanh"), (scale(r, u),))
    yield Piece((*x, "abs"))
    yield Piece((*x, "s", "/", "square", "neg", "exp"), (scale(r, u),))
    yield Piece((*x, "abs", "s", "/", "neg", "exp"), (scale(r, u),))
    yield Piece((*x, "k", "*", "exp"), (_rate(r, u),))


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
