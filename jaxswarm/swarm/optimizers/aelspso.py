"""AELSPSO: adaptive inertia by evolutionary state estimation, and elitist learning of the leader.

Nothing new is computed here: the swarm of ``pso`` with the control ``evolutionary_control``, in the
wrapper ``elitist_learning``. What the RX60 paper leaves open is an option, with the paper's reading
as
default: the gate (none, or only in the convergence state as in APSO), what a failed trial does
(nothing, or replace the worst particle as in APSO), distances in the unit cube or in units of the
parameters, and constant or adaptive c1 and c2.

Reference:
    Z.-H. Zhan, J. Zhang, Y. Li, H. S.-H. Chung, "Adaptive particle swarm optimization", IEEE Trans.
    Syst. Man Cybern. B 39 (2009), doi 10.1109/TSMCB.2009.2015956.
"""

from typing import Any

from jaxswarm.errors import InputError, nearest
from jaxswarm.swarm.optimizers.boundaries import reflect
from jaxswarm.swarm.optimizers.control import converged, evolutionary_control
from jaxswarm.swarm.optimizers.elitist_learning import ElitistLearning, elitist_learning
from jaxswarm.swarm.optimizers.pso import pso
from jaxswarm.swarm.optimizers.rules import canonical
from jaxswarm.swarm.optimizers.topologies import global_best
from jaxswarm.swarm.schedules import linear

__all__ = ["aelspso"]

GATES = ("none", "convergence")


def aelspso(
    num_particles: int = 24,
    num_steps: float | None = None,
    *,
    gate: str = "none",
    on_failure: str = "discard",
    adapt_coefficients: bool = False,
    scale: Any = None,
    random: str = "hash",
    **parts: Any,
) -> ElitistLearning:
    """Adaptive elitist-learning PSO of the RX60 paper; each step evaluates ``num_particles + 1``.

    Args:
      num_particles: n, at least 2; the learning trial of the leader comes on top.
      num_steps: updates over which the size of a trial falls from 1.0 to 0.1 of the range; default
        as many as ``minimize`` makes (2000 where nobody says it).
      gate: when the leader learns: ``"none"`` always, ``"convergence"`` as in APSO.
      on_failure: what becomes of a trial that is not better: ``"discard"``, ``"replace worst"``.
      adapt_coefficients: let c1 and c2 follow the evolutionary state, else both are 2.
      scale: (d,) factors for distances in units of the parameters, ``space.upper - space.lower``.
      random: ``"hash"`` or ``"threefry"``.
      **parts: keyword arguments of ``pso``, which override the choices made here.

    >>> import jax
    >>> aelspso(24).init(jax.random.key(0), 13).position.shape
    (25, 13)
    """
    if gate not in GATES:
        raise InputError(f"gate={gate!r} is unknown. {nearest(str(gate), GATES)}")
    control = evolutionary_control(adapt_coefficients=adapt_coefficients, scale=scale)
    chosen: dict[str, Any] = dict(inertia=0.9, cognitive=2.0, social=2.0)
    chosen |= dict(velocity_limit=0.2, initial_velocity=0.5, topology=global_best())
    chosen |= dict(boundary=reflect(0.5), control=control)
    chosen |= dict(rule=canonical(), renew=False)
    swarm = pso(num_particles, random=random, **(chosen | parts))
    return elitist_learning(
        swarm,
        linear(1.0, 0.1, num_steps, by_hand=2000.0),
        gate=converged(scale) if gate == "convergence" else None,
        on_failure=on_failure,
        random=random,
    )
