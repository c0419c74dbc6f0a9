"""Several torques by the position of one joint: beside which of them another one may be asked.

A joint that goes through few periods of an order leaves room for a series of them, which imitates any law of
its position. Multiples of an order are what a cogging motor has, and no free series. Two bent laws of the
position imitate any, too.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.effects.base import Effect
from jaxswarm.effects.direction import follows_direction
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import ORDER, Unit
from jaxswarm.effects.term import Term
from jaxswarm.logs.motion import Motion

# Periods of an order that its joint goes through at least for any other one to be asked beside it: with less,
# two took the place of a magnet's formula. And for its multiples to be: beside n = 7 through 2.6 periods,
# n = 14 was left at 11 times the noise, while a magnet of 0.15 rad shows one period.
_ANY, _MULTIPLES = 4.0, 2.0
# How far from a multiple, as a part of it, an order may be found: the first is bent until the second is there.
_FROM_MULTIPLE = 0.03


def is_unseen(term: Term, motions: Sequence[Motion]) -> bool:
    """Whether a term is an order of which no whole period is seen: a bend, which any law of the position has.

    On a measured arm that moved its third joint by 0.8 rad a ripple was told of 4.2 +- 1.7 periods a turn.
    """
    return term.law.several and _periods(term, motions) < 1.0


def period(term: Term) -> float:
    """Way of its joint on which waves repeat [rad or m].

    >>> round(period(Term("torque_ripple", 0, values={"n": 5.0})), 3)
    1.257
    """
    return 2.0 * np.pi / _order(term)


def leaves_room(term: Term, motions: Sequence[Motion]) -> bool:
    """Whether a term is one of several orders, and its joint goes through enough of its periods for more."""
    return term.law.several and _periods(term, motions) > _MULTIPLES


def hardly_repeats(term: Term, motions: Sequence[Motion]) -> bool:
    """Whether a term is an order of which too few periods are seen to tell it from a torque at one place.

    Friction that varies with the position is one, too: drag between two angles was told as 1.2 periods of it.
    """
    return _order(term) > 0.0 and _periods(term, motions) <= _MULTIPLES


def strays(term: Term, held: Sequence[Term], motions: Sequence[Motion]) -> bool:
    """Whether a term is no multiple of an order of which its joint shows too few periods for any other."""
    return any(
        t.law is term.law
        and t.joint == term.joint
        and _periods(t, motions) <= _ANY
        and not _is_multiple(_order(term), _order(t))
        for t in held
        if t.law.several
    )


def imitates(term: Term, held: Sequence[Term], motions: Sequence[Motion]) -> bool:
    """Whether a term and one that is held are together a function of their joint's position, and neither a law.

    A cushion at the end of the travel was told as a cubic spring and a ripple of 1.4 periods, which leave
    nothing; without the ripple as a cubic spring and one with a dead zone.
    """
    beside = [t for t in held if t.identity != term.identity and _share_position(t, term)]
    if any(hardly_repeats(t, motions) for t in (term, *beside)):
        return bool(beside)
    return any(all(x.law.searched and not x.law.several for x in (t, term)) for t in beside)


def _share_position(one: Term, two: Term) -> bool:
    """Whether two torques follow the position of one joint; several orders of it are one series."""
    about = _follows_position(one.law) and _follows_position(two.law) and one.joint == two.joint
    return about and not (one.law.several and two.law.several)


def _follows_position(law: Effect) -> bool:
    """Whether a law is a torque by the position of its joint, without a memory and without friction's sign."""
    about = isinstance(law, TorqueLaw) and law.shown_against == "position"
    return about and not follows_direction(law)


def _is_multiple(one: float, other: float) -> bool:
    """Whether one of two orders is a multiple of the other, from the double on.

    >>> _is_multiple(13.8, 7.0), _is_multiple(7.0, 21.2), _is_multiple(7.1, 7.0), _is_multiple(10.5, 7.0)
    (True, True, False, False)
    """
    ratio = max(one, other) / max(min(one, other), 1e-300)
    return ratio > 1.5 and abs(ratio / round(ratio) - 1.0) < _FROM_MULTIPLE


def _order(term: Term) -> float:
    """Periods of a term a turn of its joint, or a meter; zero for what does not repeat."""
    orders = [p for p in term.law.parameters if isinstance(p.unit, Unit) and p.unit == ORDER]
    return max((term.values.get(p.name, 0.0) for p in orders), default=0.0)


def _periods(term: Term, motions: Sequence[Motion]) -> float:
    """Periods of its order that a term's joint goes through, on the log where it goes furthest."""
    way = max(float(np.ptp(m.q[:, term.index])) for m in motions)
    return _order(term) * way / (2.0 * np.pi)
