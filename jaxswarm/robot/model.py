"""The robot: a tree of moving joints, each carrying one link of ten inertial parameters.

The frame of link i is the frame of joint i after its motion. At q = 0 it has the pose
(``rotation[i]``, ``translation[i]``) in the frame of link ``parents[i]``; a revolute joint then
turns it by q about ``axis[i]`` and a prismatic one shifts it by q along it. Structure (names,
kinds, parents) is static; every number is a leaf, so a robot can be differentiated, batched and
identified without recompiling. Fixed joints exist only while a robot is built: their links are
lumped into the moving link they sit on, and what is fixed to the base has no dynamics.
"""

import dataclasses

import jax
import numpy as np

from jaxswarm.nodes import node

KINDS = ("revolute", "prismatic")


@node
@dataclasses.dataclass(frozen=True, eq=False)
class Robot:
    """A tree of n revolute and prismatic joints.

    Attributes:
        name: Name of the robot.
        joints: Names of the moving joints, parents before children.
        kinds: ``"revolute"`` or ``"prismatic"`` for each joint.
        parents: Index of each joint's parent joint, -1 for the base.
        rotation: (n, 3, 3), rotation of each joint frame in its parent's frame at q = 0.
        translation: (n, 3), its origin in m.
        axis: (n, 3), unit axis of motion, in the joint frame.
        gravity: (3,), acceleration of free fall in base axes, in m/s^2.
        parameters: (n, 10), (m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz) of each link in
            kg, kg m, kg m^2, inertia about the origin of the joint frame, in its axes.
        drive_gain: (n,), joint torque or force per unit of measured current or voltage
            (N m/A, N/A, N/V); NaN where none is known.
        notes: What was left out, locked or added when the robot was read, one sentence each.
    """

    name: str = dataclasses.field(metadata={"static": True})
    joints: tuple[str, ...] = dataclasses.field(metadata={"static": True})
    kinds: tuple[str, ...] = dataclasses.field(metadata={"static": True})
    parents: tuple[int, ...] = dataclasses.field(metadata={"static": True})
    rotation: jax.Array
    translation: jax.Array
    axis: jax.Array
    gravity: jax.Array
    parameters: jax.Array
    drive_gain: jax.Array
    notes: tuple[str, ...] = dataclasses.field(default=(), metadata={"static": True})

    @property
    def num_joints(self) -> int:
        """Number of moving joints n."""
        return len(self.joints)

    @property
    def length(self) -> float:
        """Length of all links together [m]."""
        return float(np.linalg.norm(np.asarray(self.translation), axis=1).sum())

    def replace(self, **changes) -> "Robot":
        """Return a copy with fields replaced, e.g. ``robot.replace(parameters=identified)``."""
        return dataclasses.replace(self, **changes)
