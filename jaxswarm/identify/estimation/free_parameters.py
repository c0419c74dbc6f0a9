"""Nonlinear parameters and the sign's width, each moved on [0, 1] on its own scale, with tangents."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from jaxswarm.effects.term import Term

# The output of a loose joint has small steps along its gap: its slope there is that over a wider span.
_DIFFERENCE, _WIDE = 1e-4, 0.02
# Parameters of these warps follow from the data in one linear step and are not searched here.
_NOT_SEARCHED = ("window", "payload")


class Place(NamedTuple):
    """What the columns of a model depend on: terms with nonlinear values, and the widths of the signs."""

    terms: tuple[Term, ...]
    width: tuple[float, ...]


@dataclass(frozen=True)
class FreeParameter:
    """One nonlinear parameter of one term, moved between its bounds by a number in [0, 1].

    Attributes:
        term: Index of the term; None for the width of a joint's sign.
        name: Parameter name.
        lower, upper: Bounds.
        log: Whether it moves on a logarithmic scale.
        stepwise: Whether the model's output has small steps along it.
        joints: Whose signs' width it is; empty for a term's parameter.
    """

    term: int | None
    name: str
    lower: float
    upper: float
    log: bool
    stepwise: bool = False
    joints: tuple[int, ...] = ()

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
    terms: tuple[Term, ...], widths: Sequence[FreeParameter] = ()
) -> list[FreeParameter]:
    """All nonlinear parameters of a model, in order, and the widths that are free.

    A torque averaged over the moment of a strike says nothing of the flank, which then stays as it is.
    """
    own = [
        FreeParameter(k, p.name, p.lower, p.upper, p.scale == "log", term.law.warp == "play")
        for k, term in enumerate(terms)
        if term.law.warp not in _NOT_SEARCHED
        for p in term.law.nonlinear
        if p.fitted and not (p.name == "flank" and term.values.get("blur"))
    ]
    return [*own, *widths]


def width_parameter(joints: Sequence[int], limits: tuple[float, float]) -> FreeParameter:
    """The width that some joints share, within limits."""
    return FreeParameter(None, "width", *limits, True, joints=tuple(joints))


def read(place: Place, moving: list[FreeParameter]) -> np.ndarray:
    """Positions of the free parameters, shape (m,)."""
    values = [
        place.width[k.joints[0]] if k.term is None else place.terms[k.term].values[k.name]
        for k in moving
    ]
    return np.array([free.encode(value) for free, value in zip(moving, values, strict=True)])


def write(place: Place, moving: list[FreeParameter], position: np.ndarray) -> Place:
    """The place with its free parameters at the given positions."""
    changed, width = [dict(t.values) for t in place.terms], list(place.width)
    for free, u in zip(moving, position, strict=True):
        if free.term is None:
            for joint in free.joints:
                width[joint] = free.decode(float(u))
        else:
            changed[free.term][free.name] = free.decode(float(u))
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
