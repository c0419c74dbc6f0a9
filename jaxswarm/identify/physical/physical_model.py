r"""An identified model with rigid bodies for links, and how far that moves its torque.

A model holds base parameters: values for the columns a fit kept, zeros for what merges into them. Such
links are no bodies. The nearest set of bodies is found by :func:`nearest_physical` on the columns of a
motion, each joint's torque counted in units of its residual (or of its torque where none is known), so
that what is moved is what matters least to the torque. If the identified base parameters belong to some
set of bodies, the torque does not move; where it moves, no rigid bodies have them.
"""

from dataclasses import dataclass, replace

import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.identify.estimation.base_parameters import BaseParameters, find_base
from jaxswarm.identify.estimation.factors import triangular_factor
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.physical.consistency import violations
from jaxswarm.identify.physical.projection import Further, nearest_physical, plain_prior
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.model import Robot
from jaxswarm.robot.names import standard_parameter_names

# What the prior costs for a coordinate that is off by 1, in residual standard deviations of one sample:
# far below what a log of hundreds of samples knows, far above rounding.
PULL = 0.03
# Speeds and accelerations of the random states [rad/s, rad/s^2] and reach of a slide [m]: an arm at work.
_STATES, _SPEED, _ACCELERATION, _REACH = 400, 1.5, 4.0, 0.5


@dataclass(frozen=True)
class PhysicalModel:
    """A model of rigid bodies beside the one it came from.

    Attributes:
        model: With physical links.
        moved: RMS by which the torque moved on the motion, (n,), in N m or N.
        torque: RMS of the torque of the rigid body on that motion, (n,).
        where: What that motion is.
        base_error: (b,), identified base values minus those of the bodies.
    """

    model: Model
    moved: np.ndarray
    torque: np.ndarray
    where: str
    base_error: np.ndarray


def random_columns(robot: Robot, seed: int = 0) -> np.ndarray:
    """Columns (T, n, 10 n) of the rigid body at random states of an arm at work."""
    draw = np.random.default_rng(seed).uniform(-1.0, 1.0, (3, _STATES, robot.num_joints))
    reach = np.where([kind == "revolute" for kind in robot.kinds], np.pi, _REACH)
    states = draw[0] * reach, draw[1] * _SPEED, draw[2] * _ACCELERATION
    return np.asarray(rigid_columns(robot, *states))


def prior_bodies(robot: Robot, prior: Robot | None) -> np.ndarray:
    """Links (n, 10) to stay near: those of a prior robot, else plain balls.

    Raises:
        InputError: If the prior has other joints, or links that are no bodies.
    """
    if prior is None:
        return plain_prior(robot.num_joints)
    if prior.joints != robot.joints:
        raise InputError(
            f"prior {prior.name} has joints {', '.join(prior.joints)}, the robot {robot.name} has "
            f"{', '.join(robot.joints)}; give a prior of the same robot"
        )
    told = violations(prior)
    if told:
        raise InputError(
            f"prior {prior.name} has links that are no rigid bodies: {told[0]}; give every link "
            "mass and inertia in the file"
        )
    return np.asarray(prior.parameters, float)


def physical_model(
    model: Model,
    columns: np.ndarray | None = None,
    where: str = "random states of an arm at work",
    *,
    prior: Robot | None = None,
    pull: float = PULL,
) -> PhysicalModel:
    """Give a model links that are rigid bodies; its effects stay as they are.

    Args:
        model: An identified model.
        columns: Columns (T, n, 10 n) of the rigid body on the motion that counts; None: random states.
        where: What that motion is, for the report.
        prior: Robot to stay near where the base parameters leave freedom; None: equal balls.
        pull: Weight of the prior, see :data:`PULL`.

    Raises:
        InputError: If the prior does not fit.
    """
    robot = model.robot
    bodies = prior_bodies(robot, prior)
    theta = np.asarray(robot.parameters, float).ravel()
    columns = random_columns(robot) if columns is None else columns
    torque = np.sqrt(np.mean((columns @ theta) ** 2, axis=0))
    size = np.asarray(model.sigma, float)
    # A model of exact data has no residual: then a share of the torque is what counts.
    size = np.maximum(size, 1e-3 * np.maximum(torque, 1e-3 * torque.max() + 1e-12))
    factor = triangular_factor((columns / size[:, None]).reshape(-1, theta.size))
    base = find_base(factor, standard_parameter_names(robot))
    weight = triangular_factor(factor[:, base.kept])
    found = nearest_physical(
        base_matrix(base), base.reduce(theta), prior=bodies, weight=weight, pull=pull
    )
    moved = np.sqrt(np.mean((columns @ (theta - found.parameters.ravel())) ** 2, axis=0))
    links = robot.replace(parameters=jnp.asarray(found.parameters))
    whole = replace(model, robot=links, uncertainty=None)
    return PhysicalModel(whole, moved, torque, where, found.base_error)


def base_matrix(base: BaseParameters) -> np.ndarray:
    """Base parameters as combinations of all p parameters, (b, p)."""
    matrix = np.zeros((base.size, len(base.names)))
    matrix[np.arange(base.size), base.kept] = 1.0
    matrix[:, base.dropped] = base.merge
    return matrix


def further_of(values: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> Further:
    """Linear parameters besides the bodies, inside bounds a solver can use (not of zero width)."""
    room = np.maximum(upper, lower + 1e-12)
    return Further(np.clip(values, lower, room), lower, room)
