"""Singular values and least squares of any finite matrix."""

import numpy as np
import scipy


def thin_svd(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """U (m, k), the singular values (k,) and V^T (k, n) of a matrix (m, n), k the smaller of both.

    By divide and conquer, as NumPy has it, and by QR iteration where that does not converge, as on the finite
    columns of a sound log of seven joints.

    >>> thin_svd(np.diag([3.0, 2.0]))[1].tolist()
    [3.0, 2.0]
    """
    try:
        return np.linalg.svd(matrix, full_matrices=False)
    except np.linalg.LinAlgError:
        return scipy.linalg.svd(matrix, full_matrices=False, lapack_driver="gesvd")


def lstsq(matrix: np.ndarray, target: np.ndarray, rcond: float | None = None) -> np.ndarray:
    """The x of least norm, (n,) or (n, k), with the least error of ``matrix @ x`` (m, n) from a target.

    By the same two ways. Singular values below ``rcond`` times the largest count as zero; None: those that are
    rounding, for the size of the matrix.

    >>> lstsq(np.array([[1.0], [1.0]]), np.array([1.0, 3.0])).round(9).tolist()
    [2.0]
    """
    try:
        return np.linalg.lstsq(matrix, target, rcond=rcond)[0]
    except np.linalg.LinAlgError:
        least = max(matrix.shape) * np.finfo(float).eps if rcond is None else rcond
        return scipy.linalg.lstsq(matrix, target, cond=least, lapack_driver="gelss")[0]
