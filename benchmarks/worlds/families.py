"""Random arms: chains of 2 to 7 joints, and four families with the layout of factory robots.

Lengths of a family are those of a typical member times a drawn factor. Bodies are solid boxes of drawn
sides, turned at random, hence physically consistent. Rotors and friction are drawn in units of what the
joint carries: its mean diagonal of the mass matrix and the torque of its usual motion.
"""

from dataclasses import replace

import numpy as np
import pinocchio
from scipy.spatial.transform import Rotation

from benchmarks.worlds.arm import Arm, pin_model

_H = np.pi / 2
# Rows: xyz in units of the drawn length, rpy, kind.
_UR = [
    ((0, 0, 0.18), (0, 0, 0), "r"),
    ((0, 0, 0), (_H, 0, 0), "r"),
    ((-0.61, 0, 0), (0, 0, 0), "r"),
    ((-0.57, 0, 0.17), (0, 0, 0), "r"),
    ((0, -0.12, 0), (_H, 0, 0), "r"),
    ((0, 0.12, 0), (_H, np.pi, np.pi), "r"),
]
_WRIST = [
    ((0, 0, 0.32), (0, 0, 0), "r"),
    ((0, 0, 0), (-_H, 0, 0), "r"),
    ((0.225, 0, 0.035), (0, 0, -_H), "r"),
    ((0, -0.225, 0), (_H, 0, 0), "r"),
    ((0, 0, 0), (-_H, 0, 0), "r"),
    ((0, -0.065, 0), (_H, 0, 0), "r"),
]
_SEVEN = [
    ((0, 0, 0.333), (0, 0, 0), "r"),
    ((0, 0, 0), (-_H, 0, 0), "r"),
    ((0, -0.316, 0), (_H, 0, 0), "r"),
    ((0.0825, 0, 0), (_H, 0, 0), "r"),
    ((-0.0825, 0.384, 0), (-_H, 0, 0), "r"),
    ((0, 0, 0), (_H, 0, 0), "r"),
    ((0.088, -0.107, 0), (_H, 0, 0), "r"),
]
_SCARA = [
    ((0, 0, 0.3), (0, 0, 0), "r"),
    ((0.33, 0, 0), (0, 0, 0), "r"),
    ((0.28, 0, 0), (np.pi, 0, 0), "r"),
    ((0, 0, 0.05), (0, 0, 0), "p"),
]
FAMILIES = {"ur": _UR, "wrist": _WRIST, "seven": _SEVEN, "scara": _SCARA}
_FAMILY_SHARE = 0.45  # of arms; the others are chains without a pattern
_SLIDE_SHARE = 0.15  # of joints of a chain
_KINDS = {"r": "revolute", "p": "prismatic"}


def log_uniform(rng: np.random.Generator, low: float, high: float, size=None):
    return np.exp(rng.uniform(np.log(low), np.log(high), size))


def draw_arm(rng: np.random.Generator) -> Arm:
    """An arm with bodies, rotors, friction and limits."""
    if rng.random() < _FAMILY_SHARE:
        name = str(rng.choice(list(FAMILIES)))
        rows = FAMILIES[name]
        length = rng.uniform(0.6, 1.2) * rng.uniform(0.85, 1.15, (len(rows), 1))
        xyz = length * np.array([row[0] for row in rows])
        rotation = Rotation.from_euler("xyz", [row[1] for row in rows]).as_matrix()
        kinds = tuple(_KINDS[row[2]] for row in rows)
    else:
        name, kinds, xyz, rotation = _chain(rng)
    n = len(kinds)
    mass, com, inertia = _bodies(rng, xyz)
    sliding = np.array([kind == "prismatic" for kind in kinds])
    zero = np.zeros(n)
    speed = np.where(sliding, rng.uniform(0.2, 0.6, n), rng.uniform(1.0, 2.5, n))
    arm = Arm(
        name=name,
        kinds=kinds,
        xyz=xyz,
        rotation=rotation,
        axis=np.tile([0.0, 0.0, 1.0], (n, 1)),
        mass=mass,
        com=com,
        inertia=inertia,
        rotor=zero,
        viscous=zero,
        coulomb=zero,
        width=np.where(sliding, log_uniform(rng, 5e-4, 3e-3, n), log_uniform(rng, 2e-3, 2e-2, n)),
        reach=np.where(sliding, rng.uniform(0.08, 0.25, n), rng.uniform(0.6, 2.2, n)),
        speed=speed,
        acceleration=speed * rng.uniform(2.0, 6.0, n),
    )
    inertia, torque = joint_scales(arm)
    arm = replace(arm, rotor=inertia * log_uniform(rng, 0.1, 1.0, n))
    return replace(
        arm,
        coulomb=torque * rng.uniform(0.03, 0.2, n),
        viscous=torque / speed * rng.uniform(0.02, 0.2, n),
    )


def joint_scales(arm: Arm) -> tuple[np.ndarray, np.ndarray]:
    """Mean diagonal of the mass matrix with rotors, and RMS torque of usual motion, both (n,)."""
    model = pin_model(arm)
    data = model.createData()
    rng = np.random.default_rng(0)
    inertia, torque = np.zeros(arm.size), np.zeros(arm.size)
    count = 100
    for _ in range(count):
        q = rng.uniform(-1, 1, arm.size) * arm.reach
        dq = rng.uniform(-1, 1, arm.size) * arm.speed * 0.5
        ddq = rng.uniform(-1, 1, arm.size) * arm.acceleration * 0.5
        inertia += np.diag(pinocchio.crba(model, data, q)) / count
        torque += (pinocchio.rnea(model, data, q, dq, ddq) + arm.rotor * ddq) ** 2 / count
    return inertia + arm.rotor, np.sqrt(torque)


def _chain(rng):
    n = int(rng.integers(2, 8))
    kinds = ["prismatic" if rng.random() < _SLIDE_SHARE else "revolute" for _ in range(n)]
    if all(kind == "prismatic" for kind in kinds):
        kinds[0] = "revolute"
    xyz = rng.normal(0.0, 1.0, (n, 3)) * rng.uniform(0.05, 0.2, (n, 1))
    along = rng.integers(0, 3, n)
    xyz[np.arange(n), along] += rng.choice([-1, 1], n) * rng.uniform(0.1, 0.4, n)
    turns = rng.integers(-1, 2, (n, 3)) * _H
    turns[rng.random(n) < 0.2] += rng.uniform(-0.6, 0.6, 3)  # some axes are not at right angles
    return f"chain{n}", tuple(kinds), xyz, Rotation.from_euler("xyz", turns).as_matrix()


def _bodies(rng, xyz):
    """Boxes that reach towards the next joint, lighter along the chain: mass, com, inertia."""
    n = len(xyz)
    ends = np.vstack([xyz[1:], rng.normal(0.0, 0.08, (1, 3))])
    mass = log_uniform(rng, 3.0, 25.0) * np.cumprod(rng.uniform(0.5, 0.95, n))
    com = ends * rng.uniform(0.2, 0.7, (n, 1)) + rng.normal(0.0, 0.02, (n, 3))
    long = np.maximum(np.linalg.norm(ends, axis=1), 0.05)
    sides = rng.uniform(0.3, 1.2, (n, 3)) * long[:, None] + 0.04
    inertia = np.zeros((n, 3, 3))
    for j in range(n):
        a, b, c = sides[j] ** 2
        turn = Rotation.random(random_state=rng).as_matrix()
        inertia[j] = turn @ np.diag([b + c, a + c, a + b]) @ turn.T * mass[j] / 12.0
    return mass, com, inertia
