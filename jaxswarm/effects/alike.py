"""Which term of one model is which of another: a fit moves what tells several of a kind apart."""

from collections.abc import Sequence

from jaxswarm.effects.term import Term


def number_of(term: Term, terms: Sequence[Term]) -> int:
    """Where a term stands among the terms of a model that has it, though a fit may have moved its event."""
    return min(_alike(term, terms), key=lambda k: terms[k].apart(term))


def has(term: Term, terms: Sequence[Term]) -> bool:
    """Whether a model has a term, though a fit may have moved its event.

    >>> lag = Term("torque_lag", None, values={"tc": 0.03})
    >>> has(lag, [lag]), has(Term("time_delay", None), [lag])
    (True, False)
    """
    return bool(_alike(term, terms))


def without(term: Term, terms: Sequence[Term]) -> tuple[Term, ...]:
    """The terms of a model that has it but this one."""
    gone = number_of(term, terms)
    return tuple(t for k, t in enumerate(terms) if k != gone)


def lacking(terms: Sequence[Term], others: Sequence[Term]) -> tuple[Term, ...]:
    """The terms that others have no counterpart of, each of which stands for one alone.

    >>> first, second = (Term("torque_ripple", 0, values={"n": n}) for n in (7.0, 9.0))
    >>> spring = Term("joint_spring", 0)
    >>> [t.values for t in lacking((spring, first, second), (spring, second))]
    [{'n': 7.0}]
    """
    left = tuple(terms)
    for other in others:
        if has(other, left):
            left = without(other, left)
    return left


def _alike(term: Term, terms: Sequence[Term]) -> list[int]:
    """Numbers of the terms that are the same but for what a fit moves."""
    same = (term.place, term.formula)
    return [k for k, t in enumerate(terms) if (t.place, t.formula) == same]
