"""How certain least squares are where residuals have a memory."""

import numpy as np
from scipy import linalg

# Rows with more leverage than this are fitted whatever they hold.
_MOST_LEVERAGE = 0.9


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


def sandwich(factor, scores, error, log) -> tuple[np.ndarray, float]:
    """Newey-West covariance of the base parameters, and the effective number of samples."""
    length, size = len(error), factor.shape[0]
    inflation = correlation_length(error, log)
    # A row that decides a parameter alone hides its own error: leave-one-out residuals.
    leverage = np.minimum((scores**2).sum(axis=2), _MOST_LEVERAGE)
    u = np.einsum("tjb,tj->tb", scores, error / (1.0 - leverage))
    # Andrews' automatic lag for a first-order process of the measured correlation length.
    rho = (inflation - 1.0) / (inflation + 1.0)
    lag_limit = int(
        min(length // 4, 1 + 1.1447 * (length * 4 * rho**2 / (1 - rho**2) ** 2) ** (1 / 3))
    )
    meat, power, tapered = u.T @ u, max(float((error**2).sum()), 1e-300), 1.0
    for lag in range(1, lag_limit + 1):
        same = (log[lag:] == log[:-lag])[:, None]
        taper = 1.0 - lag / (lag_limit + 1.0)
        gamma = (u[lag:] * same).T @ u[:-lag]
        meat += taper * (gamma + gamma.T)
        tapered += 2.0 * taper * float((error[lag:] * same * error[:-lag]).sum() / power)
    # What the taper took off the pooled autocorrelation is given back.
    meat *= max(1.0, inflation / tapered)
    inverse = linalg.solve_triangular(factor, np.eye(size), check_finite=False)
    return inverse @ meat @ inverse.T, error.size / inflation
