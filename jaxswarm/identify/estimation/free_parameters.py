"""Nonlinear parameters and the sign's width, each moved on [0, 1] on its own scale, with tangents."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.term import Term

# Half width of a difference, and the wider one along a parameter where the output has small steps.
_DIFFERENCE, _WIDE = 1e-4, 0.02


class Place(NamedTuple):
    """What the columns of a model depend on: terms with nonlinear values, and the width of the sign."""

    terms: tuple[Term, ...]
    width: float


class FreeParameter(NamedTuple):
    """One nonlinear parameter of one term, or the width of the sign.

    Attributes:
        term: Index of the term; None for the width.
        parameter: With its bounds and its scale.
        stepwise: Whether the model's output has small steps along it.
    """

    term: int | None
    parameter: Parameter
    stepwise: bool = False

    @property
    def name(self) -> str:
        """Name of the parameter."""
        return self.parameter.name


def free_parameters(
    terms: tuple[Term, ...], width_range: tuple[float, float] | None = None
) -> list[FreeParameter]:
    """All nonlinear parameters of a model, in order, and the width where its range is given."""
    own = [
        FreeParameter(k, p, term.law.stepwise)
        for k, term in enumerate(terms)
        for p in term.law.free(term.values)
    ]
    if width_range is None:
        return own
    width = Parameter(
        "width", "rad/s", *width_range, False, width_range[0], "of the smooth sign", "log"
    )
    return [*own, FreeParameter(None, width)]


def read(place: Place, moving: list[FreeParameter]) -> np.ndarray:
    """Positions of the free parameters, shape (m,)."""
    values = [place.width if k.term is None else place.terms[k.term].values[k.name] for k in moving]
    return np.array(
        [free.parameter.encode(value) for free, value in zip(moving, values, strict=True)]
    )


def write(place: Place, moving: list[FreeParameter], position: np.ndarray) -> Place:
    """The place with its free parameters at the given positions."""
    changed, width = [dict(t.values) for t in place.terms], place.width
    for free, u in zip(moving, position, strict=True):
        if free.term is None:
            width = float(free.parameter.decode(float(u)))
        else:
            changed[free.term][free.name] = float(free.parameter.decode(float(u)))
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
