r"""Particle swarms, assembled from parts: a topology, a velocity rule, a boundary, coefficients.

Each particle i carries a position x, a velocity v and the best position p it has seen. One update:

    p <- x where the value fell                                 memory
    g  = topology(p)                                            attractor
    v <- limit(rule(x, v, p, g; inertia, cognitive, social))    velocity
    x, v <- boundary(x + v, v)                                  position

The swarms of the literature (``published``) differ only in the parts they choose, as ``optax.adam`` is a
chain of transforms.

The defaults were chosen on BBOB. Of the targets in 5-D with 100 evaluations a dimension 40 free particles
between reflecting walls reached 0.13: twelve steps are too few, and most of these were wide. Half as many,
no wider than a fifth of the range, reach 0.17, and 0.20 where walls stop them, since an optimum on a wall is
then met and not only neared. In 20-D twenty collapse, so that it takes two a dimension, up to forty. Who
follows the best of all collapses, too, now and then even down a linear slope: four neighbors on a grid reach
0.425 in 5-D and 0.257 in 20-D with 1,000 evaluations a dimension, the best of all 0.385 and 0.234, and with
100 a dimension a little less, 0.194 and 0.100 in place of 0.207 and 0.105.

References:
    J. Kennedy, R. Eberhart, "Particle swarm optimization", ICNN 1995; Y. Shi, R. Eberhart, "A
    modified particle swarm optimizer", CEC 1998 (inertia); I. C. Trelea, "The particle swarm
    optimization algorithm: convergence analysis and parameter selection", Inf. Process. Lett. 85
    (2003), doi 10.1016/S0020-0190(02)00447-7 (default coefficients); A. Engelbrecht, "Particle
    swarm optimization: velocity initialization", CEC 2012 (a start at rest). The constriction values
    of M. Clerc and J. Kennedy (2002), 0.7298 and 1.49618, converge more slowly: with a budget of 300
    evaluations a dimension their median error was larger on most of the benchmark's problems.
"""

import dataclasses
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.swarm.lanes import laned
from jaxswarm.swarm.optimizers.base import at_least, candidate_info, comparable, dimensions, once
from jaxswarm.swarm.optimizers.boundaries import absorb, reflect
from jaxswarm.swarm.optimizers.rules import Swarm, canonical
from jaxswarm.swarm.optimizers.topologies import von_neumann
from jaxswarm.swarm.pytree import as_part, facts, pytree, static
from jaxswarm.swarm.random import Random, check_source
from jaxswarm.swarm.schedules import ScalarOrSchedule, coefficient, evaluate

__all__ = ["PSO", "PSOState", "default_particles", "pso"]

FEWEST, MOST = 20, 40
PER_DIMENSION = 2
"""Particles: few, so that there are steps to make, but two a dimension, so that they do not collapse."""


def default_particles(num_dims: int) -> int:
    """Return the particles of a swarm that was given no number."""
    return min(max(FEWEST, PER_DIMENSION * num_dims), MOST)


