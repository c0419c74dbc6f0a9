"""What the rigid torque does when a joint sits elsewhere on its parent, by the parameters of its placement."""

import numpy as np

from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.placement import across, own_moves
from jaxswarm.robot.displaced import displacement_slopes
from jaxswarm.robot.model import Robot


def placement_columns(
    law: BodyChange, joint: int, arm: Robot, moved: tuple[np.ndarray, ...], pi: np.ndarray
) -> np.ndarray:
    """Derivatives (T, n, k) of the rigid torque by the parameters of a placement.

    Args:
        law: A law with a placement.
        joint: The joint that sits elsewhere.
        arm: The robot in its gravity.
        moved: Motion of the links, q, dq, ddq, each (T, n).
        pi: Rigid parameters, (10 n,).
    """
    arm = arm.replace(parameters=np.asarray(pi, float).reshape(-1, 10), name="", notes=())
    neutral, own = {p.name: 0.0 for p in law.parameters}, own_moves(arm, joint)
    placement = law.placement
    assert placement is not None
    by_each = np.stack([np.asarray(placement({**neutral, p.name: 1.0})) for p in law.parameters])
    # Parameters, shifts and turns, along two directions each.
    moves = (own * by_each) @ across(arm, joint)
    q, dq, ddq = moved
    columns = np.zeros((*q.shape, len(moves)))
    told = moves.any(axis=(1, 2))
    columns[:, :, told] = displacement_slopes(arm, q, dq, ddq, joint, moves[told])
    return columns
