r"""Two four-parameter manipulators and their output error; which of them the SEPSO paper used is unknown.

Flexible-joint arm, at rest at zero, parameters (I, J, MgL, K):

.. math:: I \ddot q_1 + MgL \sin q_1 + K (q_1 - q_2) = 0, \qquad J \ddot q_2 + K (q_2 - q_1) = u.

Two-link planar arm from :math:`q = (-\pi/2, 0)` at rest, parameters :math:`(\alpha, \beta, \epsilon, \eta)`:
:math:`H_{11} = \alpha + 2 \epsilon c_2 + 2 \eta s_2`, :math:`H_{12} = \beta + \epsilon c_2 + \eta s_2`,
:math:`H_{22} = \beta`, with the Coriolis and gravity torques of the same four numbers.

The plant and its model get the same input and start alike; the value of a candidate is the mean squared
difference of their positions, each in units of its RMS. A population runs as lanes of one scan (fourth-order
Runge-Kutta). With measured accelerations both are linear in the parameters: that is :func:`torque_problem`.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.robot.trig import polynomial_sincos
from jaxswarm.swarm import Space

DT, DURATION = 0.005, 2.0  # s
NOISE = 0.01  # of each output's RMS
GRAVITY = 9.8  # m/s^2, over a first link of 1 m


class Data(NamedTuple):
    """An experiment: input (T, 3, m) at the start, middle and end of each step; outputs (T, 2)."""

    drive: jax.Array
    output: jax.Array
    scale: jax.Array


class Plant(NamedTuple):
    """A manipulator with four unknown parameters.

    Attributes:
        name: For tables.
        names: Of the parameters.
        true: Their values, (4,).
        lower, upper: Bounds, (4,).
        start: Positions and velocities (q1, q2, dq1, dq2) at time zero.
        accelerate: ``(parameters, state, drive) -> (ddq1, ddq2)``, lanes allowed.
        torque: ``(parameters, q, dq, ddq) -> (tau1, tau2)``, linear in the parameters.
        drive: ``t -> (tau1, tau2)``, the input.
        cost: ``(population (m, 4), Data) -> (m,)``, for ``minimize``.
        residual: ``(parameters (4,), Data) -> (2 T,)``, whose mean square sum is the cost.
    """

    name: str
    names: tuple[str, ...]
    true: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    start: tuple[float, ...]
    accelerate: Callable[..., Any]
    torque: Callable[..., Any]
    drive: Callable[..., Any]
    cost: Callable[..., Any]
    residual: Callable[..., Any]

    @property
    def space(self) -> Space:
        """Search space that decodes to (4,)."""
        return Space.vector(self.lower, self.upper, names=self.names)


def _flexible_acceleration(p, state, u):
    inertia, motor, load, stiffness = p
    q1, q2 = state[:2]
    twist = stiffness * (q1 - q2)
    return (-load * polynomial_sincos(q1)[0] - twist) / inertia, (u[1] + twist) / motor


def _flexible_torque(p, q, dq, ddq):
    inertia, motor, load, stiffness = p
    twist = stiffness * (q[0] - q[1])
    return inertia * ddq[0] + load * np.sin(q[0]) + twist, motor * ddq[1] - twist


def _two_link_parts(p, sincos, q, dq):
    """Entries of H, and the torques that do not depend on the accelerations."""
    alpha, beta, eps, eta = p
    (s1, c1), (s2, c2) = sincos(q[0]), sincos(q[1])
    s12, c12 = s1 * c2 + c1 * s2, c1 * c2 - s1 * s2
    coupling, slope = eps * c2 + eta * s2, -eps * s2 + eta * c2
    tip = GRAVITY * (eps * c12 + eta * s12)
    first = 2.0 * slope * dq[1] * dq[0] + slope * dq[1] ** 2 + tip + GRAVITY * (alpha - beta) * c1
    second = -slope * dq[0] ** 2 + tip
    return (alpha + 2.0 * coupling, beta + coupling, beta), (first, second)


def _two_link_acceleration(p, state, u):
    (h11, h12, h22), (g1, g2) = _two_link_parts(p, polynomial_sincos, state[:2], state[2:])
    e1, e2 = u[0] - g1, u[1] - g2
    determinant = h11 * h22 - h12**2
    # No arm has a mass matrix that is not positive definite: such a candidate is worth nothing.
    determinant = jnp.where((determinant > 0.0) & (h22 > 0.0), determinant, jnp.nan)
    return (h22 * e1 - h12 * e2) / determinant, (h11 * e2 - h12 * e1) / determinant


def _two_link_torque(p, q, dq, ddq):
    (h11, h12, h22), (g1, g2) = _two_link_parts(p, lambda x: (np.sin(x), np.cos(x)), q, dq)
    return h11 * ddq[0] + h12 * ddq[1] + g1, h12 * ddq[0] + h22 * ddq[1] + g2


def _simulate(accelerate, start, p, drive, each):
    """Scan ``each(state, sample index inputs)`` over the steps; state entries have the lanes of p."""

    def stage(carry, numbers):
        state, before, total, u = carry
        c, weight, k = numbers
        at = tuple(x + c * DT * v for x, v in zip(state, before, strict=True))
        now = (*at[2:], *accelerate(p, at, u[k]))
        total = tuple(a + weight / 6.0 * b for a, b in zip(total, now, strict=True))
        return (state, now, total, u), None

    # A loop over the four stages: one copy of the dynamics to compile instead of four.
    numbers = np.array([0.0, 0.5, 0.5, 1.0]), np.array([1.0, 2.0, 2.0, 1.0]), np.array([0, 1, 1, 2])

    def step(carry, inputs):
        (state, kept), (u, sample) = carry, inputs
        still = tuple(jnp.zeros_like(x) for x in state)
        (_, _, mean, _), _ = jax.lax.scan(stage, (state, still, still, u), numbers)
        state = tuple(x + DT * v for x, v in zip(state, mean, strict=True))
        return each(state, kept, sample)

    lanes = jnp.shape(p[0])
    first = tuple(jnp.broadcast_to(jnp.asarray(x, p[0].dtype), lanes) for x in start)
    return step, first


def _cost(accelerate, start):
    def cost(population: jax.Array, data: Data) -> jax.Array:
        def each(state, total, sample):
            for x, y, s in zip(state[:2], sample, data.scale, strict=True):
                total = total + ((x - y) / s) ** 2
            return (state, total), None

        p = tuple(population[:, k] for k in range(4))
        step, first = _simulate(accelerate, start, p, data.drive, each)
        carry = (first, jnp.zeros_like(p[0]))
        (_, total), _ = jax.lax.scan(step, carry, (data.drive, data.output))
        value = total / (2 * data.output.shape[0])
        return jnp.where(jnp.isfinite(value), value, jnp.inf)

    return cost


def _residual(accelerate, start):
    def residual(parameters: jax.Array, data: Data) -> jax.Array:
        def each(state, kept, sample):
            return (state, kept), (jnp.stack(state[:2]) - sample) / data.scale

        step, first = _simulate(accelerate, start, tuple(parameters), data.drive, each)
        _, error = jax.lax.scan(step, (first, ()), (data.drive, data.output))
        return error.ravel() / np.sqrt(2 * data.output.shape[0])

    return residual


def _plant(name, names, true, bounds, start, accelerate, torque, drive):
    lower, upper = np.array(bounds, float).T
    return Plant(
        name,
        names,
        np.array(true, float),
        lower,
        upper,
        start,
        accelerate,
        torque,
        drive,
        _cost(accelerate, start),
        _residual(accelerate, start),
    )


PLANTS = {
    "flexible joint": _plant(
        "flexible joint",
        ("I", "J", "MgL", "K"),
        (1.0, 1.0, 5.0, 1200.0),
        ((0, 5), (0, 5), (0, 10), (1000, 1500)),
        (0.0, 0.0, 0.0, 0.0),
        _flexible_acceleration,
        _flexible_torque,
        lambda t: (0.0 * t, np.sin(2.0 * np.pi * t)),
    ),
    "two links": _plant(
        "two links",
        ("alpha", "beta", "eps", "eta"),
        (6.7333, 3.4, 3.0, 0.0),
        ((0, 10), (0, 5), (0, 5), (0, 5)),
        (-np.pi / 2.0, 0.0, 0.0, 0.0),
        _two_link_acceleration,
        _two_link_torque,
        lambda t: (20.0 * np.sin(2.0 * np.pi * t), 10.0 * np.sin(4.0 * np.pi * t)),
    ),
}
"""The plants by name; inputs are reconstructions."""


def outputs(plant: Plant, parameters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Simulate one candidate: drive (T, 3, 2) and the states after each step (T, 4)."""
    steps = int(round(DURATION / DT))
    t = np.arange(steps)[:, None] * DT + np.array([0.0, 0.5, 1.0]) * DT
    drive = np.stack(plant.drive(t), axis=-1)

    def run(p, drive):
        def each(state, kept, sample):
            return (state, kept), jnp.stack(state)

        step, first = _simulate(plant.accelerate, plant.start, tuple(p), drive, each)
        return jax.lax.scan(step, (first, ()), (drive, jnp.zeros((steps, 2))))[1]

    return drive, np.asarray(jax.jit(run)(jnp.asarray(parameters), drive))


