r"""One joint's rows of a fold, and what columns fitted to some of them say of the others.

With P the rows of the model's factor that the fold was fitted to and X those of the columns, the part of X
that the model cannot follow is :math:`X - P S`, :math:`S = P^T X`, and its squares are
:math:`X^T X - S^T (2 - P^T P) S`: nothing as long as the log is written but X itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from jaxswarm.diagnose.folds.partial_out import Fold

# Ridges that are tried, in units of the mean squared column. Less than the first fits the noise of one half and
# fails on the other where the residual is near it; where it is far from it, the first hides a function of the
# velocity from which all usual friction is taken away: of a brake left at 5 times the noise as a drag they
# found -0.01, 0.54 and 0.93.
RIDGES = (0.03, 0.003, 0.0003)
_ROUNDING = 1e-9


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

    def coefficients(self, columns: np.ndarray, ridge: float) -> tuple[np.ndarray, np.ndarray]:
        """Ridge coefficients (f,) of weighted columns (T1, f), and those of the model's factor (b,)."""
        return self._solved(columns, (ridge,))[0]

    def predicted(
        self, inside: np.ndarray, outside: np.ndarray, ridges: Sequence[float] = RIDGES
    ) -> list[np.ndarray]:
        """What columns fitted to the rows inside, (T1, f), say of those outside, (T2,); for every ridge."""
        return [
            outside @ found - self.outside @ taken for found, taken in self._solved(inside, ridges)
        ]

    def _solved(
        self, columns: np.ndarray, ridges: Sequence[float]
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        # Squares are safe here: the ridge bounds the condition number by f / 0.0003.
        taken = self.inside.T @ columns
        whole = columns.T @ columns
        square = whole - taken.T @ (self.twice @ taken)
        mean = np.trace(square) / len(square)
        # What the model can follow all but for rounding is nothing.
        if mean <= _ROUNDING * np.trace(whole):
            return [(np.zeros(len(square)), np.zeros(len(taken)))] * len(ridges)
        right = columns.T @ self.residual - taken.T @ self.told
        solved = []
        for ridge in ridges:
            held = square + ridge * mean * np.eye(len(square))
            factor = scipy.linalg.cho_factor(held, check_finite=False, overwrite_a=True)
            found = scipy.linalg.cho_solve(factor, right, check_finite=False)
            solved.append((found, taken @ found))
        return solved


def joint_rows(fold: Fold, joint: int) -> JointRows:
    """The rows of a joint on a fold."""
    known, residual, train = fold.project[:, joint], fold.residual[:, joint], fold.train
    inside = known[train]
    twice = 2.0 * np.eye(inside.shape[1]) - inside.T @ inside
    told = inside.T @ residual[train]
    return JointRows(train, inside, known[~train], residual[train], residual[~train], twice, told)
