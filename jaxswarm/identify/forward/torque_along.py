"""The torque of a model along a log without its columns, which of a long log fill gigabytes."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.body import body_along
from jaxswarm.identify.forward.columns import Rigid, early_torque
from jaxswarm.identify.forward.measuring_chain import distorted, true_torque, uses_load
from jaxswarm.identify.forward.own_columns import own_columns
from jaxswarm.identify.forward.written_down import report
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
    body = body_along(robot, terms, motion, theta[:k], rigid)
    load = body.load() if uses_load(terms) else None
    ends = k + np.cumsum([len(t.columns(robot.joints)) for t in terms], dtype=int)
    values = np.split(theta[k:], ends[:-1] - k) if terms else []
    torque = true_torque(terms, values, body, width, load)
    if distorted(terms):
        assert load is not None  # whatever distorts a torque asks for the load
        load = load._replace(whole=torque)
        beside = [
            own_columns(term, motion, width, load) @ own
            for term, own in zip(terms, values, strict=True)
            if distorted((term,))
        ]
        torque = torque + sum(beside)
    read = report(terms, motion, torque)
    return read + early_torque(robot, motion, theta[:k]) if motion.weight_skew else read
