"""Programs that are a mechanism as a whole: buffers, plays, magnets, levers, belts; terms that stand together.

No product of pieces makes them, or only one that is found late; each is a law by itself, or times a direction.
What reaches over two joints and has more constants than a program of the survey is in
:mod:`jaxswarm.diagnose.discovery.cables`.
"""

from collections.abc import Container, Iterator

from jaxswarm.diagnose.discovery.pieces import (
    PHASE,
    Piece,
    Range,
    center,
    hinges,
    order,
    rate,
    scale,
    width,
)
from jaxswarm.effects.dimensions import Unit
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.postfix import Program, fields_of

# How narrow the wells of a wave are: from a plain wave to a tenth of its length.
_NARROW = Parameter("w", "1", 0.3, 10.0, False, 2.0, "narrowness", "log")
# What a partner's position counts for beside the joint's own.
_RATIO = Parameter("r", "1", -3.0, 3.0, False, 1.0, "ratio", "linear")


# How much longer than its swing the mean square of a spring's length is, where it hangs between two points.
_LENGTH = Parameter("w", "1", 1.02, 5.0, False, 1.5, "of the length", "log")
# The free length of a cable, on the scale on which that side is from 0.1 to 2.4 long.
_FREE = Parameter("g", "1", 0.8, 20.0, False, 2.0, "two over the free length", "log")


def of_devices(x: Program, r: Range, u: Unit, angle: bool) -> Iterator[Piece]:
    """What stands by itself: buffers, springs with a play, levers on springs, cables, and magnets.

    A ball or a rubber that is pressed holds by the power 3/2 (H. Hertz, 1881). A spring between two points has
    the length of a triangle's side, and a cable pulls from its free length on. The wells of magnets have the
    tails of a power law, poles that of the inverse square and dipoles two powers more; several poles repeat
    every so many parts of a turn. Tendons stiffen by an exponential of their stretch (Y. C. Fung,
    American Journal of Physiology 213 (1967)), on either side of where they hang loose: of one without that
    form three waves of a turn left no more in its range, and 19 times the error of the true law 0.2 rad
    behind it.
    """
    for hinge in hinges((*x, "c", "-")):
        yield Piece((*hinge, "square"), (center(r, u),))
        yield Piece((*hinge, "cube"), (center(r, u),))
        if angle:
            yield Piece((*hinge, *hinge, "root", "*"), (center(r, u),))
    if angle:
        yield Piece(_lever((*x, "p", "+")), (PHASE, _LENGTH), named=True)
        yield Piece(_taut((*x, "p", "+")), (PHASE, _LENGTH, _FREE), named=True)
        for turned in ((*x, "c", "-"), (*x, "c", "-", "2", "*")):
            for program in _poles(turned):
                yield Piece(program, (center(r, u), _LENGTH), named=True)
    both = (*x, "c", "-", "k", "*")
    table = (center(r, u), rate(_half(r), u))
    yield Piece((*both, "exp", *both, "neg", "exp", "-"), table, named=True)
    near = (*x, "c", "-", "s", "/")
    yield Piece((*near, *near, "sat", "-"), (center(r, u), width(r, u)))
    table = (center(r, u), width(r, u))
    for steeper in ((), ("square",), ("cube",)):
        yield Piece((*near, *near, "square", "2", "+", *steeper, "/"), table)
    turned = (*x, "c", "-", "k", "*")
    yield Piece(
        (*turned, "sin", *turned, "cos", "w", "*", "exp", "*"),
        (center(r, u), order(r, u), _NARROW),
    )


