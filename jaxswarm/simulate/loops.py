"""Loops: what happens between two samples, with given torques or with a controller.

A :class:`Loop` is the body of a scan over samples. It is apart from the recording so that a fitness can
run the same loop for a population and keep only a sum of squares.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError
from jaxswarm.robot.kinematics import SinCos
from jaxswarm.robot.trig import polynomial_sincos
from jaxswarm.simulate.acceleration import AMBIENT, Drive, State, motor_side
from jaxswarm.simulate.controllers import Controller, Reference
from jaxswarm.simulate.integrate import rk4_step
from jaxswarm.simulate.plant import Plant


class Loop(NamedTuple):
    """One pass through the samples.

    Attributes:
        begin: ``begin(state) -> carry``; the carry's first part is the state in entries.
        advance: ``advance(plant, carry, sample) -> (carry, (state, tau))``, both at the sample.
        inputs: Pytree of (T, ...) arrays that is scanned; external torque and temperature last.
    """

    begin: Callable[[State], Any]
    advance: Callable[[Plant, Any, Any], tuple[Any, tuple[State, jax.Array]]]
    inputs: Any


def open_loop(
    tau: jax.Array,
    *,
    dt: float,
    hold: str = "zero",
    substeps: int = 1,
    external: jax.Array | None = None,
    temperature: jax.Array | None = None,
    sincos: SinCos = polynomial_sincos,
) -> Loop:
    """Return the loop of given torques tau (T, n); see :func:`jaxswarm.simulate.simulate`."""
    if hold not in ("zero", "first"):
        raise InputError(f"hold is {hold!r}: use 'zero' or 'first'.")
    _check_substeps(substeps)
    tau = jnp.asarray(tau)
    following = jnp.concatenate([tau[1:], tau[-1:]]) if hold == "first" else tau
    surroundings = _surroundings(tau, external, temperature)

    def advance(plant, carry, sample):
        (begin,) = carry
        index, now, after, push, warmth = sample

        def drive(fraction):
            level = now if hold == "zero" else now + fraction * (after - now)
            return Drive(tuple(level), tuple(push), tuple(warmth))

        end = _substeps(plant, begin, drive, index * dt, dt, substeps, sincos)
        return (end,), (begin, now)

    inputs = (jnp.arange(len(tau)), tau, following, *surroundings)
    return Loop(lambda state: (unpacked(state),), advance, inputs)


def closed_loop(
    controller: Controller,
    reference: Reference,
    *,
    lanes: tuple[int, ...] = (),
    dt: float,
    control_dt: float | None = None,
    substeps: int = 1,
    external: jax.Array | None = None,
    temperature: jax.Array | None = None,
    sincos: SinCos = polynomial_sincos,
) -> Loop:
    """Return the loop of a controller on a reference; see :func:`jaxswarm.simulate.track`."""
    _check_substeps(substeps)
    every = 1 if control_dt is None else round(control_dt / dt)
    if control_dt is not None and (every < 1 or abs(every * dt - control_dt) > 1e-9 * control_dt):
        raise InputError(
            f"the controller's period {control_dt} s is no multiple of the step {dt} s: "
            f"use {max(every, 1) * dt:g} s or another step."
        )
    target = Reference(*(jnp.asarray(x) for x in reference))
    target = Reference(*(x.reshape(x.shape + (1,) * (len(lanes) + 2 - x.ndim)) for x in target))

    def advance(plant, carry, sample):
        begin, held = carry
        index, wanted, push, warmth = sample
        q, dq = (jnp.stack(x) for x in motor_side(plant, begin))
        command = controller.command(q, dq, wanted)
        command = jnp.broadcast_to(jnp.asarray(command, q.dtype), q.shape)
        now = command if every == 1 else jnp.where(index % every == 0, command, held)
        drive = Drive(tuple(now), tuple(push), tuple(warmth))
        end = _substeps(plant, begin, lambda c: drive, index * dt, dt, substeps, sincos)
        return (end, now), (begin, now)

    def begin(state):
        return unpacked(state), jnp.zeros_like(jnp.asarray(state.q))

    surroundings = _surroundings(target.q, external, temperature)
    return Loop(begin, advance, (jnp.arange(len(target.q)), target, *surroundings))


def _check_substeps(substeps: int) -> None:
    if substeps < 1 or substeps != int(substeps):
        raise InputError(f"substeps is {substeps}: use a whole number from 1.")


def _surroundings(like, external, temperature):
    external = jnp.zeros_like(like) if external is None else jnp.asarray(external, like.dtype)
    if temperature is None:
        temperature = jnp.full_like(like, AMBIENT)
    return external, jnp.asarray(temperature, like.dtype)


def _substeps(plant, state: State, drive, t, dt, substeps: int, sincos) -> State:
    """Advance by one sample in equal RK4 steps."""
    h = dt / substeps
    if substeps == 1:
        return rk4_step(plant, state, drive, t, h, sincos)

    def step(k, at):
        def inner(fraction):
            return drive((k + fraction) / substeps)

        return rk4_step(plant, at, inner, t + k * h, h, sincos)

    return jax.lax.fori_loop(0, substeps, step, state)


def unpacked(state: State) -> State:
    """Return the state as tuples of entries."""
    return State(*(tuple(jnp.asarray(part)) for part in state))


def packed(state: State) -> State:
    """Return the state as arrays."""
    empty = jnp.zeros((0, *state.q[0].shape), state.q[0].dtype)
    return State(*(jnp.stack(part) if part else empty for part in state))
