r"""One joint's rows of a fold, and what columns fitted to some of them say of the others.

With P the rows of the model's factor that the fold was fitted to and X those of the columns, the part of X
that the model cannot follow is :math:`X - P S`, :math:`S = P^T X`, and its squares are
:math:`X^T X - S^T (2 - P^T P) S`: nothing as long as the log is written but X itself.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from jaxswarm.diagnose.folds.partial_out import Fold

# Ridge, in units of the mean squared column; less fits the noise of one half and fails on the other.
_RIDGE = 0.03


@dataclass(frozen=True)
class JointRows:
    """The rows of one joint on a fold, those it was fitted to and the others apart.

    Attributes:
        train: Rows it was fitted to, (T,).
        inside, outside: Rows of the model's factor, (T1, b) and (T2, b).
        residual, unseen: Weighted residual of both.
        twice: What is taken off the squares of columns, :math:`2 - P^T P`, (b, b).
        told: What the model's factor says of the residual, (b,).
    """

    train: np.ndarray
    inside: np.ndarray
    outside: np.ndarray
    residual: np.ndarray
    unseen: np.ndarray
    twice: np.ndarray
    told: np.ndarray

    def coefficients(self, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Ridge coefficients (f,) of weighted columns (T1, f), and those of the model's factor (b,)."""
        # Squares are safe here: the ridge bounds the condition number by f / 0.03, some thousands.
        taken = self.inside.T @ columns
        square = columns.T @ columns - taken.T @ (self.twice @ taken)
        held = _RIDGE * np.trace(square) / len(square)
        if held <= 0.0:
            return np.zeros(len(square)), np.zeros(len(taken))
        square[np.diag_indices_from(square)] += held
        right = columns.T @ self.residual - taken.T @ self.told
        whole = scipy.linalg.cho_factor(square, check_finite=False, overwrite_a=True)
        found = scipy.linalg.cho_solve(whole, right, check_finite=False)
        return found, taken @ found

    def predicted(self, inside: np.ndarray, outside: np.ndarray) -> np.ndarray:
        """What columns fitted to the rows inside, (T1, f), say of those outside, (T2, f)."""
        found, taken = self.coefficients(inside)
        return outside @ found - self.outside @ taken


def joint_rows(fold: Fold, joint: int) -> JointRows:
    """The rows of a joint on a fold."""
    known, residual, train = fold.project[:, joint], fold.residual[:, joint], fold.train
    inside = known[train]
    twice = 2.0 * np.eye(inside.shape[1]) - inside.T @ inside
    told = inside.T @ residual[train]
    return JointRows(train, inside, known[~train], residual[train], residual[~train], twice, told)
