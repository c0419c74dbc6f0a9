"""A plant driven through time: by given torques, or by a controller that follows a reference.

Samples lie ``dt`` apart; between two samples RK4 takes ``substeps`` equal steps. Torques are held over a
sample (zero-order) or run linearly to the next one (first-order). A controller samples the encoders
every ``control_dt`` and its command is held in between, as a drive does it.

Nothing here is jitted and every number is an argument: jit the call, vmap it over plants or initial
states, or give plants and states a trailing axis of lanes. The fastest on a CPU are lanes in blocks,
:func:`jaxswarm.robot.in_blocks` (see ``benchmarks/dynamics.py``). A step too long for a plant whose
numbers are known is refused; under jit they are not, so call
:func:`jaxswarm.simulate.check_step` or take the substeps of
:func:`jaxswarm.simulate.stable_substeps`.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.robot.kinematics import SinCos
from jaxswarm.robot.trig import polynomial_sincos
from jaxswarm.simulate.acceleration import Drive, State, accelerations
from jaxswarm.simulate.controllers import Controller, Reference
from jaxswarm.simulate.encoders import said_motion
from jaxswarm.simulate.loops import Loop, closed_loop, open_loop, packed
from jaxswarm.simulate.plant import Plant
from jaxswarm.simulate.stability import check_step


class Trajectory(NamedTuple):
    """A simulated motion, T samples of n joints (and lanes, if the plant had any).

    Attributes:
        t: (T,), in s.
        q: (T, n), at the encoders, in rad or m.
        dq: (T, n), at the encoders.
        ddq: (T, n), at the encoders.
        tau: (T, n), motor torques in N m or N.
        q_link: (T, n), of the links; equal to q for rigid joints.
        dq_link: (T, n).
        state: Final state, to go on from.
    """

    t: jax.Array
    q: jax.Array
    dq: jax.Array
    ddq: jax.Array
    tau: jax.Array
    q_link: jax.Array
    dq_link: jax.Array
    state: State


def simulate(
    plant: Plant,
    state: State,
    tau: jax.Array,
    *,
    dt: float,
    hold: str = "zero",
    substeps: int = 1,
    external: jax.Array | None = None,
    temperature: jax.Array | None = None,
    sincos: SinCos = polynomial_sincos,
) -> Trajectory:
    """Drive a plant with given torques.

    Args:
        plant: The plant.
        state: Where it starts, see :func:`rest`.
        tau: (T, n), motor torques at the samples in N m or N.
        dt: Distance of the samples in s, > 0.
        hold: ``"zero"`` or ``"first"``: order of the hold between samples.
        substeps: RK4 steps per sample, >= 1.
        external: (T, n), torques of the surroundings on the links, default none.
        temperature: (T, n), in deg C, default 25.
        sincos: Function that gives sine and cosine of an angle.

    Returns:
        The motion at the same samples; a diverging one turns into NaN.

    Raises:
        InputError: If the hold or the number of substeps is none, or, outside of jit, the step is
            too long for the plant at its start.

    >>> from jaxswarm.robot import rx60
    >>> from jaxswarm.simulate import make_plant, rest
    >>> plant = make_plant(rx60())
    >>> motion = simulate(plant, rest(plant, jnp.zeros(3)), jnp.ones((5, 3)), dt=1e-3)
    >>> motion.q.shape
    (5, 3)
    """
    loop = open_loop(
        tau,
        dt=dt,
        hold=hold,
        substeps=substeps,
        external=external,
        temperature=temperature,
        sincos=sincos,
    )
    _check(plant, state, loop, dt / substeps)
    return _record(plant, state, loop, dt, sincos)


def track(
    plant: Plant,
    state: State,
    controller: Controller,
    reference: Reference,
    *,
    dt: float,
    control_dt: float | None = None,
    substeps: int = 1,
    external: jax.Array | None = None,
    temperature: jax.Array | None = None,
    sincos: SinCos = polynomial_sincos,
) -> Trajectory:
    """Let a controller drive a plant along a reference.

    Args:
        plant: The plant.
        state: Where it starts, see :func:`rest`.
        controller: Called with encoder position and velocity and the reference of the sample.
        reference: (T, n) arrays at the samples.
        dt: Distance of the samples in s, > 0.
        control_dt: Period of the controller in s, a multiple of ``dt``; default ``dt``.
        substeps: RK4 steps per sample, >= 1.
        external: (T, n), torques of the surroundings on the links, default none.
        temperature: (T, n), in deg C, default 25.
        sincos: Function that gives sine and cosine of an angle.

    Returns:
        The motion at the samples, with the torques the controller commanded.

    Raises:
        InputError: If ``control_dt`` is no multiple of ``dt``, there are no substeps, or, outside
            of jit, the step is too long for the plant at its start.
    """
    loop = closed_loop(
        controller,
        reference,
        lanes=jnp.shape(state.q)[1:],
        dt=dt,
        control_dt=control_dt,
        substeps=substeps,
        external=external,
        temperature=temperature,
        sincos=sincos,
    )
    _check(plant, state, loop, dt / substeps)
    return _record(plant, state, loop, dt, sincos)


def _check(plant: Plant, state: State, loop: Loop, step: float) -> None:
    """Raise on a step that is too long, outside of jit and for a single plant."""
    leaves = jax.tree.leaves((plant, state, loop.inputs))
    if jnp.ndim(state.q) == 1 and not any(isinstance(x, jax.core.Tracer) for x in leaves):
        check_step(plant, state.q, step)


def _record(plant: Plant, state: State, loop: Loop, dt, sincos) -> Trajectory:
    """Run a loop from a state and keep what the encoders and the links do."""
    last, (states, tau) = jax.lax.scan(
        lambda carry, sample: loop.advance(plant, carry, sample), loop.begin(state), loop.inputs
    )
    push, warmth = loop.inputs[-2:]
    num = push.shape[0]
    t = jnp.arange(num) * dt

    def sample(state, tau, push, warmth, t):
        drive = Drive(tuple(tau), tuple(push), tuple(warmth))
        ddq, motor_ddq = accelerations(plant, state, drive, t, sincos)
        q, dq = list(state.q), list(state.dq)
        for k, joint in enumerate(plant.soft):
            q[joint], dq[joint] = state.motor_q[k], state.motor_dq[k]
            ddq[joint] = motor_ddq[k]
        q, dq, ddq = said_motion(plant, q, dq, ddq)
        like = q[0]
        parts = (q, dq, ddq, state.q, state.dq)
        return [jnp.stack([jnp.broadcast_to(x, like.shape) for x in part]) for part in parts]

    tau = jnp.broadcast_to(tau, (num, len(states.q), *states.q[0].shape[1:]))
    q, dq, ddq, q_link, dq_link = jax.vmap(sample)(states, tau, push, warmth, t)
    return Trajectory(t, q, dq, ddq, tau, q_link, dq_link, packed(last[0]))
