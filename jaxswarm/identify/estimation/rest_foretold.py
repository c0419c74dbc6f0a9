"""Whether motion predicts what a model does at rest, so that a fit may leave out what holds joints there."""

import numpy as np
import scipy

from jaxswarm.identify.estimation.factors import triangular_factor

# What motion tells of a parameter, over what all rows do, below which it tells nothing.
_UNSEEN = 1e-6
# Rest that motion predicts so many times worse than itself tells the model, whatever holds it: by standard
# errors 1.0 on point-to-point motion, 1.0 to 300 on joints that move one by one. Without such rest a model that
# left 0.1 to 1.5 times the noise was off by thousands of times the noise on other motion.
_TOLD = 2.0


def is_foretold(columns: np.ndarray, left: np.ndarray, resting: np.ndarray) -> np.ndarray:
    """Whether motion predicts most of a joint's rest about as well as motion itself, (n,).

    Args:
        columns: Of the model, (T, n, p).
        left: What the fit to motion alone leaves, (T, n).
        resting: Rows at rest, (T, n).
    """
    # A joint that never moves tells nothing of the model, and has no error in motion.
    size = np.where(resting.all(axis=0), np.inf, rms_in_motion(left, resting))
    # A joint at a time: beside the columns of a long log, as large as all else, no copy of them stands.
    squares = [((columns[:, j] / one) ** 2).sum(axis=0) for j, one in enumerate(size)]
    norm = np.sqrt(np.sum(squares, axis=0))
    seen = norm > 0.0

    def scaled(j: int, rows: np.ndarray) -> np.ndarray:
        return columns[rows, j][:, seen] / (size[j] * norm[seen])

    factor = _UNSEEN * np.eye(int(seen.sum()))
    for j, still in enumerate(resting.T):
        factor = triangular_factor(np.concatenate([factor, scaled(j, ~still)]))
    doubt = np.zeros(left.shape)
    for j, still in enumerate(resting.T):
        if not still.any():
            continue
        unseen = scipy.linalg.solve_triangular(
            factor, scaled(j, still).T, trans="T", check_finite=False
        )
        doubt[still, j] = np.sqrt(1.0 + (unseen**2).sum(axis=0))
    usual = [np.median(d[r]) if r.any() else 0.0 for d, r in zip(doubt.T, resting.T, strict=True)]
    return np.array(usual) <= _TOLD


def rms_in_motion(left: np.ndarray, resting: np.ndarray) -> np.ndarray:
    """RMS (n,) of what is left (T, n) on rows that are not at rest, where there are any."""
    count = np.maximum((~resting).sum(axis=0), 1)
    return np.sqrt(np.where(resting, 0.0, left**2).sum(axis=0) / count) + 1e-300
