r"""The physical set of link parameters nearest to an identified one, with a prior for the rest.

Least squares determines only base combinations :math:`B \theta`; a full set that gives them and belongs
to rigid bodies is found in log-Cholesky coordinates :math:`\xi`,

.. math:: \min_\xi \| W (B\,\theta(\xi) - \beta) \|^2 + \lambda^2 \sum_i \| \xi_i - \xi_i^0 \|^2 ,

with :math:`\xi^0` the prior bodies (CAD, or :func:`plain_prior`) and W the triangular factor of the
regression, so that a deviation counts as the torque it causes. A small :math:`\lambda` leaves the base
parameters as identified if any physical body has them, and the nearest ones by torque if none has.

Reference: P. Wensing, S. Kim, J.-J. Slotine, IEEE RA-L 3(1), 2018; T. Lee, P. Wensing, F. Park,
"Geometric robot dynamic identification", IEEE T-RO 36(2), 2020 (priors).
"""

import dataclasses
from typing import NamedTuple

import numpy as np
import scipy

from jaxswarm.errors import InputError
from jaxswarm.identify.physical.consistency import (
    from_log_cholesky,
    log_cholesky_slopes,
    to_log_cholesky,
)
from jaxswarm.robot.placements import body_parameters


@dataclasses.dataclass(frozen=True)
class PhysicalSet:
    """A physical set of link parameters.

    Attributes:
        parameters: (n, 10), every link a rigid body.
        base_error: (p,), identified base values minus those of the set.
        cost: Weighted norm of ``base_error``: the torque the restriction costs, per sample scale.
        further: (k,), values of the further linear parameters.
    """

    parameters: np.ndarray
    base_error: np.ndarray
    cost: float
    further: np.ndarray


class Further(NamedTuple):
    """Linear parameters besides the bodies, (k,) each: where they start, and their bounds."""

    start: np.ndarray
    lower: np.ndarray
    upper: np.ndarray


_NONE = Further(np.zeros(0), np.zeros(0), np.zeros(0))


def plain_prior(num_links: int, *, mass: float = 5.0, size: float = 0.15) -> np.ndarray:
    """Return link parameters (n, 10) of equal balls, for robots without CAD data.

    Args:
        num_links: Number of links n.
        mass: Mass of each in kg.
        size: Radius of gyration in m.
    """
    ball = body_parameters(mass, np.zeros(3), mass * size**2 * np.eye(3))
    return np.tile(ball, (num_links, 1))


def nearest_physical(
    base_matrix: np.ndarray,
    base_values: np.ndarray,
    *,
    prior: np.ndarray,
    weight: np.ndarray | None = None,
    pull: float = 1e-3,
    further: Further = _NONE,
) -> PhysicalSet:
    """Find the physical set whose base parameters are nearest to identified ones.

    Args:
        base_matrix: (p, 10 n + k), base parameters as combinations of the standard ones and of
            ``further``; the identity for a full set.
        base_values: (p,), identified values.
        prior: (n, 10), physical link parameters to stay near where the base values leave freedom.
        weight: (p, p), e.g. the triangular factor of the regression; default scales each base
            parameter by its size.
        pull: Strength of the prior, > 0: what a change of a log-Cholesky coordinate by 1 (a mass by
            the factor e^2) costs, in units of the weighted error.
        further: Linear parameters besides the bodies that the base parameters hold, such as friction.

    Raises:
        InputError: If shapes do not match or the prior is not physical.
    """
    prior = np.asarray(prior, float)
    base_matrix, base_values = np.asarray(base_matrix, float), np.asarray(base_values, float)
    size = prior.size
    _check_shape(base_matrix, base_values, prior, further)
    if weight is None:
        weight = np.diag(1.0 / (np.abs(base_values) + 0.05 * np.abs(base_values).max() + 1e-12))
    bodies_start = np.concatenate([to_log_cholesky(row) for row in prior])
    inside = np.clip(further.start, further.lower, further.upper)
    # Coordinates of the further parameters are such that a change by 1 matters as much as for a body.
    scale = 1.0 + np.abs(inside)
    start = np.concatenate([bodies_start, inside / scale])

    weighted = weight @ base_matrix, weight @ base_values
    found = _minimum(*weighted, start, scale, pull, (further.lower / scale, further.upper / scale))
    bodies = from_log_cholesky(found[:size].reshape(-1, 10))
    left = found[size:] * scale
    error = base_values - base_matrix @ np.concatenate([bodies.ravel(), left])
    return PhysicalSet(bodies, error, float(np.linalg.norm(weight @ error)), left)


def _minimum(
    matrix: np.ndarray,
    values: np.ndarray,
    start: np.ndarray,
    scale: np.ndarray,
    pull: float,
    bounds: tuple[np.ndarray, np.ndarray],
) -> np.ndarray:
    """Coordinates of the bodies and, in units of ``scale``, of the further parameters at the minimum.

    Args:
        matrix, values: Weighted base matrix (p, m) and base values (p,).
        start: The prior's coordinates (m,), where the search begins and where the pull goes.
        scale: Units of the last k coordinates, (k,).
        pull: Strength of the prior.
        bounds: Lower and upper bounds of the last k coordinates.
    """
    size = len(start) - len(scale)
    of_links = matrix[:, :size].reshape(len(matrix), -1, 10)

    def residual(x):
        links = from_log_cholesky(x[:size].reshape(-1, 10)).ravel()
        full = np.concatenate([links, x[size:] * scale])
        return np.concatenate([matrix @ full - values, pull * (x - start)])

    def derivative(x):
        slopes = log_cholesky_slopes(x[:size].reshape(-1, 10))
        by_links = np.einsum("blp,lpc->blc", of_links, slopes).reshape(len(matrix), -1)
        by_all = np.column_stack([by_links, matrix[:, size:] * scale])
        return np.concatenate([by_all, pull * np.eye(len(x))])

    free = np.full(size, np.inf)
    return scipy.optimize.least_squares(
        residual,
        start,
        jac=derivative,
        bounds=tuple(
            np.concatenate([own, bound]) for own, bound in zip((-free, free), bounds, strict=True)
        ),
        method="trf",
        x_scale=1.0,
        max_nfev=500,
    ).x


def _check_shape(
    base_matrix: np.ndarray, base_values: np.ndarray, prior: np.ndarray, further: Further
) -> None:
    """Refuse combinations of another number of parameters than there are."""
    wanted = (base_values.size, prior.size + further.start.size)
    if base_matrix.shape != wanted:
        raise InputError(
            f"base_matrix is {base_matrix.shape}: {base_values.size} base values, "
            f"{prior.shape[0]} links and {further.start.size} further parameters need {wanted}."
        )
