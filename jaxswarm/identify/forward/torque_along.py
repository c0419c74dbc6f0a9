"""The torque of a model along a log without its columns, which of a long log fill gigabytes."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.columns import Rigid, load_along, rigid_torque, term_columns
from jaxswarm.identify.forward.link_lag import link_motion
from jaxswarm.identify.forward.measuring_chain import (
    moves_links,
    own_columns,
    report,
    tilted,
    uses_load,
)
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot


def torque_along(
    robot: Robot,
    terms: tuple[Term, ...],
    motion: Motion,
    width: Sequence[float],
    theta: np.ndarray,
    rigid: Rigid | None = None,
) -> np.ndarray:
    """Torque (T, n) of a model along a log, ``assemble(...) @ theta``, without its columns in memory.

    Args:
        robot, terms, motion, width, rigid: As for :func:`jaxswarm.identify.forward.measuring_chain.assemble`.
        theta: Linear parameters, the rigid ones first; transmissions and loads go by those, (p,).
    """
    k = 10 * robot.num_joints
    pi, load = theta[:k], None
    if moves_links(terms) or rigid is None:
        arm = tilted(robot, terms)
        moved = link_motion(arm, terms, motion, pi, rigid)
        torque = rigid_torque(arm, *moved, pi)
        if uses_load(terms):
            load = load_along(arm, moved, pi)
    else:
        torque = rigid.torque(pi)
        if uses_load(terms):
            load = rigid.load(pi)
    for term in terms:
        size = len(term.columns(robot.joints))
        own, k = theta[k : k + size], k + size
        if isinstance(term.law, TorqueLaw):
            torque[:, term.joint] += term_columns(term, motion, width, load) @ own
        elif size:
            torque += own_columns(term, motion, width, load) @ own
    return report(terms, motion, torque)
