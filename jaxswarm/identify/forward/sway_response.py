r"""What a base that gives way does to the torque along rigid parameters, from its response to single turns.

The torque that the joints feel of a base's turn :math:`\theta` about a level axis e is linear in the rigid
parameters and, to first order, in the turn and its derivatives: gravity turns the other way, the velocity bends
the paths of all links, the acceleration carries them along,

.. math:: \tau_\theta\,\theta + \tau_{\dot\theta}\,\dot\theta + \tau_{\ddot\theta}\,\ddot\theta.

The moment of the base, whose share the turn is, is linear in them too, so that a compliance is bilinear in the
parameters that load the base and those that are carried by it. The six responses are made once for all of them.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.effects.hinged_base import TURNS, hinged
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.identify.forward.columns import Moved
from jaxswarm.identify.forward.compliance import moment_along, softness_by
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.logged import BLOCK, rigid_torques
from jaxswarm.robot.model import Robot

_LEVEL = np.zeros(TURNS)


def compliance_along(
    law: BodyChange,
    arm: Robot,
    moved: Moved,
    pi: np.ndarray,
    motion: Motion,
    directions: np.ndarray,
) -> np.ndarray:
    """Torque by the linear parameters of a compliance, and its derivatives along rigid parameters.

    Args:
        law, arm, moved, pi, motion: As for :func:`~jaxswarm.identify.forward.compliance.compliance_columns`.
        directions: Of rigid parameters, (10 n, r).

    Returns:
        (T, n, k + r k): the torque by each of the k parameters, then its derivatives direction by direction.
    """
    softness = softness_by(law)
    every = np.column_stack([pi, directions])
    robot, count = hinged(arm), len(moved[0])
    # Of a long log some samples at a time: the torques of all masses are many times the motion.
    parts = [slice(start, start + BLOCK) for start in range(0, count, BLOCK)]
    moments = [_moment(robot, [x[part] for x in moved], every) for part in parts]
    along = moment_along(np.concatenate(moments, axis=1).T, motion)
    # By turn and derivative, and by what loads the base.
    sway = -along.T.reshape(TURNS, -1, 3, count).transpose(2, 0, 1, 3)
    found = np.empty((count, arm.num_joints, len(softness) * every.shape[1]))
    for part in parts:
        felt = _felt(arm, robot, moved[0][part], moved[1][part], every)
        for k, soft in enumerate(softness):
            given = (sway[..., part] * soft[:, None, None]).reshape(3 * TURNS, every.shape[1], -1)
            found[part, :, k :: len(softness)] = _bilinear(felt, given).transpose(2, 0, 1)
    return found


def _bilinear(felt: np.ndarray, sway: np.ndarray) -> np.ndarray:
    """What a sway does to the torque, and both changes of it along each direction, (n, 1 + r, T).

    Args:
        felt: Torque by each turn, of the parameters and each direction, (6, n, 1 + r, T).
        sway: Turns and derivatives by the moment of the parameters and of each direction, (6, 1 + r, T).
    """
    total = np.zeros(felt.shape[1:])
    for by, turn in zip(felt, sway, strict=True):
        total += by[:, :1] * turn
        total[:, 1:] += by[:, 1:] * turn[0]
    return total


def _moment(robot: Robot, moved: Sequence[np.ndarray], every: np.ndarray) -> np.ndarray:
    """Moments (2 m, T) of a base at rest below a motion (T, n) each, of parameters (10 n, m)."""
    q, dq, ddq = map(_on_base, moved)
    return rigid_torques(robot, q, dq, ddq, every, first=TURNS)[:TURNS].reshape(-1, len(q))


def _felt(arm: Robot, robot: Robot, q: np.ndarray, dq: np.ndarray, every: np.ndarray) -> np.ndarray:
    """Torque (6, n, m, T) by turns of the base and by two derivatives of them, of parameters (10 n, m)."""
    rest, floating = np.zeros_like(q), robot.replace(gravity=np.zeros(3))

    def on_moving_base(speed: np.ndarray, push: np.ndarray) -> np.ndarray:
        return rigid_torques(floating, _on_base(q), speed, push, every, first=TURNS)[TURNS:]

    turned, sped, pushed = [], [], []
    for turn in np.eye(TURNS):
        # Seen from the base it is gravity that turns, the other way.
        lean = np.cross(np.asarray(arm.gravity, float), np.append(turn, 0.0))
        turned.append(rigid_torques(arm.replace(gravity=lean), q, rest, rest, every))
        ahead, behind = (
            on_moving_base(_on_base(dq, way * turn), _on_base(rest)) for way in (1.0, -1.0)
        )
        sped.append((ahead - behind) / 2.0)
        pushed.append(on_moving_base(_on_base(rest), _on_base(rest, turn)))
    return np.stack([*turned, *sped, *pushed])


def _on_base(x: np.ndarray, turn: np.ndarray = _LEVEL) -> np.ndarray:
    """A motion of the arm (T, n) on a base that turns, (T, 2 + n)."""
    return np.concatenate([np.broadcast_to(turn, (len(x), TURNS)), x], axis=1)
