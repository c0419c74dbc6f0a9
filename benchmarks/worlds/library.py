"""The library the rivals choose from: about 115 columns a joint, each labeled with the law it stands for.

Laws with nonlinear parameters stand on a lattice of them. Labels are those of the diagnosis, so that a
rival names ``stribeck_friction@joint2`` by any of its velocities. Widths of the sign are the true ones,
which is more than a user knows.
"""

from collections.abc import Iterator

import numpy as np

from benchmarks.worlds.arm import GRAVITY, Arm
from benchmarks.worlds.laws import LAWS
from benchmarks.worlds.memory import along
from benchmarks.worlds.plain import Plain, Prepared
from benchmarks.worlds.rigid import declared_columns

_ORDERS = (1, 2, 3, 4, 6, 8, 10, 12, 16, 20, 24, 30, 36, 42, 50, 60)
_STRIBECK = (0.03, 0.06, 0.1, 0.2)
_WARMING = (5.0, 10.0, 20.0, 60.0)
_BRISTLES = (0.01, 0.03, 0.06, 0.1)
_POWERS = (0.3, 0.5, 1.5)
# Lattices for slides, in units of those for turning joints.
_SLIDE = {"speed": 0.2, "length": 0.1, "order": 3.0}


def library(arm: Arm, base: Plain, log: Prepared) -> tuple[list[str], np.ndarray]:
    """Labels (L,) and joints' columns along a log, (T, n, L), each on its own joint."""
    sign = np.tanh(log.dq / arm.width)
    load, tilts = _model_torques(arm, base, log)
    labels, columns = [], []
    for j in range(arm.size):
        for label, values in joint_library(arm, log, sign, load, tilts, j):
            column = np.zeros(log.q.shape)
            column[:, j] = values
            labels.append(label)
            columns.append(column)
    return labels, np.stack(columns, axis=2)


def _model_torques(arm: Arm, base: Plain, log: Prepared):
    """Torque of the base model's bodies, and of its weight under gravity along x and y, (T, n)."""
    body = base.values[: 10 * arm.size]
    load = declared_columns(arm, (), log.q, log.dq, log.ddq) @ body
    still = np.zeros_like(log.q)
    free = declared_columns(arm, (), log.q, still, still, np.zeros(3)) @ body
    tilts = [
        declared_columns(arm, (), log.q, still, still, direction) @ body - free
        for direction in np.eye(3)[:2] * abs(GRAVITY[2])
    ]
    return load, tilts


def joint_library(arm, log, sign, load, tilts, j) -> Iterator[tuple[str, np.ndarray]]:
    """Label and column (T,) of everything the library holds for one joint along a log."""
    q, dq, s, at = log.q[:, j], log.dq[:, j], sign[:, j], f"@joint{j + 1}"
    slide = arm.sliding[j]
    scale = {k: v if slide else 1.0 for k, v in _SLIDE.items()}
    yield "torque_offset" + at, np.ones_like(q)
    yield "joint_spring" + at, q
    yield "cubic_spring" + at, q**3
    yield "viscous_friction" + at, dq
    yield "coulomb_friction" + at, s
    yield "rotor_inertia" + at, log.ddq[:, j]
    yield "quadratic_drag" + at, dq * np.abs(dq)
    yield "asymmetric_friction" + at, 0.5 * (1 + s) * s
    yield "asymmetric_friction" + at, 0.5 * (1 + s) * dq
    for power in _POWERS:
        yield "nonlinear_viscous_friction" + at, np.abs(dq) ** power * s
    for speed in _STRIBECK:
        yield "stribeck_friction" + at, np.exp(-((dq / (speed * scale["speed"])) ** 2)) * s
    for time in _WARMING:
        yield "thermal_drift" + at, np.expm1(-(log.t - log.t[0]) / time) * s
    for length in _BRISTLES:
        yield "hysteresis" + at, _bend(log.t, dq, length * scale["length"])
    for order in np.array(_ORDERS) * scale["order"]:
        yield "torque_ripple" + at, np.sin(order * q)
        yield "torque_ripple" + at, np.cos(order * q)
    for order in np.array(_ORDERS[:4]) * scale["order"]:
        yield "position_dependent_friction" + at, np.sin(order * q) * s
        yield "position_dependent_friction" + at, np.cos(order * q) * s
    yield "load_dependent_friction" + at, np.abs(load[:, j]) * s
    yield "drive_gain" + at, load[:, j]
    yield "time_delay", np.gradient(load[:, j], log.t)
    yield "base_tilt", tilts[0][:, j]
    yield "base_tilt", tilts[1][:, j]
    for start in (0.25, 0.5, 0.75):
        yield "friction_change" + at, (log.t > log.t[0] + start * (log.t[-1] - log.t[0])) * s
    for i in range(arm.size):
        if i != j:
            pair = f"{at}:joint{i + 1}"
            yield "transmission_coupling" + pair, log.dq[:, i]
            yield "transmission_coupling" + pair, sign[:, i]
            yield "transmission_coupling" + pair, log.ddq[:, i]
            yield "cable_coupling" + pair, log.q[:, i]
            yield f"product{pair}", log.dq[:, i] * dq
            yield f"product{pair}", np.sin(log.q[:, i])
            yield f"product{pair}", np.cos(log.q[:, i])
            yield f"product{pair}", log.q[:, i] * s


def _bend(t: np.ndarray, dq: np.ndarray, x0: float) -> np.ndarray:
    """Bend of bristles along a motion (T,), in units of their level."""
    return along(LAWS["hysteresis"], {"x0": x0}, t, dq)
