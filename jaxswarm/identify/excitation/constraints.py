"""What a planned motion keeps beside its own limits: torques, and the distance of the links from each other.

Both depend on all joints at once, so that no motion can be scaled to them in closed form: a search counts a
motion that crosses them as worse than every one that does not, and what it finds is made smaller until it
keeps them on samples far denser than the search's.
"""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.identify.excitation.columns import Planned, planned_torque
from jaxswarm.identify.excitation.fourier import Fourier
from jaxswarm.identify.excitation.limits import Limits
from jaxswarm.identify.forward.columns import Moved
from jaxswarm.robot.capsules import BASE, Capsules, distances
from jaxswarm.robot.model import Robot

# Larger than any logarithm of a condition number and any separation: a motion out of bounds is worse.
PENALTY = 1e3
# What one meter too close counts against torque that is twice its limit.
_PER_METER = 10.0
# Samples of a period for each harmonic on which the result is looked at.
_DENSE = 200
# Halvings of the amplitude's bracket: to a thousandth of it.
_HALVINGS = 10


@dataclass(frozen=True)
class Constraints:
    """What a motion has to keep.

    Attributes:
        robot: With its masses, where torques are kept.
        effort: Largest torque or force of each joint [N m or N], (n,), infinite where none is known.
        terms: Effects with values, beside the rigid body.
        capsules: The space the links fill; None: their distance is not asked for.
        pairs: Which capsules have to stay apart, (P, 2).
        distance: How far [m].
    """

    robot: Robot
    effort: np.ndarray
    terms: tuple[Term, ...] = ()
    capsules: Capsules | None = None
    pairs: np.ndarray | None = None
    distance: float = 0.0

    def torques(self, limits: Limits, motion: Planned, period: float) -> jax.Array:
        """Torque or force of every joint along a motion of arrays (n, K), (n, K)."""
        return planned_torque(self.robot, self.terms, limits, *motion, period)

    def nearest(self, q: jax.Array) -> jax.Array:
        """Distance of each pair of capsules along positions (n, K), shape (K, P) [m]."""
        assert self.capsules is not None and self.pairs is not None
        capsules, pairs = self.capsules, self.pairs
        return jax.vmap(lambda x: distances(self.robot, capsules, pairs, x), in_axes=1)(q)

    def excess(self, limits: Limits, motion: tuple, period: float) -> jax.Array:
        """How far the motion is beyond what it has to keep, a number; zero or less: it keeps all."""
        parts = [jnp.asarray(-jnp.inf)]
        if np.isfinite(self.effort).any():
            used = jnp.abs(self.torques(limits, motion, period)).max(axis=1) / self.effort
            parts.append(used.max() - 1.0)
        if self.capsules is not None:
            parts.append(_PER_METER * (self.distance - self.nearest(motion[0]).min()))
        return jnp.stack(parts).max()


def excess_along(
    constraints: Constraints | None, limits: Limits, motion: tuple, period: float
) -> jax.Array:
    """How far a motion of arrays (n, K) is beyond what it has to keep; of nothing, it always keeps all."""
    nothing = jnp.asarray(-jnp.inf)
    return nothing if constraints is None else constraints.excess(limits, motion, period)


def penalized(value, excess):
    """A value where a motion keeps everything, else one worse than any by how far it is beyond.

    >>> penalized(np.array([2.0, 1.0]), np.array([-0.5, 0.25])).tolist()
    [2.0, 1000.25]
    """
    return jnp.where(excess > 0.0, PENALTY + excess, value)


def kept(trajectory: Fourier, constraints: Constraints | None, limits: Limits) -> Fourier:
    """The motion itself where it keeps everything, else the largest one of its shape that does.

    Raises:
        InputError: If not even the place in the middle of the motion keeps everything.
    """
    if constraints is None:
        return trajectory
    excess = excess_of(constraints, limits)
    if excess(trajectory) <= 0.0:
        return trajectory
    if excess(trajectory.smaller(0.0)) > 0.0:
        raise InputError(
            f"no motion was found that keeps {_crossed(trajectory.smaller(0.0), constraints, limits)}: "
            "widen the limits, give another range of positions, or correct masses and shapes"
        )
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if excess(trajectory.smaller(middle)) > 0.0 else (middle, high)
    return trajectory.smaller(low)


def dense(trajectory: Fourier, limits: Limits) -> tuple[Moved, float]:
    """One period of a motion, each (n, K), on the samples that are written at least; its length [s]."""
    period = 1.0 / trajectory.fundamental
    samples = max(_DENSE * limits.harmonics, int(np.ceil(period * limits.rate)))
    q, dq, ddq = trajectory.motion(np.arange(samples) * period / samples)
    return (q.T, dq.T, ddq.T), period


def excess_of(constraints: Constraints, limits: Limits) -> Callable[[Fourier], float]:
    """A function that gives the excess of a motion on dense samples, compiled once."""
    compiled = jax.jit(lambda motion, period: constraints.excess(limits, motion, period))
    return lambda trajectory: float(compiled(*dense(trajectory, limits)))


def _crossed(trajectory: Fourier, constraints: Constraints, limits: Limits) -> str:
    """What a motion crosses most, in words."""
    motion, period = dense(trajectory, limits)
    joints = constraints.robot.joints
    torque = np.abs(np.asarray(constraints.torques(limits, motion, period))).max(axis=1)
    worst = int((torque / constraints.effort).argmax())
    if torque[worst] > constraints.effort[worst]:
        return (
            f"the torque limit of {joints[worst]}, {constraints.effort[worst]:.4g}: "
            f"{torque[worst]:.4g} are needed to hold it"
        )
    near, pair = closest(constraints, motion[0])
    return f"{' and '.join(pair)} {constraints.distance:g} m apart: they are at {near:.3g} m"


def closest(constraints: Constraints, q: np.ndarray) -> tuple[float, tuple[str, str]]:
    """Least distance along positions (n, K) [m], and the links that have it."""
    assert constraints.capsules is not None and constraints.pairs is not None
    near = np.asarray(constraints.nearest(jnp.asarray(q))).min(axis=0)
    worst = int(near.argmin())
    one, two = (
        link_name(constraints.robot, constraints.capsules.link[k]) for k in constraints.pairs[worst]
    )
    return float(near[worst]), (one, two)


def link_name(robot: Robot, link: int) -> str:
    """A link by the joint that carries it."""
    return "base" if link == BASE else f"link of {robot.joints[link]}"
