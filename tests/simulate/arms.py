"""Small physical arms for the simulation tests."""

import numpy as np

from jaxswarm.robot import Joint, Robot, build_robot
from jaxswarm.robot.placements import body_parameters, rotation_x


def two_joint_arm(kind: str = "revolute") -> Robot:
    """A vertical pendulum that carries a second, tilted joint."""
    body = body_parameters(2.0, [0.2, 0.05, 0.1], np.diag([0.03, 0.05, 0.04]))
    return build_robot(
        "arm",
        [
            Joint("joint1", rotation=rotation_x(np.pi / 2), parameters=body),
            Joint(
                "joint2",
                kind=kind,
                parent="joint1",
                rotation=rotation_x(0.4),
                translation=np.array([0.4, 0.0, 0.1]),
                parameters=0.5 * body,
            ),
        ],
    )


def slide(mass: float = 1.0) -> Robot:
    """One horizontal slide of the given mass in kg."""
    joint = Joint("slide", "prismatic", axis=np.array([1.0, 0, 0]))
    robot = build_robot("slide", [joint])
    return robot.replace(parameters=np.array([[mass] + [0.0] * 9]))
