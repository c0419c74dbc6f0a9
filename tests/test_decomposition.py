"""Singular values and least squares where divide and conquer does not converge."""

from pathlib import Path

import numpy as np
import pytest

import jaxswarm
from jaxswarm.decomposition import lstsq, thin_svd


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


@pytest.mark.parametrize("rcond", [None, 1e-6])
def test_least_squares_are_the_same_where_divide_and_conquer_fails(monkeypatch, rcond):
    """Of full rank, and of one column too few, where the least norm tells which of all is meant."""
    rng = np.random.default_rng(1)
    full, target = rng.normal(size=(40, 5)), rng.normal(size=(40, 2))
    matrices = [full, np.concatenate([full, full[:, :1]], axis=1)]
    usual = [lstsq(m, target, rcond) for m in matrices]

    def fails(*args, **options):
        raise np.linalg.LinAlgError("SVD did not converge in Linear Least Squares")

    monkeypatch.setattr(np.linalg, "lstsq", fails)
    for matrix, expected in zip(matrices, usual, strict=True):
        np.testing.assert_allclose(lstsq(matrix, target, rcond), expected, atol=1e-12)


def test_what_decides_on_a_log_decomposes_nowhere_else():
    """A call of NumPy's own, somewhere in the package, ends a sound log again."""
    package = Path(jaxswarm.__file__).parent
    studies, here = package / "studies", package / "decomposition.py"
    for path in package.rglob("*.py"):
        if path != here and studies not in path.parents:
            text = path.read_text()
            assert "np.linalg.svd(" not in text and ".linalg.lstsq(" not in text, path