# Position and velocity are replaced coordinate by coordinate (see ``lanes``).
@facts(CARRIED_LANED=("position", "velocity"), MEMORY=("memory_position", "memory_value"))
class PSOState(NamedTuple):
    """State of a particle swarm: n particles in d dimensions.

    Attributes:
      position, velocity, memory_position: (n, d).
      memory_value: (n,) value at each memory, +inf before the first evaluation.
      best_position: (d,), best_value: ().
      graph: (2,) uint32, seed of a random topology; changes after a step without improvement.
      control: state of the control part, ``()`` without one.
      count: () int32, updates done.
    """

    position: jax.Array
    velocity: jax.Array
    memory_position: jax.Array
    memory_value: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    graph: jax.Array
    control: Any
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class PSO:
    """A particle swarm; build it with :func:`pso` or one of the named factories."""

    inertia: ScalarOrSchedule
    cognitive: ScalarOrSchedule
    social: ScalarOrSchedule
    velocity_limit: ScalarOrSchedule
    topology: Any
    boundary: Any
    rule: Any
    control: Any
    initial_velocity: float
    num_particles: int | None = static()
    random: str = static()
    usual_walls: bool = static(default=False)

    def among_constraints(self) -> "PSO":
        """The swarm for values that tell what is feasible: unless asked for, its walls are others.

        Walls that stop a particle end the search in a corner that is not feasible, all at rest: on CEC
        2006's G06 an epsilon level left 8 of 20 runs there, multipliers 16, reflecting walls none.
        """
        usual = self.usual_walls and self.boundary == absorb()
        return dataclasses.replace(self, boundary=reflect()) if usual else self

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> PSOState:
        """Uniform positions; velocities a share of the way to another such point, within the limit."""
        num_dims = dimensions(num_dims)
        dtype = jnp.result_type(float if dtype is None else dtype)
        shape = (self.num_particles or default_particles(num_dims), num_dims)
        random = Random(key, self.random)
        position = random.uniform("position", shape, dtype)
        limit = evaluate("velocity_limit", self.velocity_limit, 0, dtype)
        share = jnp.asarray(self.initial_velocity, dtype)
        velocity = share * (random.uniform("velocity", shape, dtype) - position)
        return PSOState(
            position=position,
            velocity=jnp.clip(velocity, -limit, limit),
            memory_position=position,
            memory_value=jnp.full(shape[:1], jnp.inf, dtype),
            best_position=position[0],
            best_value=jnp.asarray(jnp.inf, dtype),
            graph=random.bits("graph", (2,)),
            control=() if self.control is None else self.control.init(shape, dtype),
            count=jnp.zeros((), jnp.int32),
        )

    def update(self, key: jax.Array, state: PSOState, value: jax.Array):
        """Remember, attract, move; see the head of this file."""
        random, dtype = Random(key, self.random), state.position.dtype
        value = comparable(value, state.position)
        fell = value < state.memory_value
        memory_value = jnp.where(fell, value, state.memory_value)
        memory_position = jnp.where(fell[:, None], state.position, state.memory_position)
        leader = jnp.argmin(memory_value)
        improved = memory_value[leader] < state.best_value

        graph = jnp.where(improved, state.graph, random.bits("graph", (2,)))
        informants = Random(graph, self.random)

        def swarm():
            # A function: within ``once`` an attractor of all is spread where it is read, not written.
            return Swarm(
                position=state.position,
                velocity=state.velocity,
                memory_position=memory_position,
                attractor=self.topology(informants, memory_position, memory_value),
                value=value,
                improved=fell,
                memory_value=memory_value,
            )

        hyper = {
            name: evaluate(name, getattr(self, name), state.count, dtype)
            for name in ("inertia", "cognitive", "social", "velocity_limit")
        }
        control = state.control
        if self.control is not None:
            hyper, control = self.control(random, control, swarm(), hyper)

        def accelerate():
            limit = hyper["velocity_limit"]
            return laned(jnp.clip(self.rule(random, swarm(), hyper), -limit, limit))

        velocity = once(accelerate).reshape(state.position.shape)
        position, velocity = self.boundary(random, state.position + velocity, velocity)
        info = candidate_info(state.position, value, memory_value[leader], improved, hyper)
        state = PSOState(
            position=position,
            velocity=velocity,
            memory_position=memory_position,
            memory_value=memory_value,
            best_position=memory_position[leader],
            best_value=memory_value[leader],
            graph=graph,
            control=control,
            count=state.count + 1,
        )
        return state, info


def pso(
    num_particles: int | None = None,
    *,
    inertia: ScalarOrSchedule = 0.6,
    cognitive: ScalarOrSchedule = 1.7,
    social: ScalarOrSchedule = 1.7,
    velocity_limit: ScalarOrSchedule = 0.2,
    topology: Any = None,
    boundary: Any = None,
    rule: Any = None,
    control: Any = None,
    initial_velocity: float = 0.0,
    random: str = "hash",
) -> PSO:
    """Assemble a particle swarm; the default coefficients are Trelea's, on a torus grid.

    Args:
      num_particles: n, at least 2; default two a dimension, but 20 at least and 40 at most.
      inertia: w, share of the velocity that is kept.
      cognitive: c1, pull of the particle's own memory.
      social: c2, pull of the attractor.
      velocity_limit: largest step in any coordinate, in units of the unit cube; ``math.inf`` for none.
      topology: who listens to whom (``topologies``); default ``von_neumann()``.
      boundary: what happens at the walls (``boundaries``); ``absorb()``, ``reflect()`` if ``constrained``.
      rule: how velocities change (``rules``); default ``canonical()``.
      control: sets coefficients from the state of the swarm (``control``); default none.
      initial_velocity: share (0 to 1) of the way to another uniform point with which a particle
        starts: 1/2 in SPSO 2006. From rest fewer particles are thrown against the walls at first.
      random: ``"hash"`` or ``"threefry"``.

    Returns:
      An optimizer whose coefficients are leaves: change them with ``dataclasses.replace`` or map
      over them with ``jax.vmap`` without compiling again.

    Raises:
      InputError: too few particles, a coefficient that is no number and no schedule.

    >>> optimizer = pso(20, inertia=0.5)
    >>> state = optimizer.init(jax.random.key(0), 3)
    >>> state, info = optimizer.update(jax.random.key(1), state, jnp.sum(state.position**2, axis=1))
    >>> state.position.shape, float(info.hyper["inertia"])
    ((20, 3), 0.5)
    """
    if num_particles is not None:
        why = "particles learn from each other"
        num_particles = at_least("num_particles", num_particles, 2, why)
    return PSO(
        num_particles=num_particles,
        inertia=coefficient("inertia", inertia),
        cognitive=coefficient("cognitive", cognitive),
        social=coefficient("social", social),
        velocity_limit=coefficient("velocity_limit", velocity_limit, lower=0.0),
        topology=as_part(topology or von_neumann()),
        boundary=as_part(boundary or absorb()),
        rule=as_part(rule or canonical()),
        control=control,
        initial_velocity=coefficient("initial_velocity", initial_velocity, lower=0.0, upper=1.0),
        random=check_source(random),
        usual_walls=boundary is None,
    )
