"""Random trees of joints, as joint lists and as URDF, and the same tree in Pinocchio."""

import numpy as np
import pinocchio as pin

from jaxswarm.robot import Joint, Robot
from jaxswarm.robot.placements import body_parameters, rotation_rpy


def random_link(rng: np.random.Generator) -> np.ndarray:
    """Ten parameters of a random physical body."""
    spread = rng.normal(size=(3, 3))
    second = spread @ spread.T * 0.05
    inertia = np.trace(second) * np.eye(3) - second
    return body_parameters(rng.uniform(0.5, 5.0), rng.normal(size=3) * 0.2, inertia)


def random_joints(seed: int, num_joints: int, kinds=("revolute", "prismatic", "fixed")):
    """Joints of a random tree; the first one moves."""
    rng = np.random.default_rng(seed)
    joints = []
    for j in range(num_joints):
        parent = None if j == 0 else f"j{rng.integers(max(0, j - 3), j)}"
        joints.append(
            Joint(
                name=f"j{j}",
                kind=str(rng.choice(kinds)) if j else "revolute",
                parent=parent,
                rotation=rotation_rpy(rng.uniform(-3, 3, size=3)),
                translation=rng.normal(size=3) * 0.4,
                axis=rng.normal(size=3) if rng.random() < 0.5 else np.eye(3)[rng.integers(3)],
                parameters=random_link(rng),
            )
        )
    return joints


def urdf_text(seed: int, num_joints: int) -> str:
    """A random tree as URDF: bodies with their own inertia axes, fixed joints, a loaded base."""
    rng = np.random.default_rng(seed)

    def numbers(values):
        return " ".join(f"{v:.17g}" for v in values)

    def link(name):
        spread = rng.normal(size=(3, 3))
        second = spread @ spread.T * 0.05
        i = np.trace(second) * np.eye(3) - second
        return (
            f'<link name="{name}"><inertial><origin xyz="{numbers(rng.normal(size=3) * 0.2)}" '
            f'rpy="{numbers(rng.uniform(-1, 1, size=3))}"/>'
            f'<mass value="{rng.uniform(0.5, 5):.17g}"/>'
            f'<inertia ixx="{i[0, 0]:.17g}" ixy="{i[0, 1]:.17g}" ixz="{i[0, 2]:.17g}" '
            f'iyy="{i[1, 1]:.17g}" iyz="{i[1, 2]:.17g}" izz="{i[2, 2]:.17g}"/></inertial></link>'
        )

    parts = [link("l0")]
    for j in range(num_joints):
        kind = (
            "revolute" if j == 0 else rng.choice(["revolute", "prismatic", "fixed", "continuous"])
        )
        axis = rng.normal(size=3)
        above = rng.integers(max(0, j - 2), j + 1)
        parts.append(link(f"l{j + 1}"))
        parts.append(
            f'<joint name="j{j}" type="{kind}"><parent link="l{above}"/>'
            f'<child link="l{j + 1}"/><origin xyz="{numbers(rng.normal(size=3) * 0.4)}" '
            f'rpy="{numbers(rng.uniform(-3, 3, size=3))}"/>'
            f'<axis xyz="{numbers(axis / np.linalg.norm(axis))}"/>'
            '<limit lower="-9" upper="9" effort="1" velocity="1"/></joint>'
        )
    return f'<robot name="tree{seed}">{"".join(parts)}</robot>'


def to_pinocchio(robot: Robot) -> pin.Model:
    """The same tree as a Pinocchio model; joint order is kept."""
    model = pin.Model()
    model.gravity.linear = np.asarray(robot.gravity)
    ids = []
    for i, name in enumerate(robot.joints):
        axis = np.asarray(robot.axis[i], dtype=float)
        kind = pin.JointModelRevoluteUnaligned if robot.kinds[i] == "revolute" else None
        joint = (kind or pin.JointModelPrismaticUnaligned)(axis)
        parent = 0 if robot.parents[i] < 0 else ids[robot.parents[i]]
        place = pin.SE3(np.asarray(robot.rotation[i]), np.asarray(robot.translation[i]))
        ids.append(model.addJoint(parent, joint, place, name))
        inertia = pin.Inertia.FromDynamicParameters(np.asarray(robot.parameters[i], dtype=float))
        model.appendBodyToJoint(ids[-1], inertia, pin.SE3.Identity())
    return model


def random_state(robot: Robot, seed: int):
    """Position, velocity and acceleration, each (n,)."""
    return np.random.default_rng(seed).normal(size=(3, robot.num_joints))
