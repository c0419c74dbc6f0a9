"""Least squares of a triangular factor within bounds."""

import numpy as np
import scipy

from jaxswarm.decomposition import lstsq
from jaxswarm.identify.estimation.inequalities import solve_above


def solve(
    factor: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Minimize ``||R theta - z||`` for the triangle ``[R z; 0 rho]`` within bounds.

    Returns:
        The minimizer (b,) and whether each component sits on a bound (b,).
    """
    size = factor.shape[1] - 1
    scale = np.linalg.norm(factor[:size, :size], axis=0)
    # Of a column that is zero in these rows, such as a contact at another time, they say nothing.
    scale[scale == 0] = 1.0
    matrix, target = factor[:size, :size] / scale, factor[:size, size]
    theta = lstsq(matrix, target, rcond=np.finfo(float).eps) / scale
    outside = (theta < lower) | (theta > upper)
    if not outside.any():
        return theta, outside
    bounded = scipy.optimize.lsq_linear(
        matrix, target, (lower * scale, upper * scale), method="bvls"
    )
    theta = np.clip(bounded.x / scale, lower, upper)
    return theta, (theta == lower) | (theta == upper)


def solve_within(
    factor: np.ndarray, lower: np.ndarray, upper: np.ndarray, rows: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """:func:`solve` where ``rows @ theta`` must not be negative either."""
    has_low, has_high = np.isfinite(lower), np.isfinite(upper)
    unit = np.eye(len(lower))
    every = np.concatenate([rows, unit[has_low], -unit[has_high]])
    least = np.concatenate([np.zeros(len(rows)), lower[has_low], -upper[has_high]])
    theta = np.clip(solve_above(factor, every, least), lower, upper)
    return theta, (theta == lower) | (theta == upper)
