"""Which one or two variables say most of a joint's residual, and whether time is one of them.

A smooth function of time follows whatever moves slowly, also over blocks that it was not fitted to, and one of
states what drifts while they happen to drift: where both say nearly the same, the log does not tell which.
"""

from collections.abc import Callable, Collection, Sequence
from typing import NamedTuple

from jaxswarm.diagnose.decision.rules import (
    SECOND_VARIABLE,
    STRUCTURE,
    STRUCTURE_SIGNIFICANCE,
    TIMED,
)
from jaxswarm.diagnose.decision.smooth_rows import Share, SmoothOf

_TIME = "t"
# What a smooth function is worth, and of what it is one.
Told = tuple[Share, SmoothOf]
Tried = Callable[[SmoothOf], Share]


class Telling(NamedTuple):
    """The variables that say most; where time is one, states that say nearly as much; how many were asked."""

    best: Told
    states: Told | None
    asked: int


def most_telling(tried: Tried, names: Collection[str], own: str) -> Telling:
    """The variables that say most of a joint's residual, a second one only where it adds clearly.

    Args:
        tried: What a smooth function of one or two variables is worth on motion held out.
        names: All variables that vary; at least one.
        own: Name of the joint.
    """
    narrow = [SmoothOf((n,), narrow=True) for n in (f"q_{own}", f"dq_{own}") if n in names]
    singles = _ranked(tried, [*(SmoothOf((n,)) for n in names), *narrow])
    pairs = _ranked(tried, _pairs(singles, names, own))
    best, asked = _best(singles, pairs), len(singles) + len(pairs)
    alone = list(filter(_is_state, singles))
    if _is_state(best) or not alone:
        return Telling(best, None, asked)
    known = {of for _, of in pairs}
    more = _ranked(tried, [of for of in _pairs(alone, names, own) if of not in known])
    states = _best(alone, sorted(filter(_is_state, pairs + more), key=_by_share))
    near = _says_nearly(states[0], best[0], asked + len(more))
    return Telling(best, states if near else None, asked)


def _is_state(item: Told) -> bool:
    """Whether it is no function of time."""
    return _TIME not in item[1].names


def _by_share(item: Told) -> float:
    """What the best comes first by."""
    return -item[0].share


def _ranked(tried: Tried, asked: Sequence[SmoothOf]) -> list[Told]:
    """What each is worth, best first."""
    return sorted(((tried(of), of) for of in asked), key=_by_share)


def _pairs(singles: list[Told], names: Collection[str], own: str) -> list[SmoothOf]:
    """Pairs with each of the three most telling variables, and with the joint's own velocity."""
    telling = list(dict.fromkeys(of.names[0] for _, of in singles))[:3]
    leads = [a for a in dict.fromkeys([*telling, f"dq_{own}"]) if a in names]
    return [SmoothOf((a, b)) for a in leads for b in names if b != a]


def _best(singles: list[Told], pairs: list[Told]) -> Told:
    """The best single variable, or the best pair where that says clearly more."""
    if pairs and pairs[0][0].share > singles[0][0].share + SECOND_VARIABLE:
        return pairs[0]
    return singles[0]


def _says_nearly(states: Share, timed: Share, asked: int) -> bool:
    """Whether states are structure themselves and say nearly what a function of time does, see TIMED."""
    if states.share < STRUCTURE or states.p_value * asked > STRUCTURE_SIGNIFICANCE:
        return False
    left, least = 1.0 - states.share, 1.0 - timed.share
    return states.share >= TIMED * timed.share and least >= TIMED * left
