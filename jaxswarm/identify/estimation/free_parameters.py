"""Nonlinear parameters and the sign's width, each moved on [0, 1] on its own scale, with tangents."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.term import Term

# Half width of a difference, and the wider one along a parameter where the output has small steps.
_DIFFERENCE, _WIDE = 1e-4, 0.02


class Place(NamedTuple):
    """What the columns of a model depend on: terms with nonlinear values, and the widths of the signs."""

    terms: tuple[Term, ...]
    width: tuple[float, ...]


def with_values(place: Place, linear: np.ndarray, joints: tuple[str, ...]) -> Place:
    """The place with linear values (p,) in its terms, by which a distorted torque goes."""
    terms, k = [], 0
    for term in place.terms:
        count = len(term.linear_names(joints))
        terms.append(term.with_linear(linear[k : k + count], joints))
        k += count
    return Place(tuple(terms), place.width)


class FreeParameter(NamedTuple):
    """One nonlinear parameter of one term, or the width of some joints' signs.

    Attributes:
        term: Index of the term; None for a width.
        parameter: With its bounds and its scale.
        stepwise: Whether the model's output has small steps along it.
        joints: Whose signs' width it is; empty for a term's parameter.
    """

    term: int | None
    parameter: Parameter
    stepwise: bool = False
    joints: tuple[int, ...] = ()

    @property
    def name(self) -> str:
        """Name of the parameter."""
        return self.parameter.name

    @property
    def lower(self) -> float:
        """Least value."""
        return self.parameter.lower

    @property
    def upper(self) -> float:
        """Largest value."""
        return self.parameter.upper


def free_parameters(
    terms: tuple[Term, ...], widths: Sequence[FreeParameter] = ()
) -> list[FreeParameter]:
    """All nonlinear parameters of a model, in order, and the widths that are free."""
    own = [
        FreeParameter(k, p, term.law.stepwise)
        for k, term in enumerate(terms)
        for p in term.law.free(term.values)
    ]
    return [*own, *widths]


def width_parameter(joints: Sequence[int], limits: tuple[float, float]) -> FreeParameter:
    """The width that some joints share, within limits."""
    width = Parameter("width", "rad/s", *limits, False, limits[0], "of the smooth sign", "log")
    return FreeParameter(None, width, joints=tuple(joints))


def read(place: Place, moving: list[FreeParameter]) -> np.ndarray:
    """Positions of the free parameters, shape (m,)."""
    values = [
        place.width[k.joints[0]] if k.term is None else place.terms[k.term].values[k.name]
        for k in moving
    ]
    return np.array(
        [free.parameter.encode(value) for free, value in zip(moving, values, strict=True)]
    )


def write(place: Place, moving: list[FreeParameter], position: np.ndarray) -> Place:
    """The place with its free parameters at the given positions."""
    changed, width = [dict(t.values) for t in place.terms], list(place.width)
    for free, u in zip(moving, position, strict=True):
        if free.term is None:
            for joint in free.joints:
                width[joint] = float(free.parameter.decode(float(u)))
        else:
            changed[free.term][free.name] = float(free.parameter.decode(float(u)))
    terms = tuple(replace(t, values=v) for t, v in zip(place.terms, changed, strict=True))
    return Place(terms, tuple(width))


def tangents(
    output: Callable[[Place, FreeParameter], np.ndarray],
    place: Place,
    moving: list[FreeParameter],
    wide: bool = False,
) -> np.ndarray:
    """Central differences of a model's output (T, n) by its free parameters, shape (T, n, m).

    ``output`` may leave out what the given parameter does not change. Zero where it is not finite.
    ``wide`` looks beyond the steps of a stepwise parameter: for its doubt, not for the way to the minimum.
    """
    here = read(place, moving)
    slopes = []
    for k, free in enumerate(moving):
        high, low = here.copy(), here.copy()
        change = _WIDE if wide and free.stepwise else _DIFFERENCE
        high[k], low[k] = min(1.0, here[k] + change), max(0.0, here[k] - change)
        rise = output(write(place, moving, high), free) - output(write(place, moving, low), free)
        # Beside a place where the model leaves the finite numbers nothing is known of the slope.
        slopes.append(rise / (high[k] - low[k]) if np.isfinite(rise).all() else np.zeros_like(rise))
    return np.stack(slopes, axis=2)
