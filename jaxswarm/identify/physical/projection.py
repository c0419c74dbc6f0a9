r"""The physical set of link parameters nearest to an identified one, with a prior for the rest.

Least squares determines only base combinations :math:`B \theta`; a full set that gives them and belongs
to rigid bodies with pseudo-inertias :math:`P_i` minimizes

.. math:: \| W (B\,\theta - \beta) \|^2 + \lambda^2 \sum_i D(P_i, P_i^0) ,

with :math:`P_i^0` the prior bodies (CAD, or :func:`plain_prior`), D the divergence of
:mod:`~jaxswarm.identify.physical.cone_program`, and W the triangular factor of the regression, so that a
deviation counts as the torque it causes. A small :math:`\lambda` leaves the base parameters as identified
if any physical body has them, and the nearest ones by torque if none has. The problem is convex: one
minimum.

Reference: P. Wensing, S. Kim, J.-J. Slotine, IEEE RA-L 3(1), 2018; T. Lee, P. Wensing, F. Park,
"Geometric robot dynamic identification", IEEE T-RO 36(2), 2020 (priors).
"""

import dataclasses
from typing import NamedTuple

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.identify.physical.cone_program import Problem, nearest_bodies
from jaxswarm.identify.physical.consistency import factor_of
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
        pull: Strength of the prior, > 0, in units of the weighted error: a body with half of the prior's
            mass and inertia costs 0.8 times its square, one with twice of both 1.2 times.
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
    factors = np.stack([factor_of(row) for row in prior])
    inside = np.clip(further.start, further.lower, further.upper)
    # Units of the further parameters are such that a change by 1 matters as much as for a body.
    scale = 1.0 + np.abs(inside)
    weighted = weight @ base_matrix
    weighted[:, size:] *= scale
    own = inside / scale, further.lower / scale, further.upper / scale
    problem = Problem(weighted, weight @ base_values, factors, *own, pull)
    bodies, left = nearest_bodies(problem)
    left = left * scale
    error = base_values - base_matrix @ np.concatenate([bodies.ravel(), left])
    return PhysicalSet(bodies, error, float(np.linalg.norm(weight @ error)), left)


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
