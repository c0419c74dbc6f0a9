"""Your optimizer: what it takes to write a part of one's own, in one place.

``jaxswarm`` exports these names too. An optimizer is a frozen dataclass made by :func:`pytree`, whose
numbers are leaves and whose sizes are :func:`static`, with ``init`` and ``update``; :func:`check_optimizer`
tells whether it keeps the contract. Registered by JAX 0.10 itself, two classes with the same fields may
be given each other's compiled programs (:mod:`jaxswarm.nodes`).

>>> from typing import Any, NamedTuple
>>> import jax, jax.numpy as jnp
>>> class WalkState(NamedTuple):
...     position: jax.Array  # (n, d) candidates to evaluate next
...     best_position: jax.Array
...     best_value: jax.Array
...     count: jax.Array
>>> @pytree
... class Walk:
...     '''Normal steps from the best candidate so far.'''
...
...     step: Any
...     num_particles: int = static()
...
...     def init(self, key, num_dims, dtype=None):
...         dtype = jnp.result_type(float if dtype is None else dtype)
...         position = Random(key).uniform("position", (self.num_particles, num_dims), dtype)
...         infinite = jnp.asarray(jnp.inf, dtype)
...         return WalkState(position, position[0], infinite, jnp.zeros((), jnp.int32))
...
...     def update(self, key, state, value):
...         value = comparable(value, state.position)
...         best = best_of(state.position, value, state.best_position, state.best_value)
...         position, lowest, improved = best
...         step = evaluate("step", self.step, state.count, position.dtype)
...         noise = Random(key).normal("step", state.position.shape, position.dtype)
...         info = candidate_info(state.position, value, lowest, improved, {"step": step})
...         moved = jnp.clip(position + step * noise, 0.0, 1.0)
...         return WalkState(moved, position, lowest, state.count + 1), info
>>> check_optimizer(Walk(coefficient("step", 0.1), 10), thorough=False)

A topology, a boundary and a velocity rule of ``pso`` are plain functions:

>>> from jaxswarm.swarm import pso
>>> def second_best(random, memory_position, memory_value):  # -> attractors (n, d)
...     leader = memory_position[jnp.argsort(memory_value)[1]]
...     return jnp.broadcast_to(leader, memory_position.shape)
>>> def wrap(random, position, velocity):  # -> positions in [0, 1], velocities
...     return position % 1.0, velocity
>>> def straight(random, swarm, hyper):  # a Swarm, coefficients by name -> velocities (n, d)
...     share = random.uniform("share", swarm.position.shape, swarm.position.dtype)
...     return hyper["inertia"] * swarm.velocity + share * (swarm.attractor - swarm.position)
>>> check_optimizer(pso(5, topology=second_best, boundary=wrap, rule=straight), thorough=False)
"""

from jaxswarm.swarm.contract import check_optimizer as check_optimizer
from jaxswarm.swarm.optimizers.base import Info as Info
from jaxswarm.swarm.optimizers.base import Optimizer as Optimizer
from jaxswarm.swarm.optimizers.base import State as State
from jaxswarm.swarm.optimizers.base import at_least as at_least
from jaxswarm.swarm.optimizers.base import best_of as best_of
from jaxswarm.swarm.optimizers.base import candidate_info as candidate_info
from jaxswarm.swarm.optimizers.base import comparable as comparable
from jaxswarm.swarm.optimizers.rules import Swarm as Swarm
from jaxswarm.swarm.pytree import as_part as as_part
from jaxswarm.swarm.pytree import pytree as pytree
from jaxswarm.swarm.pytree import replace as replace
from jaxswarm.swarm.pytree import static as static
from jaxswarm.swarm.random import Random as Random
from jaxswarm.swarm.random import fold as fold
from jaxswarm.swarm.schedules import coefficient as coefficient
from jaxswarm.swarm.schedules import evaluate as evaluate
from jaxswarm.swarm.standing import Progress as Progress
