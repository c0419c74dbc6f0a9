"""How rivals choose columns: stepwise by cross-validation or by BIC, STLSQ, LASSO.

Each takes a matrix ``x`` (m, L) whose columns are orthogonal to the declared model and of unit norm, the
target ``y`` (m,), and block numbers (m,) for cross-validation; it returns the indices it keeps.
STLSQ: S. Brunton, J. Proctor, J. N. Kutz, PNAS 113 (2016), with its threshold chosen by cross-validation.
"""

import numpy as np
from sklearn.linear_model import Lasso, LassoCV
from sklearn.model_selection import PredefinedSplit

FOLDS = 5
# Terms a stepwise search may add, at most.
_MOST = 25
_THRESHOLDS = np.geomspace(1e-3, 0.5, 10)  # in norms of the target
_RIDGE = 1e-4


def blocks(rows: int) -> np.ndarray:
    """Fold of each row: contiguous stretches of time, dealt out in turn."""
    return (np.arange(rows) * 2 * FOLDS // rows) % FOLDS


def _forward(x: np.ndarray, y: np.ndarray, most: int) -> tuple[list[int], list[float]]:
    """Greedy choice: indices in order, and the squared error after each (the first: of nothing)."""
    x, left = x.copy(), y.copy()
    chosen: list[int] = []
    errors = [float(left @ left)]
    for _ in range(min(most, x.shape[1])):
        norms = np.linalg.norm(x, axis=0)
        gains = np.where(norms > 1e-6, np.abs(x.T @ left) / np.maximum(norms, 1e-6), 0.0)
        best = int(np.argmax(gains))
        direction = x[:, best] / norms[best]
        left = left - direction * (direction @ left)
        x -= np.outer(direction, direction @ x)
        chosen.append(best)
        errors.append(float(left @ left))
    return chosen, errors


def by_bic(x, y, fold) -> list[int]:
    chosen, errors = _forward(x, y, _MOST)
    m = len(y)
    score = [m * np.log(e / m + 1e-300) + k * np.log(m) for k, e in enumerate(errors)]
    return chosen[: int(np.argmin(score))]


def by_validation(x, y, fold) -> list[int]:
    chosen, _ = _forward(x, y, _MOST)
    errors = [held_out(x, y, fold, chosen[:k]) for k in range(len(chosen) + 1)]
    return chosen[: int(np.argmin(errors))]


def held_out(x, y, fold, chosen) -> float:
    """Squared error of unseen blocks."""
    if not len(chosen):
        return float(y @ y)
    error = 0.0
    for k in range(FOLDS):
        seen = fold != k
        w = np.linalg.lstsq(x[seen][:, chosen], y[seen], rcond=1e-10)[0]
        error += float(((y[~seen] - x[~seen][:, chosen] @ w) ** 2).sum())
    return error


def stlsq(x, y, fold) -> list[int]:
    size = np.linalg.norm(y)
    kept = [_thresholded(x, y, t * size) for t in _THRESHOLDS]
    errors = [held_out(x, y, fold, k) for k in kept]
    return kept[int(np.argmin(errors))]


def _thresholded(x, y, threshold) -> list[int]:
    kept = np.arange(x.shape[1])
    while len(kept):
        own = x[:, kept]
        w = np.linalg.solve(own.T @ own + _RIDGE * np.eye(len(kept)), own.T @ y)
        large = np.abs(w) > threshold
        if large.all():
            break
        kept = kept[large]
    return kept.tolist()


def lasso(x, y, fold) -> list[int]:
    scale = np.sqrt(len(y))
    search = LassoCV(
        alphas=12, cv=PredefinedSplit(fold), fit_intercept=False, max_iter=500, tol=1e-3
    ).fit(x * scale, y)
    model = Lasso(search.alpha_, fit_intercept=False, max_iter=1000, tol=1e-3).fit(x * scale, y)
    return np.flatnonzero(model.coef_).tolist()


CHOOSERS = {"stepwise, CV": by_validation, "stepwise, BIC": by_bic, "STLSQ": stlsq, "LASSO": lasso}
