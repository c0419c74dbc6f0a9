"""How certain least squares are where residuals have a memory."""

import numpy as np
import scipy

# Rows with more leverage than this are fitted whatever they hold.
_MOST_LEVERAGE = 0.9
# Rows that are worked on at a time.
_ROWS = 4096


def correlation_length(error: np.ndarray, log: np.ndarray) -> float:
    """Integrated autocorrelation 1 + 2 sum rho_l of residuals (T, n), pooled over joints and logs.

    The sum stops at the first lag whose correlation is lost in its own noise.
    """
    length, total = len(error), 1.0
    power = (error**2).sum()
    for lag in range(1, max(2, length // 4)):
        same = log[lag:] == log[:-lag]
        rho = float((error[lag:][same] * error[:-lag][same]).sum() / max(power, 1e-300))
        if rho < 2.0 / np.sqrt(error.size):
            break
        total += 2.0 * rho
    return total


def scored(
    factor: np.ndarray, columns: np.ndarray, kept: np.ndarray, sigma: np.ndarray, error: np.ndarray
) -> np.ndarray:
    """Rows u (T, b) of the sandwich: leave-one-out residuals along the orthogonal factor of the columns.

    A row that decides a parameter alone hides its own error: by its leverage it is made good.

    Args:
        factor: Triangular factor of the weighted base columns, (b, b).
        columns: Of all parameters, (T, n, p); ``kept`` (b,) are those of the base.
        sigma: Standard deviations of the joints, (n,).
        error: Residual over ``sigma``, (T, n).
    """
    u = np.empty((len(error), len(kept)))
    for start in range(0, len(error), _ROWS):
        rows = slice(start, start + _ROWS)
        weighted = columns[rows][:, :, kept] / sigma[:, None]
        flat = weighted.reshape(-1, len(kept)).T
        q = scipy.linalg.solve_triangular(factor, flat, trans="T", check_finite=False).T
        q = q.reshape(weighted.shape)
        leverage = np.minimum((q**2).sum(axis=2), _MOST_LEVERAGE)
        u[rows] = np.einsum("tjb,tj->tb", q, error[rows] / (1.0 - leverage))
    return u


def moving_sums(x: np.ndarray, width: int) -> np.ndarray:
    """Sums of so many rows that follow on each other, (T + width - 1, m), zeros beyond both ends.

    >>> moving_sums(np.array([[1.0], [2.0], [4.0]]), 2).ravel()
    array([1., 3., 6., 4.])
    """
    total = np.zeros((len(x) + 2 * width - 1, x.shape[1]))
    np.cumsum(x, axis=0, out=total[width : len(x) + width])
    total[len(x) + width :] = total[len(x) + width - 1]
    return total[width:] - total[:-width]


def sandwich(factor, u, error, log) -> tuple[np.ndarray, float]:
    """Newey-West covariance of the base parameters from :func:`scored`, and the effective samples."""
    length, size = len(error), factor.shape[0]
    inflation = correlation_length(error, log)
    # Andrews' automatic lag for a first-order process of the measured correlation length.
    rho = (inflation - 1.0) / (inflation + 1.0)
    lag_limit = int(
        min(length // 4, 1 + 1.1447 * (length * 4 * rho**2 / (1 - rho**2) ** 2) ** (1 / 3))
    )
    power = float((error**2).sum())
    meat, tapered = np.zeros((size, size)), 0.0
    for number in np.unique(log):
        # The tapered sum over all lags is that of the squares of sums over windows: no loop over lags.
        own = moving_sums(u[log == number], lag_limit + 1)
        meat += own.T @ own / (lag_limit + 1)
        told = moving_sums(error[log == number], lag_limit + 1)
        tapered += float((told**2).sum()) / (lag_limit + 1)
    tapered = tapered / power if power > 0.0 else 1.0
    # What the taper took off the pooled autocorrelation is given back.
    meat *= max(1.0, inflation / tapered)
    inverse = scipy.linalg.solve_triangular(factor, np.eye(size), check_finite=False)
    return inverse @ meat @ inverse.T, error.size / inflation
