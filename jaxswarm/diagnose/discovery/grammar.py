"""Programs that are tried: products of pieces over different variables, and functions of products.

Enumerated and not drawn: everything up to three factors and three inner constants, a few thousand programs of
one joint, so that what is found does not hang on luck. The shapes of known laws stand among them, alone and
times one more factor, so that a bent known law is found as such.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain, combinations
from itertools import product as pairs

import numpy as np

from jaxswarm.diagnose.discovery import devices
from jaxswarm.diagnose.discovery import pieces as p
from jaxswarm.diagnose.discovery.machine import DEPTH, LENGTHS, stack_depth
from jaxswarm.diagnose.discovery.pieces import Piece, product
from jaxswarm.effects.dimensions import Unit, times
from jaxswarm.effects.postfix import BINARY, UNARY, WORDS, Program, evaluate
from jaxswarm.effects.shapes import SHAPES

# Inner constants of one program: more are not told by one residual.
MOST_CONSTANTS = 3
# What stands for the motion of the partner joint, and how the two are added.
_SUMS: tuple[Program, ...] = (("q", "q_other", "+"), ("q", "q_other", "-"))
_ALONE, _WITH_SUMS = {"+", "-"}, {"dq", "ddq"}
_PAIRED = ("q", "dq", "ddq", "load", "q_other", "dq_other")


def programs(
    data: Mapping[str, np.ndarray], units: Mapping[str, Unit], angles: bool
) -> list[Piece]:
    """Every program over the fields that are given, without repetition.

    Args:
        data: Field of a sample to its values on the rows, (T,).
        units: Unit of every field.
        angles: Whether positions are angles: only those have a sine by themselves.
    """
    groups = _groups(data, units, angles)
    found = [*_seeds(data, units, groups)]
    found += [one for members in groups.values() for one in members]
    found += _of_one_variable(groups)
    for one, two in combinations(groups, 2):
        if not (set(one.split()) | set(two.split())) & _ALONE or {one, two} & _WITH_SUMS:
            found += [product(*own) for own in pairs(groups[one], groups[two])]
    for three in combinations([name for name in groups if " " not in name], 3):
        found += [product(*own) for own in pairs(*(groups[n] for n in three)) if _plain(own)]
    found += _composed(data, units)
    found += _devices(data, units, angles)
    kept: dict[tuple, Piece] = {}
    for piece in found:
        fits = len(piece.program) <= LENGTHS[-1] and stack_depth(piece.program) <= DEPTH
        if fits and len(piece.constants) <= MOST_CONSTANTS:
            kept.setdefault(skeleton(piece.program), piece)
    return list(kept.values())


def skeleton(program: Program) -> tuple[Program, ...]:
    """The factors of a program in a fixed order, their constants without numbers: what makes two the same.

    >>> skeleton(("q", "k2", "*", "sin", "dq", "*")) == skeleton(("dq", "q", "k", "*", "sin", "*"))
    True
    """
    plain = (token if token in WORDS else token.rstrip("0123456789") for token in program)
    return tuple(sorted(factors(tuple(plain))))


def _of_one_variable(groups: Mapping[str, Sequence[Piece]]) -> Iterator[Piece]:
    """Products of two shapes over one position, alone and with the direction: magnets, cams, stops."""
    for name in ("q", "q_other"):
        for own in combinations(groups.get(name, ()), 2):
            yield product(*own)
            if "dq" in groups:
                yield product(*own, Piece(("direction",)))


def _devices(
    data: Mapping[str, np.ndarray], units: Mapping[str, Unit], angles: bool
) -> Iterator[Piece]:
    """Mechanisms on one position, alone and with the direction; and on two in an unknown ratio."""
    for name in [n for n in ("q", "q_other") if n in data]:
        for piece in devices.of_devices((name,), p.range_of(data[name]), units[name], angles):
            yield piece
            if "dq" in data:
                yield product(piece, Piece(("direction",)))
    if {"q", "q_other"} <= set(data) and units["q"] == units["q_other"]:
        around = p.range_of(data["q"] - data["q_other"])
        yield from devices.of_ratio(around, units["q"], angles)


def _plain(own: Sequence[Piece]) -> bool:
    """Whether three factors are short enough to be tried: one of them with a constant at most."""
    tokens = sorted(len(one.program) for one in own)
    return tokens[1] <= 2 and sum(bool(one.constants) for one in own) <= 1


def _groups(
    data: Mapping[str, np.ndarray], units: Mapping[str, Unit], angles: bool
) -> dict[str, list[Piece]]:
    """Pieces by the variable they are functions of."""
    makers: dict[str, Callable[..., Iterable[Piece]]] = {
        "q": lambda x, around, unit: chain(
            p.of_position(x, around, unit, angles), p.of_span(x, around, unit)
        ),
        "dq": lambda x, around, unit: p.of_velocity(x, around, unit, ("direction",)),
        "ddq": lambda x, *_: [Piece(x)],
        "load": p.of_load,
        "static_load": p.of_load,
        "t": p.of_time,
        "temperature": p.of_time,
        "q_other": lambda x, around, unit: p.of_position(x, around, unit, angles),
        "dq_other": lambda x, around, unit: p.of_velocity(x, around, unit, ()),
        "ddq_other": lambda x, *_: [Piece(x)],
    }
    groups = {
        name: list(make((name,), p.range_of(data[name]), units[name]))
        for name, make in makers.items()
        if name in data
    }
    if {"q", "q_other"} <= set(data) and units["q"] == units["q_other"]:
        for total in _SUMS:
            around = p.range_of(evaluate(total, data, np))
            groups[" ".join(total)] = list(p.of_position(total, around, units["q"], angles))
    return groups


def _composed(data: Mapping[str, np.ndarray], units: Mapping[str, Unit]) -> Iterator[Piece]:
    """Functions of a product of two variables, alone, and with the direction or a plain factor."""
    for a, b in combinations([name for name in _PAIRED if name in data], 2):
        both = (a, b, "*")
        around = p.range_of(evaluate(both, data, np))
        for piece in p.of_product(both, around, times(units[a], units[b])):
            yield piece
            for name in ("direction", *_PAIRED):
                if name in data:
                    yield product(piece, Piece((name,)))


def _seeds(
    data: Mapping[str, np.ndarray],
    units: Mapping[str, Unit],
    groups: Mapping[str, Sequence[Piece]],
) -> Iterator[Piece]:
    """Shapes of known laws, alone and times one more factor."""
    for name, shapes in SHAPES.items():
        for shape in shapes:
            if not {t for t in shape.fields} <= set(data):
                continue
            table = tuple(
                p.scale(p.range_of(data[of]), units[of], constant) for constant, of in shape.scales
            )
            seed = Piece(shape.program, table, name)
            yield seed
            for group, members in groups.items():
                if group not in shape.fields:
                    yield from (product(seed, one) for one in members if not one.constants)


def factors(program: Program) -> list[Program]:
    """The factors of a program's outermost product, in any order of writing.

    >>> factors(("q", "sin", "dq", "*", "direction", "*"))
    [('q', 'sin'), ('dq',), ('direction',)]
    """
    stack: list[list[Program]] = []
    for token in program:
        if token == "*":
            b, a = stack.pop(), stack.pop()
            stack.append([*a, *b])
        elif token in BINARY:
            b, a = stack.pop(), stack.pop()
            stack.append([(*_joined(a), *_joined(b), token)])
        elif token in UNARY:
            stack.append([(*_joined(stack.pop()), token)])
        else:
            stack.append([(token,)])
    return stack[0]


def _joined(parts: list[Program]) -> Program:
    program = parts[0]
    for part in parts[1:]:
        program = (*program, *part, "*")
    return program
