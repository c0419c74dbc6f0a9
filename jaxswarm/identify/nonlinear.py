"""The nonlinear parameters of a model as knobs on [0, 1], each on its own scale, with tangents."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from jaxswarm.identify.terms import Term

_DIFFERENCE = 1e-4
# Parameters of these warps follow from the data in one linear step and are not searched here.
_NOT_SEARCHED = ("window", "payload")


@dataclass(frozen=True)
class Knob:
    """One nonlinear parameter of one term, moved between its bounds by a number in [0, 1].

    Attributes:
        term: Index of the term.
        name: Parameter name.
        lower, upper: Bounds.
        log: Whether it moves on a logarithmic scale.
    """

    term: int
    name: str
    lower: float
    upper: float
    log: bool

    def decode(self, u: float) -> float:
        """Value at position u."""
        if self.log:
            return float(self.lower * (self.upper / self.lower) ** u)
        return float(self.lower + u * (self.upper - self.lower))

    def encode(self, value: float) -> float:
        """Position of a value."""
        if self.log:
            return float(np.log(value / self.lower) / np.log(self.upper / self.lower))
        return float((value - self.lower) / (self.upper - self.lower))

    def slope(self, value: float) -> float:
        """Derivative of the value by the position."""
        if self.log:
            return float(value * np.log(self.upper / self.lower))
        return float(self.upper - self.lower)


def knobs(terms: tuple[Term, ...]) -> list[Knob]:
    """All nonlinear parameters of a model, in order."""
    return [
        Knob(k, p.name, p.lower, p.upper, p.scale == "log")
        for k, term in enumerate(terms)
        if term.law.warp not in _NOT_SEARCHED
        for p in term.law.nonlinear
    ]


def read(terms: tuple[Term, ...], moving: list[Knob]) -> np.ndarray:
    """Positions of the knobs, shape (m,)."""
    return np.array([knob.encode(terms[knob.term].values[knob.name]) for knob in moving])


def write(terms: tuple[Term, ...], moving: list[Knob], position: np.ndarray) -> tuple[Term, ...]:
    """The terms with their knobs at the given positions."""
    changed = [dict(t.values) for t in terms]
    for knob, u in zip(moving, position, strict=True):
        changed[knob.term][knob.name] = knob.decode(float(u))
    return tuple(replace(t, values=v) for t, v in zip(terms, changed, strict=True))


def tangents(
    output: Callable[[tuple[Term, ...]], np.ndarray], terms: tuple[Term, ...], moving: list[Knob]
) -> np.ndarray:
    """Central differences of a model's output (T, n) by its knobs, shape (T, n, m)."""
    here = read(terms, moving)
    slopes = []
    for k in range(len(moving)):
        high, low = here.copy(), here.copy()
        high[k], low[k] = min(1.0, here[k] + _DIFFERENCE), max(0.0, here[k] - _DIFFERENCE)
        rise = output(write(terms, moving, high)) - output(write(terms, moving, low))
        slopes.append(rise / (high[k] - low[k]))
    return np.stack(slopes, axis=2)
