r"""Coefficients from the state of the swarm: evolutionary state estimation of APSO.

With d_i the mean distance of particle i to all others and d_g that of the leader, the evolutionary
factor and the inertia it sets are

    f = (d_g - d_min) / (d_max - d_min)  in [0, 1],        w(f) = 1 / (1 + 1.5 exp(-2.6 f)).

A leader far from the rest (f near 1) means the swarm has to move, one amid the rest (f near 0) that
it has converged. As an option c1 and c2 follow the estimated state as well.

A control is a pytree with ``init(shape, dtype) -> state`` and
``(random, state, swarm, hyper) -> (hyper, state)``.

Reference:
    Z.-H. Zhan, J. Zhang, Y. Li, H. S.-H. Chung, "Adaptive particle swarm optimization", IEEE Trans.
    Syst. Man Cybern. B 39 (2009), doi 10.1109/TSMCB.2009.2015956.
"""

from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.swarm.optimizers.products import over_columns
from jaxswarm.swarm.pytree import pytree, static

__all__ = ["converged", "evolutionary_control", "evolutionary_factor"]

EXPLORATION, EXPLOITATION, CONVERGENCE, JUMPING_OUT = range(4)
# f at which the membership of convergence equals that of exploitation: -5 f + 1.5 = 10 f - 2.
CONVERGED_BELOW = 3.5 / 15.0


def evolutionary_factor(position: jax.Array, leader: jax.Array, scale: Any = None) -> jax.Array:
    """Return f in [0, 1]: where the leader stands among the mean distances of the swarm.

    Args:
      position: (n, d) of the unit cube.
      leader: (d,) position of the leader.
      scale: (d,) factors of the coordinates, e.g. ``space.upper - space.lower`` for distances in
        the units of the parameters; default none, distances in the unit cube.

    Returns:
      Scalar; 0 where all distances are equal.
    """
    scale = 1.0 if scale is None else jnp.asarray(scale, position.dtype)[None]
    center = position.mean(axis=0, keepdims=True)
    x, g = (position - center) * scale, (leader[None] - center) * scale
    others = position.shape[0] - 1
    # A product with ones: XLA on a CPU is slow to reduce what it computes in the same loop.
    ones = jnp.ones(position.shape[0], x.dtype)
    distance = jnp.matmul(_distances(x, x), ones, precision="highest") / others
    leading = jnp.sum(_distances(g, x)) / others
    low, high = distance.min(), distance.max()
    equal = high <= low
    return jnp.where(
        equal, 0.0, jnp.clip((leading - low) / jnp.where(equal, 1.0, high - low), 0, 1)
    )


def evolutionary_control(*, adapt_coefficients: bool = False, scale: Any = None):
    """Inertia w(f) from the evolutionary factor; with ``adapt_coefficients`` also c1 and c2.

    Args:
      adapt_coefficients: move c1 and c2 (from 2, within [1.5, 2.5], sum at most 4) by the rules of
        APSO for its four states; the RX60 paper keeps them constant.
      scale: see :func:`evolutionary_factor`.
    """
    return EvolutionaryControl(scale=scale, adapt_coefficients=bool(adapt_coefficients))


def converged(scale: Any = None) -> "Converged":
    """Gate for ``elitist_learning``: open while the swarm is in the convergence state of APSO."""
    return Converged(scale)


@pytree
class EvolutionaryControl:
    """See :func:`evolutionary_control`."""

    scale: Any
    adapt_coefficients: bool = static()

    def init(self, shape, dtype):
        """State: the estimated state, c1 and c2."""
        if not self.adapt_coefficients:
            return ()
        two = jnp.asarray(2.0, dtype)
        return jnp.asarray(EXPLORATION, jnp.int32), two, two

    def __call__(self, random, state, swarm, hyper):
        leader = swarm.position[jnp.argmin(swarm.memory_value)]
        factor = evolutionary_factor(swarm.position, leader, self.scale)
        inertia = 1.0 / (1.0 + 1.5 * jnp.exp(-2.6 * factor))
        hyper = hyper | {"inertia": inertia, "evolutionary_factor": factor}
        if not self.adapt_coefficients:
            return hyper, state
        state = _adapt(random, state, factor)
        return hyper | {"cognitive": state[1], "social": state[2]}, state


@pytree
class Converged:
    """See :func:`converged`."""

    scale: Any

    def __call__(self, state):
        f = evolutionary_factor(state.position, state.best_position, self.scale)
        return f < CONVERGED_BELOW


def _adapt(random, state, factor):
    previous, c1, c2 = state
    membership = jnp.stack(
        [
            jnp.clip(jnp.minimum(5.0 * factor - 2.0, 8.0 - 10.0 * factor), 0.0, 1.0),
            jnp.clip(jnp.minimum(10.0 * factor - 2.0, 3.0 - 5.0 * factor), 0.0, 1.0),
            jnp.clip(1.5 - 5.0 * factor, 0.0, 1.0),
            jnp.clip(5.0 * factor - 3.5, 0.0, 1.0),
        ]
    )
    # Where two states are possible: stay, else go on in the order S1 -> S2 -> S3 -> S4 -> S1.
    states = jnp.arange(4, dtype=jnp.int32)
    stay, go = states == previous, states == (previous + 1) % 4
    bonus = jnp.where(stay, 2.0, jnp.where(go, 1.0, 0.0))
    current = jnp.argmax(membership + jnp.where(membership > 0.0, bonus, 0.0)).astype(jnp.int32)
    step = 0.05 + 0.05 * random.uniform("acceleration", (2,), c1.dtype)
    c1 = c1 + jnp.asarray([1.0, 0.5, 0.5, -1.0], c1.dtype)[current] * step[0]
    c2 = c2 + jnp.asarray([-1.0, -0.5, 0.5, 1.0], c1.dtype)[current] * step[1]
    c1, c2 = jnp.clip(c1, 1.5, 2.5), jnp.clip(c2, 1.5, 2.5)
    shrink = jnp.minimum(1.0, 4.0 / (c1 + c2))
    return current, c1 * shrink, c2 * shrink


def _distances(a, b):
    """Euclidean distances (n, m), by the product form: no (n, m, d) array."""
    square = jnp.sum(a**2, 1)[:, None] + jnp.sum(b**2, 1)[None] - 2.0 * over_columns(a, b)
    return jnp.sqrt(jnp.maximum(square, 0.0))
