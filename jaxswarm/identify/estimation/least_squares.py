r"""Weighted least squares on base parameters, by orthogonal factors only, with honest standard errors.

Rows of joint j are divided by its residual standard deviation, estimated from the residual and iterated.
The data are compressed once to the triangular factor R and z of ``[W | tau]``; everything after works
on those. Residuals of real robots are strongly autocorrelated, so the covariance of the estimate is the
larger of two sandwiches, one by frequencies (:mod:`jaxswarm.identify.estimation.covariance`), and Newey-West's

.. math:: R^{-1} \Big(\sum_{|l| \le L} (1 - |l|/(L+1)) \sum_t u_t u_{t-l}^T\Big) R^{-T},
   \qquad u_t = Q_t^T e_t / (1 - h_t),

with the lag L from the residual's own correlation length and the leverage h of a row, without which a
parameter that few rows decide looks too certain (J. G. MacKinnon, H. White, J. Econometrics 29 (1985),
the jackknife form). References: M. Gautier, ICRA 1997 (weights);
W. K. Newey, K. D. West, Econometrica 55 (1987); D. W. K. Andrews, Econometrica 59 (1991), eq. 6.4.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from jaxswarm.identify.estimation.base_parameters import BaseParameters, find_base
from jaxswarm.identify.estimation.bounded import solve, solve_within
from jaxswarm.identify.estimation.covariance import sandwich, scored
from jaxswarm.identify.estimation.factors import joint_factors, weighted_factor
from jaxswarm.identify.forward.regression import Regression

# Rounds in which weights are found from what is left, until the logarithm of each stands still so far. After
# five from the RMS of the torque they were up to 0.45 off on a log of six joints.
_ROUNDS, _SETTLED = 30, 1e-4


@dataclass(frozen=True)
class Fit:
    """A least-squares solution.

    Attributes:
        base: Which columns are independent, and how the others merge.
        values: Base parameter values, shape (b,).
        covariance: Their covariance, respecting autocorrelation, shape (b, b).
        sigma: Residual standard deviation of every joint [N m or N], shape (n,).
        factor: Triangular factor of the weighted base columns, shape (b, b).
        target: z with ``||R theta - z||^2 + cost`` the weighted cost, shape (b,).
        cost: Weighted sum of squares no theta removes.
        residual: tau minus model, shape (T, n).
        at_bound: Whether a base parameter sits on its physical bound, shape (b,).
        effective_samples: Independent residuals the data amount to.
        lower, upper: Bounds the base parameters were held to, each (b,); None: none.
        prior: Rows of :attr:`Regression.prior` on the base parameters, (r, b).
    """

    base: BaseParameters
    values: np.ndarray
    covariance: np.ndarray
    sigma: np.ndarray
    factor: np.ndarray
    target: np.ndarray
    cost: float
    residual: np.ndarray
    at_bound: np.ndarray
    effective_samples: float
    lower: np.ndarray | None = None
    upper: np.ndarray | None = None
    prior: np.ndarray | None = None

    @property
    def theta(self) -> np.ndarray:
        """Full parameter vector: base values, zeros for what merges into them."""
        return self.base.expand(self.values)

    @property
    def std_error(self) -> np.ndarray:
        """Standard errors of the base parameters, shape (b,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def condition(self) -> float:
        """Condition number of the weighted base columns, each scaled to unit norm."""
        return float(np.linalg.cond(self.factor / np.linalg.norm(self.factor, axis=0)))


def weighted_cost(residual: np.ndarray, sigma: np.ndarray) -> float:
    """Sum of squares of a residual (T, n) in units of ``sigma`` (n,)."""
    return float(((residual / sigma) ** 2).sum())


class Solved(NamedTuple):
    """What :func:`fit` finds but for how certain it is; ``triangle`` is the factor of ``[R z; 0 rho]``."""

    base: BaseParameters
    values: np.ndarray
    sigma: np.ndarray
    triangle: np.ndarray
    residual: np.ndarray
    at_bound: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    prior: np.ndarray

    @property
    def theta(self) -> np.ndarray:
        """Full parameter vector, as :attr:`Fit.theta`."""
        return self.base.expand(self.values)


def fit(
    regression: Regression,
    lower: np.ndarray | None = None,
    upper: np.ndarray | None = None,
    base: BaseParameters | None = None,
    sigma: np.ndarray | None = None,
    above: np.ndarray | None = None,
) -> Fit:
    """Fit a model's linear parameters to its regression.

    Args:
        regression: Columns and torque.
        lower, upper: Bounds of the full parameters, shape (p,); a bound is used where its column is
            kept and nothing merges into it. None: unbounded.
        base: Basis to use; None: found from these data.
        sigma: Weights to use, shape (n,); None: iterated from the residual.
        above: Rows whose products with the full parameters must not be negative, (m, p).
    """
    return with_doubt(solved(regression, lower, upper, base, sigma, above), regression)


def with_doubt(found: Solved, regression: Regression) -> Fit:
    """A solution with how certain it is, which takes as long as to find it.

    Args:
        found: What :func:`solved` found.
        regression: For these rows.
    """
    size, triangle = found.base.size, found.triangle
    factor, target = triangle[:size, :size], triangle[:size, size]
    error = found.residual / found.sigma
    scores = scored(factor, regression.columns, found.base.kept, found.sigma, error, regression.log)
    covariance, effective = sandwich(factor, scores, error, regression.log, found.prior)
    covariance[found.at_bound, :] = 0.0
    covariance[:, found.at_bound] = 0.0
    cost = float(triangle[size, size] ** 2) if triangle.shape[0] > size else 0.0
    return Fit(
        found.base, found.values, covariance, found.sigma, factor, target, cost, found.residual,
        found.at_bound, effective, found.lower, found.upper, found.prior,
    )  # fmt: skip


def solved(
    regression: Regression,
    lower: np.ndarray | None = None,
    upper: np.ndarray | None = None,
    base: BaseParameters | None = None,
    sigma: np.ndarray | None = None,
    above: np.ndarray | None = None,
    near: np.ndarray | None = None,
) -> Solved:
    """The solution of :func:`fit`, with its arguments, where nobody asks how certain it is.

    ``near``: Weights of a fit near this one, (n,), to begin with.
    """
    joints = regression.torque.shape[1]
    factors = joint_factors(regression)
    size = np.maximum(regression.torque.std(axis=0), 1e-12)
    fixed = sigma is not None
    scale = size if sigma is None else sigma
    if base is None:
        base = find_base(weighted_factor(factors, scale)[:, :-1], regression.names)
    low, high = base_bounds(base, lower, upper)
    pick = np.append(base.kept, len(regression.names))
    reduced, prior = [f[:, pick] for f in factors], prior_on(base, regression.prior)
    # Parameters shared by the joints are counted where they act: equally among the rows.
    freedom = np.maximum(1.0, regression.rows_counted - base.size / joints)
    least = 1e-9 * np.maximum(np.abs(regression.torque).max(axis=0), 1e-12)
    new = scale if fixed or near is None else near
    for _ in range(1 if fixed else _ROUNDS):
        scale = new
        triangle = weighted_factor(reduced, scale, prior)
        values, at_bound = solve(triangle, low, high)
        if above is not None and (above[:, base.kept] @ values < 0).any():
            values, at_bound = solve_within(triangle, low, high, above[:, base.kept])
        left = [np.linalg.norm(f[:, :-1] @ values - f[:, -1]) for f in reduced]
        new = np.maximum(left / np.sqrt(freedom), least)
        if np.abs(np.log(new / scale)).max() < _SETTLED:
            break
    residual = regression.target - regression.columns @ base.expand(values)
    return Solved(base, values, scale, triangle, residual, at_bound, low, high, prior)


def prior_on(base: BaseParameters, prior: np.ndarray | None) -> np.ndarray:
    """Rows (r, b) on the base parameters of those (r, m) on the first columns; none of None."""
    if prior is None:
        return np.zeros((0, base.size))
    return np.pad(prior, ((0, 0), (0, len(base.names) - prior.shape[1])))[:, base.kept]


def values_on(factors: list[np.ndarray], like: Fit) -> np.ndarray:
    """Base parameters (b,) of other rows, in the basis, with the weights and within the bounds of a fit.

    Args:
        factors: Of those rows, :func:`joint_factors`.
        like: The fit.
    """
    pick = np.append(like.base.kept, len(like.base.names))
    factors = [f[:, pick] for f in factors]
    size = like.base.size
    free = np.full(size, np.inf)
    low = -free if like.lower is None else like.lower
    high = free if like.upper is None else like.upper
    return solve(weighted_factor(factors, like.sigma, like.prior), low, high)[0]


def base_bounds(base: BaseParameters, lower, upper) -> tuple[np.ndarray, np.ndarray]:
    """Bounds of the base parameters: those of columns that stand for themselves alone."""
    low, high = np.full(base.size, -np.inf), np.full(base.size, np.inf)
    if lower is not None:
        alone = ~(np.abs(base.merge) > 0).any(axis=1)
        low[alone] = np.asarray(lower)[base.kept[alone]]
        high[alone] = np.asarray(upper)[base.kept[alone]]
    return low, high
