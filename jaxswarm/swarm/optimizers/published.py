"""Particle swarms as they were published: each a choice of the parts of :func:`pso`.

As in print they rest once they have converged; ``renew=True`` lets them begin anew.
"""

import math
from typing import Any

from jaxswarm.swarm.optimizers.boundaries import absorb, bounce, reflect
from jaxswarm.swarm.optimizers.particles import PSO
from jaxswarm.swarm.optimizers.pso import pso
from jaxswarm.swarm.optimizers.rules import canonical, spherical
from jaxswarm.swarm.optimizers.topologies import global_best, random_informants
from jaxswarm.swarm.schedules import linear

__all__ = ["gpso", "spso", "spso2011"]


def spso(num_particles: int = 40, **parts: Any) -> PSO:
    """Plain inertia-weight PSO with the coefficients of SPSO 2006/2007 and a global best.

    w = 1/(2 ln 2), c1 = c2 = 1/2 + ln 2, absorbing walls, starting velocities half the way to another
    point. Reading of "SPSO" in the first paper: plain inertia PSO. SPSO 2007 proper is
    ``spso(topology=random_informants(3))``.

    Args:
      num_particles: n, at least 2.
      **parts: keyword arguments of :func:`pso`, which override the choices made here.
    """
    c = 0.5 + math.log(2.0)
    chosen: dict[str, Any] = dict(
        inertia=0.5 / math.log(2.0), cognitive=c, social=c, velocity_limit=math.inf
    )
    chosen |= dict(topology=global_best(), boundary=absorb(), rule=canonical())
    chosen |= dict(initial_velocity=0.5, renew=False)
    return pso(num_particles, **(chosen | parts))


def gpso(num_particles: int = 24, num_steps: float | None = None, **parts: Any) -> PSO:
    """Global-best PSO of the RX60 paper: inertia falls linearly, velocities are limited.

    w from 0.9 to 0.4 over ``num_steps``, c1 = c2 = 2, velocity limit 20 % of the range. The swarm
    size is that of the toolbox the authors likely used (a reconstruction).

    Args:
      num_particles: n, at least 2.
      num_steps: updates over which the inertia falls; default as many as ``minimize`` makes (the
        toolbox's 2000 where nobody says it).
      **parts: keyword arguments of :func:`pso`, which override the choices made here.
    """
    chosen: dict[str, Any] = dict(
        inertia=linear(0.9, 0.4, num_steps, by_hand=2000.0),
        cognitive=2.0,
        social=2.0,
        velocity_limit=0.2,
        topology=global_best(),
        boundary=reflect(0.5),
        initial_velocity=0.5,
        rule=canonical(),
        renew=False,
    )
    return pso(num_particles, **(chosen | parts))


def spso2011(num_particles: int = 40, **parts: Any) -> PSO:
    """Standard PSO 2011: rotation-invariant ball rule, three random informants, half-elastic walls.

    Args:
      num_particles: n, at least 2.
      **parts: keyword arguments of :func:`pso`, which override the choices made here.

    Reference:
      M. Zambrano-Bigiarini, M. Clerc, R. Rojas, "Standard Particle Swarm Optimisation 2011 at
      CEC-2013", doi 10.1109/CEC.2013.6557848.
    """
    c = 0.5 + math.log(2.0)
    chosen: dict[str, Any] = dict(
        inertia=0.5 / math.log(2.0), cognitive=c, social=c, rule=spherical()
    )
    chosen |= dict(topology=random_informants(3), boundary=bounce(0.5))
    chosen |= dict(initial_velocity=0.5, velocity_limit=math.inf, renew=False)
    return pso(num_particles, **(chosen | parts))
