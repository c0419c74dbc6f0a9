"""Particle swarms, assembled from parts: a topology, a velocity rule, a boundary, coefficients.

The step stands in :mod:`~jaxswarm.swarm.optimizers.particles`. The swarms of the literature
(``published``) differ only in the parts they choose, as ``optax.adam`` is a chain of transforms.

The defaults were chosen on BBOB. Of the targets in 5-D with 100 evaluations a dimension 40 free particles
between reflecting walls reached 0.13: twelve steps are too few, and most of these were wide. Half as many,
no wider than a fifth of the range, reach 0.17, and 0.20 where walls stop them, since an optimum on a wall is
then met and not only neared. In 20-D twenty collapse, so that it takes two a dimension, up to forty. Who
follows the best of all collapses, too, now and then even down a linear slope: four neighbors on a grid reach
0.425 in 5-D and 0.257 in 20-D with 1,000 evaluations a dimension, the best of all 0.385 and 0.234, and with
100 a dimension a little less, 0.194 and 0.100 in place of 0.207 and 0.105.

A swarm is at rest when for 50 updates no particle has improved its memory: particles have met, or swing
between memories that hold each other. It then begins anew, another swarm of the same parts that knows
nothing of the last one; the best candidate of all is kept. BBOB in 2-D, 5-D and 20-D with 10,000 evaluations
a dimension ended at 0.836, 0.450 and 0.316 of the targets without that, at 0.871, 0.531 and 0.339 with it
(instances 1-15, in 20-D 1-4), with 1,000 a dimension the same. The idea of restarts is that of ``restart``.
Swarms as they were published (``published``, ``clpso``, ``aelspso``, ``sepso``) rest.

All these figures are with random numbers of its own for every coordinate; what fewer do in few dimensions, and
theirs, stands with ``rules.paired``.

References:
    J. Kennedy, R. Eberhart, "Particle swarm optimization", ICNN 1995; Y. Shi, R. Eberhart, "A
    modified particle swarm optimizer", CEC 1998 (inertia); I. C. Trelea, "The particle swarm
    optimization algorithm: convergence analysis and parameter selection", Inf. Process. Lett. 85
    (2003), doi 10.1016/S0020-0190(02)00447-7 (default coefficients); A. Engelbrecht, "Particle
    swarm optimization: velocity initialization", CEC 2012 (a start at rest). The constriction values
    of M. Clerc and J. Kennedy (2002), 0.7298 and 1.49618, converge more slowly: with a budget of 300
    evaluations a dimension their median error was larger on most of the benchmark's problems.
"""

from typing import Any

from jaxswarm.swarm.calling import part_of
from jaxswarm.swarm.optimizers.base import at_least
from jaxswarm.swarm.optimizers.boundaries import absorb
from jaxswarm.swarm.optimizers.particles import BOUNDARY, PSO, RULE, TOPOLOGY
from jaxswarm.swarm.optimizers.rules import paired
from jaxswarm.swarm.optimizers.topologies import von_neumann
from jaxswarm.swarm.random import check_source
from jaxswarm.swarm.schedules import ScalarOrSchedule, coefficient

__all__ = ["pso"]


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
    renew: bool = True,
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
      rule: how velocities change (``rules``); default ``paired()``.
      control: sets coefficients from the state of the swarm (``control``); default none.
      initial_velocity: share (0 to 1) of the way to another uniform point (1/2 in SPSO 2006); from
        rest fewer particles are thrown against the walls at first.
      random: ``"hash"`` or ``"threefry"``.
      renew: whether a swarm at rest begins anew; schedules go on.

    Returns:
      An optimizer whose coefficients are leaves: change or map over them without compiling again.

    Raises:
      InputError: too few particles, a coefficient that is no number and no schedule, a part that takes
        something else.

    >>> import jax
    >>> pso(20, inertia=0.5).init(jax.random.key(0), 3).position.shape
    (20, 3)
    """
    if num_particles is not None:
        num_particles = at_least("num_particles", num_particles, 2, "particles learn from others")
    return PSO(
        num_particles=num_particles,
        inertia=coefficient("inertia", inertia),
        cognitive=coefficient("cognitive", cognitive),
        social=coefficient("social", social),
        velocity_limit=coefficient("velocity_limit", velocity_limit, lower=0.0),
        topology=part_of("topology", topology or von_neumann(), *TOPOLOGY),
        boundary=part_of("boundary", boundary or absorb(), *BOUNDARY),
        rule=part_of("rule", rule or paired(), *RULE),
        control=control,
        initial_velocity=coefficient("initial_velocity", initial_velocity, lower=0.0, upper=1.0),
        random=check_source(random),
        renew=bool(renew),
        usual_walls=boundary is None,
    )
