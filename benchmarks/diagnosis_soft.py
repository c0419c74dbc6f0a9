"""Closed-loop runs of arms whose links move apart from their motors."""

import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.synthetic import fourier_motion
from jaxswarm.logs.log import Log
from jaxswarm.robot import Robot
from jaxswarm.simulate import PD, Reference, make_plant, rest, stable_substeps, track

# Sampling rate of the logs [Hz], and of the controller in multiples of it; time [s] that is left out.
RATE, FASTER = 250.0, 10
SETTLED = 1.0


def closed_loop(
    arm: Robot, terms: tuple[Term, ...], width: float, seed: int
) -> tuple[Log, tuple[np.ndarray, ...]]:
    """The log of an arm of three joints with effects, and q, dq and ddq, (T, 3) each.

    The controller runs far faster than the log: a torque held over a sample would be a delay. The log
    starts when the arm has settled onto its reference.
    """
    plant = make_plant(arm, terms, width=width)
    t, q, dq, ddq = fourier_motion(3, np.random.default_rng(seed), rate=RATE * FASTER)
    reference = Reference(*(jnp.asarray(x) for x in (q, dq, ddq, np.zeros_like(q))))
    control = PD(jnp.array([300.0, 300.0, 120.0]), jnp.array([40.0, 40.0, 15.0]))
    period = 1.0 / (RATE * FASTER)
    steps = stable_substeps(plant, jnp.asarray(q[0]), period)
    start = rest(plant, jnp.asarray(q[0]), jnp.asarray(dq[0]))
    run = track(plant, start, control, reference, dt=period, substeps=steps)
    kept = slice(round(SETTLED * RATE) * FASTER, None, FASTER)
    t, tau = t[kept] - SETTLED, np.asarray(run.tau)[kept]
    log = Log(
        source=f"simulated {arm.name}, seed {seed}",
        joints=arm.joints,
        t=t,
        q=np.asarray(run.q)[kept],
        tau=tau,
        channels={"tau_clean": tau},
    )
    return log, tuple(np.asarray(x)[kept] for x in (run.q, run.dq, run.ddq))
