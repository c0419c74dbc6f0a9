r"""What the current model can absorb, on every fold, where candidates are tried.

A candidate may be credited only with what the model cannot do without it. With the weighted columns of the
training rows factored as :math:`W_A = Q R` and :math:`P = W R^{-1}` on all rows, a candidate's column c
keeps

.. math:: c_\perp = c - P\,(Q^T c_A),

its part that the refitted model cannot imitate, on the rows it was fitted to and on those it was not.
Blocks of time alternate between two folds; each is scored by the fit to the other. Rows are weighted by
the joint's noise (median absolute deviation, so that rare large residuals do not count as noise) and the
few beyond four times it are bounded in their influence (P. J. Huber, Ann. Math. Stat. 35 (1964)): an
impact or an outlier must not decide what a joint lacks.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import scipy

from jaxswarm.diagnose.folds.bends import bends
from jaxswarm.diagnose.folds.blocks import blocks_of
from jaxswarm.diagnose.folds.noise import event_doubt, row_doubt, row_weight
from jaxswarm.identify.estimation.covariance import correlation_length
from jaxswarm.identify.estimation.estimate import Estimate


@dataclass(frozen=True)
class Fold:
    """The model fitted to a part of the rows.

    Attributes:
        train: Rows it was fitted to, shape (T,).
        project: P, shape (T, n, b).
        basis: Q on the training rows and zeros elsewhere, shape (T, n, b).
        residual: Weighted residual of all rows, shape (T, n).
        solve: From coordinates in the basis to base parameters, shape (b', b).
        values: Base parameters of the fit, shape (b',).
    """

    train: np.ndarray
    project: np.ndarray
    basis: np.ndarray
    residual: np.ndarray
    solve: np.ndarray
    values: np.ndarray

    def absorbed(self, torque: np.ndarray) -> np.ndarray:
        """Change of the base parameters (b',) by which the model takes up a weighted torque (T, n)."""
        return self.solve @ np.einsum("tjb,tj->b", self.basis, torque)

    def free_part(self, columns: np.ndarray) -> np.ndarray:
        """c_perp of weighted columns (T, n, k)."""
        rows = len(columns) * columns.shape[1]
        held = self.project.reshape(rows, -1) @ self._held(columns)
        return columns - held.reshape(columns.shape)

    def _held(self, columns: np.ndarray) -> np.ndarray:
        """Coordinates (b, k) in the basis of what the model holds of weighted columns (T, n, k)."""
        rows = columns.reshape(-1, columns.shape[2])
        return self.basis.reshape(len(rows), -1).T @ rows

    def free_rows(self, own: np.ndarray, joint: int) -> np.ndarray:
        """The joint's rows (T, k) of c_perp, of weighted columns (T, k) that act on this joint alone."""
        return own - self.project[:, joint] @ (self.basis[:, joint].T @ own)

    def trained_on(self, rows: np.ndarray) -> "Fold":
        """The same model fitted to other rows, (T,), at the same weights."""
        own = _fold(self.project, self.residual, rows, self.project.shape[2])
        values = self.values + self.solve @ own.values
        return replace(own, solve=self.solve @ own.solve, values=values)

    def with_columns(self, columns: np.ndarray, known: bool = False) -> "Fold":
        """The same rows fitted by a model that has further weighted columns (T, n, k).

        ``known``: their coefficients are known to be zero within one, standard deviation.
        """
        more = _fold(self.free_part(columns), self.residual, self.train, columns.shape[2], known)
        # Beside a further column the base parameters give back what they hold of it.
        beside = -self.solve @ self._held(columns)
        return Fold(
            self.train,
            np.concatenate([self.project, more.project], axis=2),
            np.concatenate([self.basis, more.basis], axis=2),
            more.residual,
            np.concatenate([self.solve, beside @ more.solve], axis=1),
            self.values + beside @ more.values,
        )


@dataclass(frozen=True)
class CrossFit:
    """All folds of a model.

    Attributes:
        weight: What every row and joint is multiplied by, shape (T, n).
        log: Log of every row, shape (T,).
        block: Block of every row, shape (T,).
        whole: The fit to all rows.
        halves: The two fits to alternating blocks.
        effective: Independent residuals in the data.
        noise: Standard deviation of the noise but for what is sharp, (n,).
        quiet: The same of the rows that count most, (n,).
        size: RMS of the torque, (n,).
        timing: Part of the weights that the times of jumps leave events, (T, n).
        structure: What :mod:`jaxswarm.diagnose.decision.unexplained` found on it, by seed and joint.
    """

    weight: np.ndarray
    log: np.ndarray
    block: np.ndarray
    whole: Fold
    halves: tuple[Fold, Fold]
    effective: float
    noise: np.ndarray
    quiet: np.ndarray
    size: np.ndarray
    timing: np.ndarray
    structure: dict = field(default_factory=dict, repr=False, compare=False)

    @property
    def folds(self) -> tuple[Fold, ...]:
        """Whole, then the two halves."""
        return (self.whole, *self.halves)

    def with_columns(self, columns: tuple[np.ndarray, ...], known: bool = False) -> "CrossFit":
        """The folds of a model that has further weighted columns, given for every fold.

        ``known``: their coefficients are known to be zero within one, standard deviation.
        """
        more = zip(self.folds, columns, strict=True)
        whole, one, two = (fold.with_columns(c, known) for fold, c in more)
        return replace(self, whole=whole, halves=(one, two), structure={})

    def weigh(self, columns: np.ndarray) -> np.ndarray:
        """Columns (T, n, k) in units of the noise."""
        return columns * self.weight[:, :, None]


def cross_fit(
    found: Estimate,
    frozen: bool = False,
    doubt_of: Callable[[Estimate], np.ndarray] = row_doubt,
) -> CrossFit:
    """Factor the current model on all rows and on both halves.

    Args:
        found: The current model.
        frozen: Whether the model is not refitted (diagnosis against an earlier model): then it
            absorbs nothing.
        doubt_of: The noise of every row (T', n) by which it counts.
    """
    regression, solution = found.regression, found.fit
    doubt = doubt_of(found)
    own = row_weight(found, doubt)
    weight = own * regression.shares
    columns = regression.columns[:, :, solution.base.kept]
    size = columns.shape[2]
    # What the regression holds is already multiplied by how much a row counts.
    columns = columns[:, :, : 0 if frozen else size] * own[:, :, None]
    error = solution.residual * own
    torque = error if frozen else regression.target * own
    length = correlation_length(error, regression.log)
    block = blocks_of(found)
    everything = np.ones(len(torque), dtype=bool)
    odd = block % 2 == 1
    folds = [_fold(columns, torque, rows, size) for rows in (everything, odd, ~odd)]
    if not frozen and (slopes := bends(found)).shape[2]:
        # What widths and times take up is no change of the base parameters.
        slopes = slopes * weight[:, :, None]
        folds = [fold.with_columns(slopes, known=True) for fold in folds]
    whole, halves = folds[0], (folds[1], folds[2])
    # Rows that are bounded already count for no less.
    timing = 1.0 / np.maximum(1.0, weight * event_doubt(found))
    rows = (weight, regression.log, block, whole, halves, error.size / length)
    noise = regression.rms(regression.counted(doubt)), doubt.min(axis=0)
    return CrossFit(*rows, *noise, regression.rms(regression.torque), timing)


def _fold(
    columns: np.ndarray,
    torque: np.ndarray,
    train: np.ndarray,
    parameters: int,
    known: bool = False,
) -> Fold:
    """A fold of weighted columns (T, n, k) of so many base parameters; k is zero if those are held.

    ``known``: each coefficient has been seen once, as zero with a standard deviation of one.
    """
    joints, size = columns.shape[1:]
    if size == 0:
        solve = np.zeros((parameters, 0))
        return Fold(train, columns, columns, torque, solve, np.zeros(parameters))
    rows = columns[train].reshape(-1, size)
    if known:
        rows = np.concatenate([rows, np.eye(size)])
    scale = np.maximum(np.linalg.norm(rows, axis=0), 1e-300)
    # Nobody asks for Q, which costs as much again in time and memory.
    _, r, order = scipy.linalg.qr(
        rows / scale, mode="raw", pivoting=True, check_finite=False, overwrite_a=True
    )
    rank = int((np.abs(np.diag(r)) > 1e-7 * abs(r[0, 0])).sum())
    if rank == 0:
        # Columns that are zero, as of friction that nobody declared, take up nothing.
        return _fold(columns[:, :, :0], torque, train, size)
    pick = order[:rank]
    project = scipy.linalg.solve_triangular(
        r[:rank, :rank],
        (columns[:, :, pick] / scale[pick]).reshape(-1, rank).T,
        trans="T",
        check_finite=False,
    ).T.reshape(len(columns), joints, rank)
    basis = project if train.all() else np.where(train[:, None, None], project, 0.0)
    solve = np.zeros((size, rank))
    solve[pick] = scipy.linalg.solve_triangular(r[:rank, :rank], np.eye(rank)) / scale[pick, None]
    told = np.einsum("tjb,tj->b", basis, torque)
    return Fold(train, project, basis, torque - project @ told, solve, solve @ told)
