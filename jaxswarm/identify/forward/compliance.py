r"""What a base that gives way does to the torque, to first order about a base that does not.

The moment M of the base follows from the rigid body on hinges; with :math:`\theta = -c M` and its derivatives,
of M below the cutoff of the torque (above it there is noise differentiated four times),
:math:`\tau_\theta \theta + \tau_{\dot\theta} \dot\theta + \tau_{\ddot\theta} \ddot\theta` are the columns.
"""

import numpy as np

from jaxswarm.effects.hinged_base import TURNS, hinged
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.logs.filtering import derivatives
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.smoothing import smooth
from jaxswarm.robot.logged import rigid_torque
from jaxswarm.robot.model import Robot

# Largest turn [rad] of the differences along a sway: errors of the third power and of rounding are alike
# small. What its velocity and acceleration do is quadratic and linear, so that it is exact.
_STEP = 1e-5


def _swayed(robot: Robot, sway: np.ndarray, moved: tuple[np.ndarray, ...]) -> np.ndarray:
    """Torque (T, n + 2) of a hinged robot whose base moves by a sway (T, 3, 2) and its arm as given."""
    whole = [np.concatenate([sway[:, k], x], axis=1) for k, x in enumerate(moved)]
    return rigid_torque(robot, *whole)


def _felt(robot: Robot, sway: np.ndarray, moved: tuple[np.ndarray, ...]) -> np.ndarray:
    """Torque (T, n) of the joints by a sway (T, 3, 2) of the base: turns and two derivatives."""
    step = _STEP / (np.abs(sway[:, 0]).max() or 1.0)
    change = _swayed(robot, step * sway, moved) - _swayed(robot, -step * sway, moved)
    return change[:, TURNS:] / (2.0 * step)


def compliance_columns(
    law: BodyChange, arm: Robot, moved: tuple[np.ndarray, ...], pi: np.ndarray, motion: Motion
) -> np.ndarray:
    """Torque (T, n, k) by the linear parameters of a compliance.

    Args:
        law: A law with a compliance.
        arm: The robot in its gravity.
        moved: Motion of the links, q, dq, ddq, each (T, n).
        pi: Rigid parameters, (10 n,).
        motion: The log, for its rate and the cutoff of its torque.
    """
    robot = hinged(arm.replace(parameters=np.asarray(pi, float).reshape(-1, 10)))
    still = np.zeros((len(motion.t), 3, TURNS))
    moment = _swayed(robot, still, moved)[:, :TURNS]
    moment = smooth(moment, motion.rate, motion.torque_cutoff)
    along = np.stack([moment, *derivatives(moment, motion.rate, 2)], axis=1)
    none = {p.name: 0.0 for p in law.linear}
    turns = law.compliance
    assert turns is not None
    sways = [-along * np.asarray(turns({**none, p.name: 1.0})) for p in law.linear]
    return np.stack([_felt(robot, sway, moved) for sway in sways], axis=2)