def make_data(plant: Plant, noise_seed: int | None = None) -> Data:
    """The measured positions for the true parameters, with a seed with noise of 1 % of their RMS."""
    drive, states = outputs(plant, plant.true)
    measured = states[:, :2]
    scale = measured.std(axis=0)
    if noise_seed is not None:
        rng = np.random.default_rng([noise_seed, 4])
        measured = measured + NOISE * scale * rng.normal(size=measured.shape)
    return Data(jnp.asarray(drive), jnp.asarray(measured), jnp.asarray(scale))


def torque_problem(plant: Plant) -> tuple[np.ndarray, np.ndarray, float]:
    """R, z, rho^2 of the torque error with perfect positions, velocities and accelerations.

    The fitness sqrt(||R p - z||^2 + rho^2) is the RMS torque error; least squares solves it exactly.
    """
    drive, states = outputs(plant, plant.true)
    state = tuple(jnp.asarray(x) for x in states.T)
    end = tuple(drive[:, 2].T)
    ddq = plant.accelerate(tuple(plant.true), state, end)
    motion = states[:, :2].T, states[:, 2:].T, np.asarray(ddq)
    matrix = np.stack([np.concatenate(plant.torque(tuple(e), *motion)) for e in np.eye(4)], axis=1)
    stacked = np.column_stack([matrix, drive[:, 2].T.ravel()]) / np.sqrt(len(states))
    triangle = np.asarray(np.linalg.qr(stacked, mode="r"))
    return triangle[:4, :4], triangle[:4, 4], float(triangle[4, 4] ** 2)
