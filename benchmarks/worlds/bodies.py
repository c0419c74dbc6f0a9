"""Another body than the user's robot file says: a load on the last link, a joint askew on its parent."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.worlds.arm import Arm
from benchmarks.worlds.effect import Effect

# Fields of MuJoCo's model in which two arms of the same kinematics differ.
BODY_FIELDS = ("body_mass", "body_inertia", "body_ipos", "body_iquat", "body_subtreemass")
# Size of a load [m]: that of a solid ball of this radius.
_RADIUS = 0.05


def across(arm: Arm, joint: int) -> np.ndarray:
    """A unit direction across a joint's axis and its parent's, in the parent's frame, (3,)."""
    own = arm.rotation[joint] @ arm.axis[joint]
    direction = np.cross(arm.axis[joint - 1], own)
    if np.linalg.norm(direction) < 1e-6:
        direction = np.cross(own, np.eye(3)[np.argmin(np.abs(own))])
    return direction / np.linalg.norm(direction)


def askew(arm: Arm, effects: tuple[Effect, ...]) -> Arm:
    """The arm as it is built, where a joint sits shifted and turned on its parent."""
    for e in (e for e in effects if e.kind == "link_geometry"):
        direction, j = across(arm, e.joint), e.joint
        xyz, rotation = arm.xyz.copy(), arm.rotation.copy()
        xyz[j] += e.params["shift"] * direction
        turn = Rotation.from_rotvec(e.params["turn"] * direction).as_matrix()
        rotation[j] = turn @ rotation[j]
        arm = replace(arm, xyz=xyz, rotation=rotation)
    return arm


def loaded(arm: Arm, effect: Effect) -> Arm:
    """The arm that carries the load of an effect on its last link."""
    m, place = effect.params["m"], np.array([effect.params[a] for a in "xyz"])
    mass, com, inertia = arm.mass.copy(), arm.com.copy(), arm.inertia.copy()
    whole = mass[-1] + m
    apart = place - com[-1]
    steiner = mass[-1] * m / whole * (apart @ apart * np.eye(3) - np.outer(apart, apart))
    inertia[-1] = inertia[-1] + steiner + 0.4 * m * _RADIUS**2 * np.eye(3)
    com[-1] = (mass[-1] * com[-1] + m * place) / whole
    mass[-1] = whole
    return replace(arm, mass=mass, com=com, inertia=inertia)


def carried(effect: Effect, t) -> np.ndarray:
    """Whether the load of an effect is carried at times t."""
    return (t >= effect.params["start"]) & (t < effect.params["end"])
