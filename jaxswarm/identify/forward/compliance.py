r"""What a base that gives way does to the torque, to first order about a base that does not.

The moment M of the base follows from the rigid body on hinges; with :math:`\theta = -c M` and its derivatives,
of M below the cutoff of the torque (above it there is noise differentiated four times),
:math:`\tau_\theta \theta + \tau_{\dot\theta} \dot\theta + \tau_{\ddot\theta} \ddot\theta` are the columns.
"""

import numpy as np

from jaxswarm.decomposition import thin_svd
from jaxswarm.effects.hinged_base import TURNS, hinged
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.term import Term
from jaxswarm.logs.filtering import derivatives
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.smoothing import smooth
from jaxswarm.robot.logged import rigid_columns, rigid_torque
from jaxswarm.robot.model import Robot

# Largest turn [rad] of the differences along a sway: errors of the third power and of rounding are alike
# small. What its velocity and acceleration do is quadratic and linear, so that it is exact.
_STEP = 1e-5
# States that are drawn to see which masses a swaying base feels, and the part of the largest response below
# which one is rounding: on the arm of the detection limits they are 1 to 0.08, or below 3e-12.
_DRAWN, _FELT = 64, 1e-9


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
    robot = _on_hinges(arm, pi)
    moment = _swayed(robot, _still(moved), moved)[:, :TURNS]
    along = moment_along(moment, motion)
    sways = [-along * soft for soft in softness_by(law)]
    return np.stack([_felt(robot, sway, moved) for sway in sways], axis=2)


def softness_by(law: BodyChange) -> list[np.ndarray]:
    """What a compliance makes of a moment, (2,) about both axes, by each of its linear parameters."""
    none, turns = {p.name: 0.0 for p in law.linear}, law.compliance
    assert turns is not None
    return [np.asarray(turns({**none, p.name: 1.0})) for p in law.linear]


def felt_once_swayed(arm: Robot, unfelt: np.ndarray) -> np.ndarray:
    """Directions (10 n, r) of rigid parameters that no joint of a level arm feels and a base that sways does.

    Args:
        arm: The robot in its gravity.
        unfelt: Directions that the joints do not feel while the base stays level, (10 n, m).
    """
    rng = np.random.default_rng(0)
    drawn = rng.uniform(-1.0, 1.0, size=(3, _DRAWN, arm.num_joints + TURNS))
    rows = rigid_columns(_on_hinges(arm, np.zeros(len(unfelt))), *drawn, first=TURNS)
    _, size, right = thin_svd(rows.reshape(-1, len(unfelt)) @ unfelt)
    return unfelt @ right[size > _FELT * max(size.max(initial=0.0), 1e-300)].T


def compliance_slopes(
    term: Term,
    arm: Robot,
    moved: tuple[np.ndarray, ...],
    pi: np.ndarray,
    motion: Motion,
    kept: dict | None = None,
) -> np.ndarray:
    """Torque (T, n) of a compliance by the rigid parameters, (T, n, 10 n); arguments as above.

    It is a moment's sway of an arm: both follow from the parameters. What no joint of a level arm feels of the
    first link is part of the moment, and shows once the base turns: with these parameters left out a fit that
    knew the law left 6.3 times the noise on the first joint, and laws that were none were told of it.

    ``kept``: remembers what follows from the motion alone, for the next call with the same one.
    """
    robot, turns = _on_hinges(arm, pi), term.law_of(BodyChange).compliance
    assert turns is not None
    softness = np.asarray(turns(term.values))
    still = _still(moved)
    at = [np.concatenate([still[:, k], x], axis=1) for k, x in enumerate(moved)]
    known = {} if kept is None else kept
    if "along" not in known:
        known["along"] = _moments_along(robot, at, motion)
    along = known["along"] * -np.tile(softness, 3)[:, None]
    sway = (along @ pi).reshape(still.shape)
    step = _STEP / (np.abs(sway[:, 0]).max() or 1.0)
    ahead, behind = (
        rigid_columns(
            robot, *(a + way * _padded(sway[:, k], a) for k, a in enumerate(at)), first=TURNS
        )
        for way in (step, -step)
    )
    units = np.eye(3 * TURNS).reshape(-1, 1, 3, TURNS)
    felt = np.stack([_felt(robot, still + unit, moved) for unit in units], axis=2)
    return (ahead - behind)[:, TURNS:] / (2.0 * step) + felt @ along


def _moments_along(robot: Robot, at: list[np.ndarray], motion: Motion) -> np.ndarray:
    """Moments of a base at rest and two derivatives of each by the rigid parameters, (T, 6, 10 n)."""
    moments = rigid_columns(robot, *at, first=TURNS)[:, :TURNS]
    along = moment_along(moments.reshape(len(moments), -1), motion)
    return along.reshape(len(moments), 3 * TURNS, -1)


def _on_hinges(arm: Robot, pi: np.ndarray) -> Robot:
    return hinged(arm.replace(parameters=np.asarray(pi, float).reshape(-1, 10)))


def _still(moved: tuple[np.ndarray, ...]) -> np.ndarray:
    """A base that does not move, (T, 3, 2)."""
    return np.zeros((len(moved[0]), 3, TURNS))


def _padded(sway: np.ndarray, like: np.ndarray) -> np.ndarray:
    """A motion of the base (T, 2) as one of the whole arm on it, (T, n + 2)."""
    return np.pad(sway, ((0, 0), (0, like.shape[1] - TURNS)))


def moment_along(moment: np.ndarray, motion: Motion) -> np.ndarray:
    """Moments (T, m) below the torque's cutoff with two derivatives, (T, 3, m)."""
    low = smooth(moment, motion.rate, motion.torque_cutoff)
    return np.stack([low, *derivatives(low, motion.rate, 2)], axis=1)
