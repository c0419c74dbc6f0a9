r"""What a base that gives way does to the torque, to first order about a base that does not.

The moment M of the base follows from the rigid body on hinges; with the turns :math:`\theta` that follow from
:math:`-c M` (:mod:`jaxswarm.identify.forward.base_swing`) and their derivatives,
:math:`\tau_\theta \theta + \tau_{\dot\theta} \dot\theta + \tau_{\ddot\theta} \ddot\theta` are the columns.
"""

import numpy as np

from jaxswarm.decomposition import thin_svd
from jaxswarm.effects.hinged_base import TURNS, hinged
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.base_swing import swings
from jaxswarm.identify.forward.body import Body
from jaxswarm.identify.forward.columns import is_kept
from jaxswarm.identify.forward.sway_response import SwayResponse
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.model import Robot

# States that are drawn to see which masses a swaying base feels, and the part of the largest response below
# which one is rounding: on the arm of the detection limits they are 1 to 0.08, or below 3e-12.
_DRAWN, _FELT = 64, 1e-9


def compliance_columns(term: Term, body: Body) -> np.ndarray:
    """Torque (T, n, k) by the linear parameters of a compliance.

    Args:
        term: A compliance; one that swings with its values.
        body: The rigid body along a log.
    """
    kept = _kept(body)
    if kept is not None:
        return _response(body, kept).columns(term, body.pi)
    own = SwayResponse(body.arm, body.moved, body.motion, body.pi[:, None])
    return own.columns(term, np.ones(1))


def compliance_slopes(term: Term, body: Body) -> tuple[np.ndarray, np.ndarray | None]:
    """Derivatives of a compliance's torque that its columns do not show, for arguments as above.

    It is a moment's sway of an arm, which swings with its inertia: all follow from the parameters. What no
    joint of a level arm feels of the first link is part of the moment, and shows once the base turns: with
    these parameters left out a fit that knew the law left 6.3 times the noise on the first joint, and laws that
    were none were told of it. With the inertia as it stands fits of one swing ended in many places.

    Returns:
        By the rigid parameters, (T, n, 10 n), and by the linear ones of a base that swings, (T, n, k).
    """
    response = _response(body, _kept(body))
    bends = response.bends(term, body.pi) if swings(term) else None
    return response.at(term, body.pi)[:, :, 1:], bends


def _kept(body: Body) -> dict | None:
    """What is kept of a log whose links do as it says: a fit asks for its responses at every step."""
    if body.rigid is None or not is_kept(body.motion):
        return None
    return body.rigid.swayed


def _response(body: Body, kept: dict | None) -> SwayResponse:
    """The responses to turns of the base by every rigid parameter."""
    found = {} if kept is None else kept
    if "response" not in found:
        every, again = np.eye(len(body.pi)), is_kept(body.motion)
        found["response"] = SwayResponse(body.arm, body.moved, body.motion, every, again)
    return found["response"]


def felt_once_swayed(arm: Robot, unfelt: np.ndarray) -> np.ndarray:
    """Directions (10 n, r) of rigid parameters that no joint of a level arm feels and a base that sways does.

    Args:
        arm: The robot in its gravity.
        unfelt: Directions that the joints do not feel while the base stays level, (10 n, m).
    """
    rng = np.random.default_rng(0)
    drawn = rng.uniform(-1.0, 1.0, size=(3, _DRAWN, arm.num_joints + TURNS))
    rows = rigid_columns(hinged(arm), *drawn, first=TURNS)
    _, size, right = thin_svd(rows.reshape(-1, len(unfelt)) @ unfelt)
    return unfelt @ right[size > _FELT * max(size.max(initial=0.0), 1e-300)].T