def of_ratio(r: Range, u: Unit, angle: bool) -> Iterator[Piece]:
    """Shapes over a joint's position with an unknown part of its partner's: belts, cables, differentials."""
    x = ("q", "q_other", "r", "*", "-")
    yield Piece((*x, "square"), (_RATIO,))
    yield Piece((*x, "cube"), (_RATIO,))
    yield Piece((*x, *x, "s", "/", "square", "2", "+", "*"), (_RATIO, scale(r, u)))
    if angle:
        turned = ("q_other", "r", "*", "q", "+", "p", "+")
        yield Piece(_lever(turned), (_RATIO, PHASE, _LENGTH), named=True)
        yield Piece((*x, "sin"), (_RATIO,))
        yield Piece((*x, "cos"), (_RATIO,))
    yield Piece((*x, "s", "/", "tanh"), (_RATIO, scale(r, u)))
    yield Piece((*x, "k", "*", "p", "+", "sin"), (_RATIO, order(r, u), PHASE))
    yield Piece((*x, "c", "-", "cube"), (_RATIO, center(r, u)))
    yield Piece((*x, "c", "-", "abs"), (_RATIO, center(r, u)))
    for hinge in hinges((*x, "c", "-")):
        yield Piece(hinge, (_RATIO, center(r, u)))
        yield Piece((*hinge, "square"), (_RATIO, center(r, u)))


def _half(r: Range) -> Range:
    return Range(0.5 * r.low, 0.5 * r.high, 0.5 * r.most)


def _lever(turned: Program) -> Program:
    """Torque of a constant pull along the side of a triangle, by the angle opposite to it."""
    return (*turned, "sin", "w", *turned, "cos", "-", "root", "/")


def _taut(turned: Program) -> Program:
    """Torque of a cable along that side, which pulls by what it is longer than its free length."""
    side = (*turned, "cos", "neg", "w", "+", "root")
    return ("g", "2", *side, "/", "-", "pos", *turned, "sin", "*")


def _poles(turned: Program) -> Iterator[Program]:
    """Torque of a pull that falls with the length of that side: by its square, and by its fourth power."""
    square = (*turned, "cos", "neg", "w", "+")
    yield (*turned, "sin", *square, "cube", "root", "/")
    yield (*turned, "sin", *square, "square", *square, "root", "*", "/")


# Terms without constants that are found only together: each alone leaves nearly everything.
_FIFTH = ("dq", "square", "dq", "cube", "*")
_TOGETHER: tuple[tuple[Program, ...], ...] = (
    (("dq", "abs", "dq", "*"), ("dq", "cube")),
    (("dq", "cube"), _FIFTH),
    (("dq", "abs", "dq", "*"), ("dq", "cube"), _FIFTH),
    (("q", "square"), ("q", "cube")),
    (("q", "square"), ("q", "cube"), ("q", "square", "square")),
    (("q", "square"), ("q", "q_other", "*"), ("q_other", "square")),
    (("q_other", "square"), ("q_other", "cube")),
)


# A linkage comes back after a turn, so that its torque is a sum of waves; third ones as cubes of the first. Of
# a spring on the rocker of a four-bar linkage two waves leave 0.48 % of the squared error in regions that were
# not fitted and three 0.005 %, five powers from the square on 18 %, and the best sum of other terms 0.03 %,
# which went wrong right behind the range.
_WAVES: tuple[tuple[Program, ...], ...] = (
    (("q", "sin"), ("q", "cos")),
    (("q", "2", "*", "sin"), ("q", "2", "*", "cos")),
    (("q", "sin", "cube"), ("q", "cos", "cube")),
)


def families(fields: Container[str], angles: bool) -> Iterator[tuple[Piece, ...]]:
    """Sums of powers, as a drag that is odd in the velocity or a spring of two joints is expanded in; of waves.

    Args:
        fields: What programs may read.
        angles: Whether positions are angles: a torque over them comes back after a turn.
    """
    waves = [sum(_WAVES[:most], ()) for most in range(2, len(_WAVES) + 1)] if angles else []
    for programs in (*_TOGETHER, *waves):
        if all(name in fields for program in programs for name in fields_of(program)):
            yield tuple(Piece(program) for program in programs)
