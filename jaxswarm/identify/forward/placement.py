"""What the rigid torque does when a joint sits elsewhere on its parent: differences by its placement."""

import numpy as np

from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.placement import moved_joint, own_moves
from jaxswarm.robot.logged import rigid_torque
from jaxswarm.robot.model import Robot

# Half a difference [m, rad]: errors of the second difference and of rounding are alike small.
_STEP = 1e-5


def placement_columns(
    law: BodyChange, joint: int, arm: Robot, moved: tuple[np.ndarray, ...], pi: np.ndarray
) -> np.ndarray:
    """Derivatives (T, n, k) of the rigid torque by the linear parameters of a placement.

    Args:
        law: A law with a placement.
        joint: The joint that sits elsewhere.
        arm: The robot in its gravity.
        moved: Motion of the links, q, dq, ddq, each (T, n).
        pi: Rigid parameters, (10 n,).
    """
    arm = arm.replace(parameters=np.asarray(pi, float).reshape(-1, 10), name="", notes=())
    neutral, own = {p.name: 0.0 for p in law.linear}, own_moves(arm, joint)
    placement = law.placement
    assert placement is not None

    def torque(name, step):
        moves = own * np.asarray(placement({**neutral, name: step}))
        return rigid_torque(moved_joint(arm, joint, moves), *moved)

    columns = [(torque(p.name, _STEP) - torque(p.name, -_STEP)) / (2 * _STEP) for p in law.linear]
    return np.stack(columns, axis=2)
