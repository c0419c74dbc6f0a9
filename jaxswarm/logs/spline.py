"""Splines through samples, not-a-knot at both ends.

As ``scipy.interpolate.make_interp_spline`` has them, to the bit; the package that holds it takes a sixth of the
time of a short command to load, with optimizers and sparse matrices, for what is one banded system.

Reference: C. de Boor, A Practical Guide to Splines, Springer 2001, chapters X and XIII.
"""

from collections.abc import Sequence

import numpy as np
import scipy

# Samples whose splines stand in memory at a time, some ten numbers of each.
_BLOCK = 16_384


def spline_at(
    t: np.ndarray, x: np.ndarray, where: np.ndarray, orders: Sequence[int] = (0,), degree: int = 3
) -> list[np.ndarray]:
    """Derivatives of the spline through samples.

    Args:
        t: (T,), where they were taken, increasing; more of them than the degree.
        x: (T, ...), finite samples.
        where: (S,), increasing; beyond the samples the polynomials at the ends go on.
        orders: Which derivatives, from zero up to the degree.
        degree: Odd: 3 for a cubic spline, 5 for a quintic one.

    Returns:
        (S, ...) of every order.

    >>> t, where = np.array([0.0, 1.0, 2.5, 3.0, 4.0, 6.0]), np.array([-1.0, 0.5, 7.0])
    >>> np.allclose(spline_at(t, t**3, where, (0, 1)), [where**3, 3 * where**2])
    True
    """
    if len(t) <= degree:
        raise ValueError(f"a spline of degree {degree} takes more than {len(t)} samples")
    flat = np.asarray(x, dtype=float).reshape(len(x), -1)
    half = (degree + 1) // 2
    ends = np.full(degree + 1, t[0]), np.full(degree + 1, t[-1])
    knots = np.concatenate([ends[0], t[half : len(t) - half], ends[1]])
    weights = _weights(knots, t, flat, degree)
    found = [np.empty((len(where), flat.shape[1])) for _ in orders]
    for order, values in zip(orders, found, strict=True):
        low, inner, own = degree, knots, weights
        while low > degree - order:
            # A derivative has the next lower degree, and one spline less.
            apart = inner[1 + low : len(own) + low] - inner[1 : len(own)]
            own = low * np.diff(own, axis=0) / apart[:, None]
            low, inner = low - 1, inner[1:-1]
        for start in range(0, len(where), _BLOCK):
            here = where[start : start + _BLOCK]
            place = _stretch(inner, here, low)
            basis = _basis(inner, here, place, low)
            values[start : start + _BLOCK] = sum(
                basis[k][:, None] * own[place - low + k] for k in range(low + 1)
            )
    return [values.reshape(-1, *np.shape(x)[1:]) for values in found]


def _weights(knots: np.ndarray, t: np.ndarray, flat: np.ndarray, degree: int) -> np.ndarray:
    """Weights (T, m) of the splines whose sum goes through samples (T, m)."""
    # Rows as the solver wants them: the first ones are its own.
    bands = np.zeros((3 * degree + 1, len(t)), order="F")
    for start in range(0, len(t), _BLOCK):
        row = np.arange(start, min(start + _BLOCK, len(t)))
        place = _stretch(knots, t[row], degree)
        for k, values in enumerate(_basis(knots, t[row], place, degree)):
            column = place - degree + k
            bands[2 * degree + row - column, column] = values
    *_, weights, failed = scipy.linalg.lapack.dgbsv(degree, degree, bands, flat, overwrite_ab=True)
    if failed:
        raise ValueError("a spline takes samples at times that increase")
    return weights


def _stretch(knots: np.ndarray, where: np.ndarray, degree: int) -> np.ndarray:
    """Number of the knot at which the stretch that holds each place begins, (S,)."""
    place = np.searchsorted(knots, where, side="right") - 1
    return np.clip(place, degree, len(knots) - degree - 2)


def _basis(knots: np.ndarray, where: np.ndarray, place: np.ndarray, degree: int) -> np.ndarray:
    """The splines of a degree that are not zero in the stretches of places, (degree + 1, S)."""
    values = np.ones((1, len(where)))
    for k in range(1, degree + 1):
        wider = np.zeros((k + 1, len(where)))
        for n in range(k):
            left, right = knots[place - k + 1 + n], knots[place + 1 + n]
            share = values[n] / (right - left)
            wider[n] += (right - where) * share
            wider[n + 1] += (where - left) * share
        values = wider
    return values
