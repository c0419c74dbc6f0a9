"""A declared base that gives way: whether its arm swings, where no step leads to from a base that does not."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.fitted import Fitted
from jaxswarm.identify.estimation.least_squares import weighted_cost
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.forward.finite_columns import Diverged

# Frequencies [Hz] that a swing begins at, and the damping ratio: strongly damped, a swing is told from one a
# third off.
_OFTEN, _DAMPED = (4.0, 6.0, 9.0), 0.15
# What a swing may leave of what a turn by the moment alone leaves: of arms on bases of 5 to 10 Hz it was 0.1 to
# 0.6, where none was seen 0.96.
MOST_LEFT = 0.93


def with_swings(
    declared: Sequence[Term],
    terms: tuple[Term, ...],
    fit: Callable[[tuple[Term, ...]], tuple[Problem, Fitted]],
) -> tuple[Problem, Fitted]:
    """The fit of terms; where a base was declared without a swing, that from one if it leaves far less.

    Args:
        declared: Terms as they were given.
        terms: The same with values to start from.
        fit: Fits terms from their values.
    """
    found = fit(terms)
    swings = [() if set(_swing_of(t)) & set(t.values) else _swing_of(t) for t in declared]
    if not any(swings):
        return found
    here = found[1][0]
    sigma = here.solution.sigma
    least = MOST_LEFT * weighted_cost(here.residual, sigma)
    for often in _OFTEN:
        begun = tuple(_begun(t, swing, often) for t, swing in zip(terms, swings, strict=True))
        try:
            there = fit(begun)
        except Diverged:  # no place to begin at
            continue
        cost = weighted_cost(there[1][0].residual, sigma)
        if cost < least:
            found, least = there, cost
    return found


def _swing_of(term: Term) -> tuple[str, ...]:
    """Names of the frequencies and the damping ratio of a base that may swing; none of any other term."""
    return (term.law.swing or ()) if isinstance(term.law, BodyChange) else ()


def _begun(term: Term, swing: tuple[str, ...], often: float) -> Term:
    """The term with a swing to begin with, if it may have one."""
    values = dict.fromkeys(swing[:-1], often) | dict.fromkeys(swing[-1:], _DAMPED)
    return replace(term, values={**term.values, **values})
