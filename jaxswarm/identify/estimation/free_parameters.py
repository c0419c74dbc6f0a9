"""Nonlinear parameters and the sign's width, each moved on [0, 1] on its own scale, with tangents."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from jaxswarm.effects.term import Term

# Half width of a difference, and the wider one along a parameter where the output has small steps.
_DIFFERENCE, _WIDE = 1e-4, 0.02


class Place(NamedTuple):
    """What the columns of a model depend on: terms with nonlinear values, and the width of the sign."""

    terms: tuple[Term, ...]
    width: float


@dataclass(frozen=True)
class FreeParameter:
    """One nonlinear parameter of one term, moved between its bounds by a number in [0, 1].

    Attributes:
        term: Index of the term; None for the width.
        name: Parameter name.
        lower, upper: Bounds.
        log: Whether it moves on a logarithmic scale.
        stepwise: Whether the model's output has small steps along it.
    """

    term: int | None
    name: str
    lower: float
    upper: float
    log: bool
    stepwise: bool = False

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


def free_parameters(
    terms: tuple[Term, ...], width_range: tuple[float, float] | None = None
) -> list[FreeParameter]:
    """All nonlinear parameters of a model, in order, and the width where its range is given."""
    own = [
        FreeParameter(k, p.name, p.lower, p.upper, p.scale == "log", term.law.stepwise)
        for k, term in enumerate(terms)
        for p in term.law.free(term.values)
    ]
    return own if width_range is None else [*own, FreeParameter(None, "width", *width_range, True)]


def read(place: Place, moving: list[FreeParameter]) -> np.ndarray:
    """Positions of the free parameters, shape (m,)."""
    values = [place.width if k.term is None else place.terms[k.term].values[k.name] for k in moving]
    return np.array([free.encode(value) for free, value in zip(moving, values, strict=True)])


def write(place: Place, moving: list[FreeParameter], position: np.ndarray) -> Place:
    """The place with its free parameters at the given positions."""
    changed, width = [dict(t.values) for t in place.terms], place.width
    for free, u in zip(moving, position, strict=True):
        if free.term is None:
            width = free.decode(float(u))
        else:
            changed[free.term][free.name] = free.decode(float(u))
    terms = tuple(replace(t, values=v) for t, v in zip(place.terms, changed, strict=True))
    return Place(terms, width)


def tangents(
    output: Callable[[Place, FreeParameter], np.ndarray],
    place: Place,
    moving: list[FreeParameter],
    wide: bool = False,
) -> np.ndarray:
    """Central differences of a model's output (T, n) by its free parameters, shape (T, n, m).

    ``output`` may leave out what the given parameter does not change.
    ``wide`` looks beyond the steps of a stepwise parameter: for its doubt, not for the way to the minimum.
    """
    here = read(place, moving)
    slopes = []
    for k, free in enumerate(moving):
        high, low = here.copy(), here.copy()
        change = _WIDE if wide and free.stepwise else _DIFFERENCE
        high[k], low[k] = min(1.0, here[k] + change), max(0.0, here[k] - change)
        rise = output(write(place, moving, high), free) - output(write(place, moving, low), free)
        slopes.append(rise / (high[k] - low[k]))
    return np.stack(slopes, axis=2)
