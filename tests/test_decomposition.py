"""Singular values where divide and conquer does not converge."""

import numpy as np

from jaxswarm.decomposition import thin_svd


def test_a_matrix_is_decomposed_where_divide_and_conquer_fails(monkeypatch):
    """The columns of a sound log of seven joints ended diagnose in "SVD did not converge"."""
    matrix = np.random.default_rng(0).normal(size=(40, 7))
    usual = thin_svd(matrix)

    def fails(*args, **options):
        raise np.linalg.LinAlgError("SVD did not converge")

    monkeypatch.setattr(np.linalg, "svd", fails)
    left, size, right = thin_svd(matrix)
    assert left.shape == (40, 7) and right.shape == (7, 7)
    np.testing.assert_allclose(size, usual[1], rtol=1e-12)
    np.testing.assert_allclose((left * size) @ right, matrix, atol=1e-12)
