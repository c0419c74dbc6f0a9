"""Singular values of any finite matrix."""

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
