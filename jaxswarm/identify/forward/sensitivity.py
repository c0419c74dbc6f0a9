"""What the rigid torque does when one joint moves otherwise than logged: columns and their derivatives."""

from dataclasses import dataclass

import numpy as np

from jaxswarm.identify.forward.columns import Rigid
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.model import Robot

# Steps of the differences along position and velocity [rad, rad/s]. The torque is quadratic in velocity,
# so that its step may be any, and linear in acceleration.
_POSITION, _VELOCITY = 1e-5, 1e-2


@dataclass(frozen=True)
class Sensitivity:
    """Rigid columns of a log and their derivatives by the motion of one joint.

    Links before the joint do not feel it: the derivatives have the columns of the links from it on.

    Attributes:
        joint: The joint, j.
        full: Rigid columns, (T, n, 10 n).
        by_q, by_dq, by_ddq: Derivatives of the last 10 (n - j) columns by the joint's position,
            velocity and acceleration.
    """

    joint: int
    full: np.ndarray
    by_q: np.ndarray
    by_dq: np.ndarray
    by_ddq: np.ndarray

    def at(self, pi: np.ndarray, joints: slice = slice(None)) -> tuple[np.ndarray, ...]:
        """Torque of joints and its three derivatives, (T, n) each, for rigid parameters (10 n,).

        Of several sets of parameters (k, 10 n) they are (T, n, k).
        """
        felt = pi[..., 10 * self.joint :].T
        slopes = (slope[:, joints] @ felt for slope in (self.by_q, self.by_dq, self.by_ddq))
        return (self.full[:, joints] @ pi.T, *slopes)

    def inertia(self, pi: np.ndarray) -> np.ndarray:
        """The joint's own inertia along the log, (T,)."""
        return self.by_ddq[:, self.joint] @ pi[10 * self.joint :]

    def own(self) -> np.ndarray:
        """The joint's own row of the columns and of their derivatives, (4, T, 10 n)."""
        rows = np.zeros((4, *self.full[:, self.joint].shape))
        rows[0] = self.full[:, self.joint]
        for row, slope in zip(rows[1:], (self.by_q, self.by_dq, self.by_ddq), strict=True):
            row[:, 10 * self.joint :] = slope[:, self.joint]
        return rows


def sensitivity_of(
    robot: Robot, motion: Motion, joint: int, rigid: Rigid | None = None
) -> Sensitivity:
    """Differences of the rigid columns along one joint's motion.

    They follow from the motion and gravity alone: found once for every log, whatever is fitted to it.

    Args:
        robot: Kinematics and gravity.
        motion: The log.
        joint: The joint.
        rigid: The log's rigid columns where they are known; it keeps what is found here.
    """
    if rigid is None or not np.array_equal(robot.gravity, rigid.gravity):
        here = (motion.q, motion.dq, motion.ddq)
        return _differences(robot, motion, joint, rigid_columns(robot, *here))
    if joint not in rigid.sensed:
        rigid.sensed[joint] = _differences(robot, motion, joint, rigid.full)
    return rigid.sensed[joint]


def _differences(robot: Robot, motion: Motion, joint: int, full: np.ndarray) -> Sensitivity:
    here = (motion.q, motion.dq, motion.ddq)

    def moved(argument: int, step: float) -> np.ndarray:
        there = list(here)
        there[argument] = here[argument] + step * (np.arange(robot.num_joints) == joint)
        return rigid_columns(robot, *there, first=joint)

    def central(argument: int, step: float) -> np.ndarray:
        return (moved(argument, step) - moved(argument, -step)) / (2.0 * step)

    by_ddq = moved(2, 1.0) - full[:, :, 10 * joint :]
    return Sensitivity(joint, full, central(0, _POSITION), central(1, _VELOCITY), by_ddq)
