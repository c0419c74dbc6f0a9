r"""The state of a particle swarm and its step, whatever its parts (``pso`` chooses them).

Each particle i carries a position x, a velocity v and the best position p it has seen. One update:

    p <- x where the value fell                                 memory
    g  = topology(p)                                            attractor
    v <- limit(rule(x, v, p, g; inertia, cognitive, social))    velocity
    x, v <- boundary(x + v, v)                                  position

A swarm that may begin anew does so in the step in which it is found at rest (``rest``).
"""

import dataclasses
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError
from jaxswarm.swarm.calling import check_shape
from jaxswarm.swarm.lanes import laned
from jaxswarm.swarm.optimizers.base import candidate_info, comparable, dimensions, once
from jaxswarm.swarm.optimizers.boundaries import absorb, reflect
from jaxswarm.swarm.optimizers.rest import ANOTHER, PATIENCE, renewed
from jaxswarm.swarm.optimizers.rules import Swarm
from jaxswarm.swarm.pytree import facts, pytree, static
from jaxswarm.swarm.random import Random, fold
from jaxswarm.swarm.schedules import ScalarOrSchedule, evaluate

__all__ = ["BOUNDARY", "PSO", "PSOState", "RULE", "TOPOLOGY", "default_particles", "within"]

TOPOLOGY = ("random", "memory_position", "memory_value")
RULE = ("random", "swarm", "hyper")
BOUNDARY = ("random", "position", "velocity")
"""What the parts of a swarm are called with."""
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
      idle: () int32, updates since a particle last improved its memory.
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
    idle: jax.Array
    control: Any
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


def within(boundary: Any, random: Random, position: jax.Array, velocity: jax.Array):
    """Positions and velocities (n, d) as a boundary gives them, checked."""
    moved = boundary(random, position, velocity)
    if not (isinstance(moved, tuple | list) and len(moved) == 2):
        raise InputError(f"boundary returned {type(moved).__name__}: return (position, velocity).")
    return tuple(check_shape("boundary", one, position.shape) for one in moved)


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
    renew: bool = static()
    usual_walls: bool = static(default=False)

    def for_one_life(self) -> "PSO":
        """The same for who begins it anew from without, as ``restart`` does."""
        return dataclasses.replace(self, renew=False)

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
            idle=jnp.zeros((), jnp.int32),
            control=() if self.control is None else self.control.init(shape, dtype),
            count=jnp.zeros((), jnp.int32),
        )

    def update(self, key: jax.Array, state: PSOState, value: jax.Array):
        """Remember, attract, move; begin anew at rest; see the head of this file."""
        random, dtype = Random(key, self.random), state.position.dtype
        shape = state.position.shape
        value = comparable(value, state.position)
        fell = value < state.memory_value
        memory_value = jnp.where(fell, value, state.memory_value)
        memory_position = jnp.where(fell[:, None], state.position, state.memory_position)
        leader = jnp.argmin(memory_value)
        improved = memory_value[leader] < state.best_value
        # Only of a swarm that began anew the best is not among what it remembers.
        remembered = memory_value[leader] <= state.best_value
        best_position = jnp.where(remembered, memory_position[leader], state.best_position)
        best_value = jnp.where(remembered, memory_value[leader], state.best_value)
        idle = jnp.where(fell.any(), 0, state.idle + 1)

        graph = jnp.where(improved, state.graph, random.bits("graph", (2,)))
        informants = Random(graph, self.random)

        def swarm():
            # A function: within ``once`` an attractor of all is spread where it is read, not written.
            return Swarm(
                position=state.position,
                velocity=state.velocity,
                memory_position=memory_position,
                attractor=check_shape(
                    "topology", self.topology(informants, memory_position, memory_value), shape
                ),
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
            ruled = check_shape("rule", self.rule(random, swarm(), hyper), shape)
            return laned(jnp.clip(ruled, -limit, limit))

        velocity = once(accelerate).reshape(shape)
        moved = within(self.boundary, random, state.position + velocity, velocity)
        position, velocity = moved
        info = candidate_info(state.position, value, best_value, improved, hyper)
        new = PSOState(
            position=position,
            velocity=velocity,
            memory_position=memory_position,
            memory_value=memory_value,
            best_position=best_position,
            best_value=best_value,
            graph=graph,
            idle=idle,
            control=control,
            count=state.count + 1,
        )
        if self.renew:
            new = renewed(new.idle >= PATIENCE, lambda: self._another(key, new), new)
        return new, info

    def _another(self, key, old):
        """A swarm that knows nothing of the last one; the best of all, and the schedules, stay."""
        fresh = self.init(fold(key, ANOTHER), *old.position.shape[1:], old.position.dtype)
        kept = {name: getattr(old, name) for name in ("best_position", "best_value", "count")}
        return fresh._replace(**kept)
