r"""Can rigid bodies have the identified parameters? Told for every link, and made so on demand.

All base parameters and linear parameters of effects are moved to the nearest set with rigid bodies for
links, by the torque that costs on the very data (:func:`nearest_physical` with the triangular factor of
the fit). A link whose base parameters would have to move by more than their standard errors allow has
parameters that no rigid body has: the model, the data or the units are wrong there.
"""

from dataclasses import dataclass, replace

import numpy as np

from jaxswarm.effects.term import parameter_bounds
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import with_linear_values
from jaxswarm.identify.physical.physical_model import (
    PULL,
    base_matrix,
    further_of,
    prior_bodies,
)
from jaxswarm.identify.physical.projection import nearest_physical
from jaxswarm.robot.model import Robot
from jaxswarm.robot.placements import about_center

# 99.7 %: of dozens of parameters none should be told by chance.
_BEYOND = 3.0


@dataclass(frozen=True)
class Consistency:
    """The nearest physical set of an estimate.

    Attributes:
        theta: All linear parameters with rigid bodies for links, (p,).
        moved: RMS by which the torque moves on the fitted data, (n,), in N m or N.
        beyond: Distance of each base parameter to the physical set in its standard errors, (b,).
        reasons: For each link what no rigid body can have; empty where one can.
    """

    theta: np.ndarray
    moved: np.ndarray
    beyond: np.ndarray
    reasons: tuple[tuple[str, ...], ...]


def consistency_of(found: Estimate, prior: Robot | None = None, pull: float = PULL) -> Consistency:
    """Find the nearest physical set of an estimate.

    Args:
        found: The estimate.
        prior: Robot (with bodies) to stay near where the data leave freedom; None: equal balls.
        pull: Weight of the prior in residual standard deviations of one sample.

    Raises:
        InputError: If the prior does not fit the robot.
    """
    robot, solution = found.model.robot, found.fit
    links = 10 * robot.num_joints
    lower, upper = parameter_bounds(found.model.terms, robot.joints)
    further = further_of(solution.theta[links:], lower[links:], upper[links:])
    matrix = base_matrix(solution.base)
    bodies = prior_bodies(robot, prior)
    nearest = nearest_physical(
        matrix, solution.values, prior=bodies, weight=solution.factor, pull=pull, further=further
    )
    theta = np.concatenate([nearest.parameters.ravel(), nearest.further])
    change = found.regression.columns[:, :, solution.base.kept] @ nearest.base_error
    errors = np.where(solution.std_error > 0.0, solution.std_error, np.inf)
    beyond = np.abs(nearest.base_error) / errors
    reasons: list[list[str]] = [[] for _ in robot.joints]
    expressions = solution.base.expressions()
    for k in np.flatnonzero(beyond > _BEYOND):
        column = int(solution.base.kept[k])
        if column < links:
            reasons[column // 10].append(
                f"{expressions[k]} = {solution.values[k]:.4g} would have to be "
                f"{solution.values[k] - nearest.base_error[k]:.4g} ({beyond[k]:.3g} standard errors)"
            )
    moved = np.sqrt(np.mean(change**2, axis=0))
    return Consistency(theta, moved, beyond, tuple(map(tuple, reasons)))


def with_bodies(found: Estimate, bodies: Consistency) -> Estimate:
    """The estimate with the nearest physical set in place of its values."""
    values = base_matrix(found.fit.base) @ bodies.theta
    columns = found.regression.columns[:, :, found.fit.base.kept]
    solution = replace(
        found.fit, values=values, residual=found.regression.target - columns @ values
    )
    # How certain the parameters are on the edge of what bodies can have is not known.
    model = replace(with_linear_values(found.model, bodies.theta), uncertainty=None)
    return replace(found, fit=solution, model=model)


def consistency_report(
    found: Estimate, bodies: Consistency, enforced: bool, prior: str | None, pull: float
) -> dict:
    """The outcome as plain data for ``identification.json``; the bodies stand for standard parameters."""
    rows = bodies.theta[: 10 * found.model.robot.num_joints].reshape(-1, 10)
    return {
        "enforced": enforced,
        "prior": prior or "equal balls",
        "prior_weight": pull,
        "torque_moved": list(bodies.moved),
        "torque_moved_over_residual": list(bodies.moved / found.fit.sigma),
        "links": [
            {"joint": joint, "possible": not reasons, "reasons": list(reasons), **_body(row)}
            for joint, reasons, row in zip(
                found.model.robot.joints, bodies.reasons, rows, strict=True
            )
        ],
    }


def _body(parameters: np.ndarray) -> dict:
    """Mass [kg], center of mass [m] and inertia about it [kg m^2] of a link, in its frame."""
    mass, center, inertia = about_center(parameters)
    return {"mass": mass, "center": center.tolist(), "inertia": inertia.tolist()}
