"""Least squares under linear inequalities, as a least-distance problem of the whitened parameters.

C. L. Lawson, R. J. Hanson, Solving Least Squares Problems (1974), chapter 23: problem LSI by way of LDP, which
non-negative least squares solves.
"""

import numpy as np
import scipy


def solve_above(factor: np.ndarray, rows: np.ndarray, least: np.ndarray) -> np.ndarray:
    """Minimize ``||R x - z||`` for the triangle ``[R z; 0 rho]`` where ``rows @ x >= least``.

    Args:
        factor: The triangle, (b or b + 1, b + 1); R regular.
        rows: Shape (m, b).
        least: Shape (m,); the inequalities have to leave some x.

    Returns:
        x (b,).

    >>> triangle = np.array([[1.0, 0.0, -1.0], [0.0, 2.0, 4.0], [0.0, 0.0, 0.5]])
    >>> found = solve_above(triangle, np.array([[1.0, 0.0], [1.0, 1.0]]), np.array([0.5, 0.0]))
    >>> found.round(9).tolist()
    [0.5, 2.0]
    """
    size = factor.shape[1] - 1
    matrix, target = factor[:size, :size], factor[:size, size]
    free = scipy.linalg.solve_triangular(matrix, target)
    # y = R (x - free): the distance from the free minimum, in standard deviations.
    slopes = scipy.linalg.solve_triangular(matrix, rows.T, trans="T").T
    norms = np.linalg.norm(slopes, axis=1)
    seen = norms > 1e-12 * norms.max(initial=0.0)
    slopes, missing = slopes[seen] / norms[seen, None], (least - rows @ free)[seen] / norms[seen]
    unit = max(np.abs(missing).max(initial=0.0), 1e-300)
    dual = np.concatenate([slopes.T, missing[None] / unit])
    last = np.append(np.zeros(size), 1.0)
    weights, _ = scipy.optimize.nnls(dual, last, maxiter=50 * dual.shape[1])
    left = dual @ weights - last
    return free + scipy.linalg.solve_triangular(matrix, -unit * left[:size] / left[size])
