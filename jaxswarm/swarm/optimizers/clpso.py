r"""Comprehensive learning PSO: every coordinate of a particle learns from its own exemplar.

    v_ij <- w v_ij + c r_ij (p_{e(i,j), j} - x_ij)

The exemplar e(i, j) is, with probability Pc_i, the better of two other particles drawn at random,
else i itself; if all are i itself, one coordinate learns from another particle. Exemplars are drawn
anew after ``refresh`` updates without improvement of particle i. Pc_i = 0.05 + 0.45 (exp(10
i/(n-1)) - 1)/(exp(10) - 1) for i = 0 ... n-1. Slow and steady: made for many local optima.

Reference:
    J. J. Liang, A. K. Qin, P. N. Suganthan, S. Baskar, "Comprehensive learning particle swarm
    optimizer for global optimization of multimodal functions", IEEE Trans. Evol. Comput. 10 (2006),
    doi 10.1109/TEVC.2005.857610.

Deviation: the paper lets particles leave the bounds and does not evaluate them there; here the
boundary part brings them back, so that every evaluation counts.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.swarm.optimizers.base import at_least
from jaxswarm.swarm.optimizers.boundaries import reflect
from jaxswarm.swarm.optimizers.particles import PSO
from jaxswarm.swarm.optimizers.pso import pso
from jaxswarm.swarm.optimizers.topologies import global_best
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.schedules import BY_HAND, coefficient, linear, run_length

__all__ = ["clpso"]


def clpso(
    num_particles: int = 40,
    num_steps: float | None = None,
    *,
    refresh: float | None = None,
    **parts: Any,
) -> PSO:
    """Comprehensive learning PSO with w from 0.9 to 0.4, c = 1.49445, velocity limit 20 %.

    Args:
      num_particles: n, at least 3.
      num_steps: updates over which the inertia falls; default as many as ``minimize`` makes.
      refresh: updates without improvement after which a particle chooses new exemplars. The default
        is the paper's 7 from 3500 updates on and less below, down to none: in 100 to 1000 updates
        a gap of 7 left medians up to 1e8 times larger on the benchmark's smooth problems, and
        gained nothing on those with many optima.
      **parts: keyword arguments of :func:`pso`, which override the choices made here; ``social``
        and ``topology`` have no effect.
    """
    at_least("num_particles", num_particles, 3, "each particle compares two others")
    inertia = linear(0.9, 0.4, num_steps)
    chosen: dict[str, Any] = dict(
        inertia=inertia,
        cognitive=1.49445,
        velocity_limit=0.2,
        topology=global_best(),
        boundary=reflect(0.5),
        initial_velocity=0.5,
        renew=False,
        control=Exemplars(
            Gap(*run_length(num_steps, BY_HAND))
            if refresh is None
            else coefficient("refresh", refresh, lower=0.0)
        ),
        rule=ComprehensiveLearning(),
    )
    return pso(num_particles, **(chosen | parts))


class ExemplarState(NamedTuple):
    """Exemplar of every coordinate (n, d) int32, and failures since it was chosen (n,) int32."""

    exemplar: jax.Array
    failures: jax.Array


@pytree
class Gap:
    """Updates without improvement before new exemplars: 7 from 3500 updates on, none below 500."""

    num_steps: Any
    of_run: bool = static(default=False)

    def __call__(self):
        return jnp.minimum(7.0, jnp.floor(self.num_steps / 500.0))

    def __float__(self):
        return float(self())


@pytree
class Exemplars:
    """Control that chooses the exemplars and passes them to the rule."""

    refresh: float | Gap

    def init(self, shape, dtype):
        """Failures without bound, so that the first update chooses."""
        return ExemplarState(
            jnp.zeros(shape, jnp.int32), jnp.full(shape[:1], np.iinfo(np.int32).max // 2, jnp.int32)
        )

    def __call__(self, random, state, swarm, hyper):
        (n, d), dtype = swarm.position.shape, swarm.position.dtype
        # The first update improves every particle, yet must choose: failures start out huge.
        fresh = state.failures > np.iinfo(np.int32).max // 4
        failures = jnp.where(swarm.improved & ~fresh, 0, state.failures + 1)
        gap = self.refresh() if callable(self.refresh) else self.refresh
        renew = failures.astype(dtype) >= jnp.asarray(gap, dtype)

        own = jnp.arange(n, dtype=jnp.int32)[:, None]
        rivals = random.integers("rivals", (2, n, d), n - 1)
        rivals = rivals + (rivals >= own[None]).astype(jnp.int32)
        first, second = swarm.memory_value[rivals[0]], swarm.memory_value[rivals[1]]
        winner = jnp.where(first < second, rivals[0], rivals[1])
        curve = np.expm1(10.0 * np.arange(n) / (n - 1)) / np.expm1(10.0)
        probability = jnp.asarray(0.05 + 0.45 * curve, dtype)
        learn = random.uniform("learn", (n, d), dtype) < probability[:, None]
        forced = random.integers("forced", (n, 1), d) == jnp.arange(d, dtype=jnp.int32)[None]
        learn = learn | (~learn.any(axis=1, keepdims=True) & forced)
        chosen = jnp.where(learn, winner, own)

        exemplar = jnp.where(renew[:, None], chosen, state.exemplar)
        state = ExemplarState(exemplar, jnp.where(renew, 0, failures))
        return hyper | {"exemplar": exemplar}, state


@pytree
class ComprehensiveLearning:
    """Velocity rule; needs the control :class:`Exemplars`."""

    def __call__(self, random, swarm, hyper):
        shape, dtype = swarm.position.shape, swarm.position.dtype
        target = jnp.take_along_axis(swarm.memory_position, hyper["exemplar"], axis=0)
        pull = random.uniform("cognitive", shape, dtype) * (target - swarm.position)
        return hyper["inertia"] * swarm.velocity + hyper["cognitive"] * pull
