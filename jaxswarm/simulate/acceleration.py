"""Accelerations of links and motors from motor torques: the right side of the motion equations.

Unknowns are the n link accelerations and those of the motors of soft joints. Rigid joints carry their
motor, so effects stand in the link's row; a soft joint has a row of its own,

    M(q) ddq + h(q, dq) = s (soft) or tau - effects (rigid),    ia ddtheta = tau - effects - s.

Where the base gives way the arm stands on two hinges (:mod:`jaxswarm.effects.hinged_base`) on springs; their
turns follow the motors of the soft joints wherever those stand.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.effects.hinged_base import TURNS, hinged
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import of_kind
from jaxswarm.robot import spatial as sp
from jaxswarm.robot.kinematics import SinCos
from jaxswarm.robot.mass import equations_of_motion, solve_symmetric
from jaxswarm.simulate.encoders import said_motion, true_motion
from jaxswarm.simulate.forces import effect_torques, sample_of, transmission_torque
from jaxswarm.simulate.plant import Plant

# Friction by load is a fixed point: the load depends on accelerations and these on friction. Each
# round shrinks the error by the friction coefficient.
LOAD_ROUNDS = 4
AMBIENT = 25.0  # deg C, the temperature at which temperature_friction vanishes


class State(NamedTuple):
    """State of a plant: arrays of one sample, tuples of entries inside the integrator.

    Attributes:
        q: (n,), link positions in rad or m.
        dq: (n,), link velocities.
        motor_q: (s,), motor positions of the soft joints, seen at the joint; of a base that gives way its
            two turns after them.
        motor_dq: (s,), their velocities.
        memory: (r,), states of the effects that have any, one after the other.
    """

    q: Any
    dq: Any
    motor_q: Any
    motor_dq: Any
    memory: Any


class Drive(NamedTuple):
    """What acts from outside at one instant, n entries each.

    Attributes:
        tau: Motor torques in N m or N.
        external: Torques of the surroundings on the links, positive along the joint.
        temperature: In deg C.
    """

    tau: Any
    external: Any
    temperature: Any


def rest(
    plant: Plant,
    q: jax.Array,
    dq: jax.Array | None = None,
    temperature: jax.Array | None = None,
) -> State:
    """Return the state where encoders say q, dq (n,), with links beside motors and memories at their start.

    ``temperature`` (n,) is that of the begin in deg C, default :data:`AMBIENT`.
    """
    q = jnp.asarray(q)
    dq = jnp.zeros_like(q) if dq is None else jnp.asarray(dq, q.dtype)
    q, dq = true_motion(plant, q, dq)
    motor_q, motor_dq = (x[:0] for x in (q, dq))
    if plant.soft:  # one by one: an index array would be a gather
        motor_q, motor_dq = (jnp.stack([x[j] for j in plant.soft]) for x in (q, dq))
    if plant.base is not None:
        turns = _settled(plant, q)
        motor_q = jnp.concatenate([motor_q, turns])
        motor_dq = jnp.concatenate([motor_dq, 0.0 * turns])
    slots = sum(a.law.memories for a in plant.remembering)
    memory = jnp.zeros((slots, *q.shape[1:]), q.dtype)
    warmth = jnp.full_like(q, AMBIENT) if temperature is None else jnp.asarray(temperature, q.dtype)
    k = 0
    for acting in plant.remembering:
        law = acting.law
        if law.start is not None:
            sample = sample_of(plant, acting, q, dq, 0.0, warmth)
            memory = memory.at[k].set(law.start(acting.values, sample))
        k += law.memories
    return State(q, dq, motor_q, motor_dq, memory)


def motor_side(plant: Plant, state: State) -> tuple[list, ...]:
    """Return positions and velocities (n entries each) as the encoders on the motors say them."""
    q, dq = list(state.q), list(state.dq)
    for k, joint in enumerate(plant.soft):
        q[joint], dq[joint] = state.motor_q[k], state.motor_dq[k]
    return tuple(said_motion(plant, q, dq))


def accelerations(plant: Plant, state: State, drive: Drive, t, sincos: SinCos) -> tuple[list, list]:
    """Return link accelerations (n entries) and those of motors of soft joints and of the base (s entries)."""
    n, soft = plant.robot.num_joints, plant.soft
    mass, bias = _equations(plant, state, t, sincos)
    motor_q, motor_dq = motor_side(plant, state)
    row = list(range(n))  # row of each joint's motor
    for k, joint in enumerate(soft):
        row[joint] = n + k
    # Rows of the links, and after those of the motors, of the base.
    bodies = [*range(n), *range(n + len(soft), len(mass) + len(soft))]
    size = len(mass) + len(soft)
    matrix: list[list] = [[0.0] * size for _ in range(size)]
    for own, i in zip(mass, bodies, strict=True):
        for entry, j in zip(own, bodies, strict=True):
            matrix[i][j] = entry
    free = [sp.minus(drive.external[i], bias[i]) for i in range(n)] + [0.0] * len(soft)
    free += _base_torques(plant, state, bias)
    for k, joint in enumerate(soft):
        twist = state.motor_q[k] - state.q[joint]
        spring = transmission_torque(plant, joint, twist, state.motor_dq[k] - state.dq[joint])
        free[joint] = sp.plus(free[joint], spring)
        free[n + k] = sp.minus(0.0, spring)

    def solve(loads):
        effects, inertias = effect_torques(
            plant, motor_q, motor_dq, state.memory, t, drive.temperature, loads
        )
        right, left = list(free), [list(entries) for entries in matrix]
        for j in range(n):
            supplied = sp.minus(drive.tau[j], effects[j])
            right[row[j]] = sp.plus(right[row[j]], supplied)
        for i, j, inertia in inertias:
            left[row[i]][row[j]] = sp.plus(left[row[i]][row[j]], inertia)
        if all(i == j for i, j, _ in inertias):
            return solve_symmetric(left, right)
        return solve_general(left, right)

    x = solve(None)
    if any(a.law.uses_load for a in of_kind(plant.acting, TorqueLaw)):
        for _ in range(LOAD_ROUNDS):
            ddq = [x[i] for i in bodies]
            loads = [(sp.plus(sp.dot(mass[i], ddq), bias[i]), bias[i]) for i in range(n)]
            x = solve(loads)
    return x[:n], x[n:]


def _equations(plant: Plant, state: State, t, sincos: SinCos) -> tuple[list[list], list]:
    """Mass matrix and bias of the links, and after them of a base that gives way, as entries."""
    robot = plant.robot_at(t)
    if plant.base is None:
        return equations_of_motion(robot, state.q, state.dq, sincos=sincos)
    s = len(plant.soft)
    q, dq = (*state.motor_q[s:], *state.q), (*state.motor_dq[s:], *state.dq)
    mass, bias = equations_of_motion(hinged(robot), q, dq, sincos=sincos)
    for k in range(TURNS):
        mass[k][k] = sp.plus(mass[k][k], plant.base.inertia[k])
    order = [*range(TURNS, len(q)), *range(TURNS)]
    return [[mass[i][j] for j in order] for i in order], [bias[i] for i in order]


def _settled(plant: Plant, q: jax.Array) -> jax.Array:
    """Turns (2,) of a base on which an arm stands still, to first order."""
    rest = jnp.zeros((q.shape[0] + TURNS, *q.shape[1:]), q.dtype)
    _, bias = equations_of_motion(hinged(plant.robot_at(0.0)), rest.at[TURNS:].set(q), rest)
    assert plant.base is not None  # asked for of such a one
    return jnp.stack([0.0 * q[0] - bias[k] / plant.base.stiffness[k] for k in range(TURNS)])


def _base_torques(plant: Plant, state: State, bias: list) -> list[sp.Entry]:
    """Torques on the turns of the base beside its mass: of its springs and dampers, less the bias."""
    if plant.base is None:
        return []
    base, told = plant.base, []
    for k in range(-TURNS, 0):
        held = base.stiffness[k] * state.motor_q[k] + base.damping[k] * state.motor_dq[k]
        told.append(sp.minus(-held, bias[k]))
    return told


def solve_general(matrix, right) -> list[sp.Entry]:
    """Solve A x = b for entries by elimination; A is diagonally strong and needs no pivoting."""
    a = [list(entries) for entries in matrix]
    x = list(right)
    n = len(x)
    for j in range(n):
        inverse = 1.0 / jnp.asarray(a[j][j])
        for i in range(j + 1, n):
            factor = sp.times(a[i][j], inverse)
            for k in range(j + 1, n):
                a[i][k] = sp.minus(a[i][k], sp.times(factor, a[j][k]))
            x[i] = sp.minus(x[i], sp.times(factor, x[j]))
    for i in reversed(range(n)):
        for k in range(i + 1, n):
            x[i] = sp.minus(x[i], sp.times(a[i][k], x[k]))
        x[i] = x[i] / jnp.asarray(a[i][i])
    return x
