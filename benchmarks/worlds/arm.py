"""One description of an arm, and the three things written from it: Pinocchio, MJCF, URDF or TOML.

Links hang in a chain. A joint is placed in the link before it by ``xyz`` [m] and ``rotation``; it turns
about, or slides along, ``axis``. Bodies are given in the axes of their joint frame. The rotor inertia
``rotor`` [kg m^2, kg] acts on its joint's acceleration alone (``armature`` in MuJoCo).
"""

import warnings
from dataclasses import dataclass

import numpy as np
import pinocchio
from scipy.spatial.transform import Rotation

GRAVITY = np.array([0.0, 0.0, -9.81])
# How stiff MuJoCo's dry friction holds: it stops a joint within some milliseconds, and lets it creep hardly.
_HELD = 'solreffriction="0.004 1" solimpfriction="0.95 0.99 0.001"'


@dataclass(frozen=True)
class Arm:
    """Kinematics, bodies, friction and limits of one arm with n joints.

    Attributes:
        name: Of the family it was drawn from.
        kinds: ``revolute`` or ``prismatic`` for each joint.
        xyz: Joint in the link before, (n, 3) [m].
        rotation: Joint in the link before, (n, 3, 3).
        axis: In the joint's frame, (n, 3).
        mass: (n,) [kg].
        com: Center of mass in the joint frame, (n, 3) [m].
        inertia: About the center of mass, (n, 3, 3) [kg m^2].
        rotor: (n,) [kg m^2 or kg].
        viscous, coulomb: (n,) [N m s/rad, N m or N s/m, N].
        width: Of the smooth sign, (n,) [rad/s or m/s].
        reach, speed, acceleration: Limits of the motion about zero, (n,).
        held: Whether dry friction is MuJoCo's own constraint, which holds a joint at rest at any torque within
            it, and not the smooth sign.
    """

    name: str
    kinds: tuple[str, ...]
    xyz: np.ndarray
    rotation: np.ndarray
    axis: np.ndarray
    mass: np.ndarray
    com: np.ndarray
    inertia: np.ndarray
    rotor: np.ndarray
    viscous: np.ndarray
    coulomb: np.ndarray
    width: np.ndarray
    reach: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray
    held: bool = False

    @property
    def size(self) -> int:
        return len(self.kinds)

    @property
    def sliding(self) -> np.ndarray:
        return np.array([kind == "prismatic" for kind in self.kinds])

    @property
    def joints(self) -> tuple[str, ...]:
        return tuple(f"joint{j + 1}" for j in range(self.size))


def pin_model(arm: Arm, gravity: np.ndarray = GRAVITY) -> pinocchio.Model:
    """The rigid arm, without rotors and friction."""
    model = pinocchio.Model()
    model.gravity.linear = np.asarray(gravity, float)
    parent = 0
    for j, kind in enumerate(arm.kinds):
        shape = (
            pinocchio.JointModelRevoluteUnaligned
            if kind == "revolute"
            else pinocchio.JointModelPrismaticUnaligned
        )
        place = pinocchio.SE3(arm.rotation[j], arm.xyz[j])
        parent = model.addJoint(parent, shape(arm.axis[j]), place, f"joint{j + 1}")
        body = pinocchio.Inertia(float(arm.mass[j]), arm.com[j], arm.inertia[j])
        model.appendBodyToJoint(parent, body, pinocchio.SE3.Identity())
    return model


def _text(values) -> str:
    return " ".join(f"{v:.17g}" for v in np.asarray(values, float).ravel())


def mjcf(arm: Arm, step: float, gravity: np.ndarray = GRAVITY, soft: tuple[int, ...] = ()) -> str:
    """The arm for MuJoCo.

    A joint in ``soft`` has two coordinates on one axis: the motor, which carries the rotor, and behind it
    the deflection of the link, whose torque the simulation supplies.
    """
    off = 'limit="disable"' if arm.held else 'constraint="disable"'
    lines = [
        '<mujoco><compiler angle="radian" inertiafromgeom="false"/>',
        f'<option timestep="{step:.17g}" gravity="{_text(gravity)}" integrator="Euler">'
        f'<flag contact="disable" {off}/></option><default><joint {_HELD}/></default><worldbody>',
    ]
    for j, kind in enumerate(arm.kinds):
        x, y, z, w = Rotation.from_matrix(arm.rotation[j]).as_quat()
        inertia = arm.inertia[j][[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        lines.append(f'<body pos="{_text(arm.xyz[j])}" quat="{_text([w, x, y, z])}">')
        lines.append(
            f'<inertial mass="{arm.mass[j]:.17g}" pos="{_text(arm.com[j])}" '
            f'fullinertia="{_text(inertia)}"/>'
        )
        shape = f'type="{"hinge" if kind == "revolute" else "slide"}" axis="{_text(arm.axis[j])}"'
        lines.append(f'<joint name="joint{j + 1}" {shape} armature="{arm.rotor[j]:.17g}"/>')
        if j in soft:
            lines.append(f'<joint name="soft{j + 1}" {shape}/>')
    return "\n".join(lines) + "</body>" * arm.size + "</worldbody></mujoco>"


def _rpy(rotation: np.ndarray) -> np.ndarray:
    """Roll, pitch, yaw about fixed axes; at a pitch of 90 degrees one of many equal triples."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return Rotation.from_matrix(rotation).as_euler("xyz")


def urdf(arm: Arm) -> str:
    """Kinematics only, as a user would have them: the bodies are what is to be identified."""
    lines = [f'<robot name="{arm.name}"><link name="base"/>']
    for j, kind in enumerate(arm.kinds):
        rpy = _rpy(arm.rotation[j])
        parent = f"link{j}" if j else "base"
        lines += [
            f'<link name="link{j + 1}"/>',
            f'<joint name="joint{j + 1}" type="{kind}"><parent link="{parent}"/>'
            f'<child link="link{j + 1}"/><origin xyz="{_text(arm.xyz[j])}" rpy="{_text(rpy)}"/>'
            f'<axis xyz="{_text(arm.axis[j])}"/><limit lower="{-2 * arm.reach[j]:.6g}" '
            f'upper="{2 * arm.reach[j]:.6g}" effort="10000" velocity="{2 * arm.speed[j]:.6g}"/></joint>',
        ]
    return "\n".join([*lines, "</robot>\n"])


def toml(arm: Arm) -> str:
    """The same kinematics as joint placements."""
    lines = [f'name = "{arm.name}"']
    for j, kind in enumerate(arm.kinds):
        rpy = _rpy(arm.rotation[j])
        lines += ["", "[[joint]]", f'name = "joint{j + 1}"', f'kind = "{kind}"']
        for key, value in (("xyz", arm.xyz[j]), ("rpy", rpy), ("axis", arm.axis[j])):
            lines.append(f"{key} = [{', '.join(repr(float(v)) for v in value)}]")
    return "\n".join(lines) + "\n"
