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

import jax
import jax.numpy as jnp
import numpy as np
from scipy.optimize import least_squares

from jaxswarm.errors import InputError
from jaxswarm.identify.physical.consistency import from_log_cholesky, to_log_cholesky
from jaxswarm.robot.placements import body_parameters


@dataclasses.dataclass(frozen=True)
class PhysicalSet:
    """A physical set of link parameters.

    Attributes:
        parameters: (n, 10), every link a rigid body.
        base_error: (p,), identified base values minus those of the set.
        cost: Weighted norm of ``base_error``: the torque the restriction costs, per sample scale.
    """

    parameters: np.ndarray
    base_error: np.ndarray
    cost: float


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
) -> PhysicalSet:
    """Find the physical set whose base parameters are nearest to identified ones.

    Args:
        base_matrix: (p, 10 n), base parameters as combinations of the standard ones; the identity
            for a full set.
        base_values: (p,), identified values.
        prior: (n, 10), physical link parameters to stay near where the base values leave freedom.
        weight: (p, p), e.g. the triangular factor of the regression; default scales each base
            parameter by its size.
        pull: Strength of the prior, > 0.

    Raises:
        InputError: If shapes do not match or the prior is not physical.
    """
    prior = np.asarray(prior, float)
    base_matrix, base_values = np.asarray(base_matrix, float), np.asarray(base_values, float)
    if base_matrix.shape != (base_values.size, prior.size):
        raise InputError(
            f"base_matrix is {base_matrix.shape}: {base_values.size} base values and "
            f"{prior.shape[0]} links need {(base_values.size, prior.size)}."
        )
    if weight is None:
        weight = np.diag(1.0 / (np.abs(base_values) + 0.05 * np.abs(base_values).max() + 1e-12))
    start = np.concatenate([to_log_cholesky(row) for row in prior])

    @jax.jit
    def residual(coordinates):
        bodies = jax.vmap(from_log_cholesky)(coordinates.reshape(-1, 10)).ravel()
        error = weight @ (base_matrix @ bodies - base_values)
        return jnp.concatenate([error, pull * (coordinates - start)])

    derivative = jax.jit(jax.jacfwd(residual))
    with_prior = least_squares(
        lambda x: np.asarray(residual(x)),
        start,
        jac=lambda x: np.asarray(derivative(x)),
        method="trf",
        x_scale=1.0,
        max_nfev=500,
    )
    bodies = np.asarray(jax.vmap(from_log_cholesky)(jnp.asarray(with_prior.x).reshape(-1, 10)))
    error = base_values - base_matrix @ bodies.ravel()
    return PhysicalSet(bodies, error, float(np.linalg.norm(weight @ error)))
