"""Factors of tall matrices: few rows with their products, all that weighted squares of a log ask for."""

import numpy as np
import scipy

from jaxswarm.identify.forward.regression import Regression

_BLOCK_ROWS = 512


def compress(columns: np.ndarray, torque: np.ndarray) -> np.ndarray:
    """Triangular factor of ``[columns | torque]``: all that weighted quadratic costs need.

    Args:
        columns: Shape (m, p).
        torque: Shape (m,).

    Returns:
        As :func:`narrow_factor`, of the columns and the torque: (min(m, q + 1), p + 1), of q columns that are
        not zero.
    """
    return narrow_factor(np.column_stack([columns, torque]))


def narrow_factor(matrix: np.ndarray) -> np.ndarray:
    """Few rows with the products of a tall matrix (m, p), made of its columns that are not zero.

    A joint feels no link before it and no other joint's friction: of six joints half of all numbers are
    zero, and two thirds of the work of a factor. Upper triangular but for the columns of zeros; the last
    column always counts.

    >>> narrow_factor(np.array([[3.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 0.0, 1.0]])).shape
    (2, 3)
    """
    held = np.asarray(matrix.any(axis=0), bool)
    held[-1] = True
    if held.all():
        return triangular_factor(matrix)
    found = triangular_factor(matrix[:, held])
    rows = np.zeros((len(found), matrix.shape[1]))
    rows[:, held] = found
    return rows


def triangular_factor(matrix: np.ndarray) -> np.ndarray:
    """Triangular factor (min(m, p), p) of a tall matrix (m, p), by blocks of rows that stay in the cache.

    J. Demmel, L. Grigori, M. Hoemmen, J. Langou, SIAM J. Sci. Comput. 34 (2012), section 2. Rows may
    differ in sign from those of one factorization.

    >>> a = np.random.default_rng(0).normal(size=(5000, 3))
    >>> r = triangular_factor(a)
    >>> bool(np.allclose(r.T @ r, a.T @ a)), r.shape
    (True, (3, 3))
    """
    width = matrix.shape[1]
    rows = max(_BLOCK_ROWS, 2 * width)
    whole = len(matrix) // rows * rows
    if whole > rows:
        blocks = np.asarray(np.linalg.qr(matrix[:whole].reshape(-1, rows, width), mode="r"))
        matrix = np.concatenate([blocks.reshape(-1, width), matrix[whole:]])
    return np.asarray(np.linalg.qr(matrix, mode="r"))


def joint_factors(regression: Regression) -> list[np.ndarray]:
    """One factor of ``[W_j | tau_j]`` per joint, so that weights can change for nothing."""
    return [
        compress(regression.columns[:, j], regression.target[:, j])
        for j in range(regression.torque.shape[1])
    ]


def weighted_factor(
    factors: list[np.ndarray], sigma: np.ndarray, prior: np.ndarray | None = None
) -> np.ndarray:
    """Triangular factor of all joints' rows, divided by their standard deviations, and of rows that are zero.

    Args:
        factors: Of every joint, (m_j, p + 1).
        sigma: Standard deviations, (n,).
        prior: Rows that should give zero, to one each, (r, p); None: none.
    """
    stacked = np.concatenate([f / s for f, s in zip(factors, sigma, strict=True)])
    if prior is not None and len(prior):
        stacked = np.concatenate([stacked, np.pad(prior, ((0, 0), (0, 1)))])
    found = scipy.linalg.qr(stacked, mode="r", check_finite=False)[0][: stacked.shape[1]]
    # Rows that hold few of the columns are fewer than these.
    return np.pad(found, ((0, stacked.shape[1] - len(found)), (0, 0)))
