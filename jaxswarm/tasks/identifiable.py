"""What could be identified from a log, and what not, before anything is fitted.

The columns of the rigid body and of dry and viscous friction along the motion are scaled to unit norm. How
far each sticks out of the space of the others says how far errors are magnified into its parameter:
1 / sin(angle), the square root of the variance inflation factor of regression.

Reference: D. A. Belsley, E. Kuh, R. E. Welsch, Regression Diagnostics, 1980, chapter 3.
"""

import numpy as np

from jaxswarm.decomposition import thin_svd
from jaxswarm.effects.friction import USUAL_FRICTION
from jaxswarm.effects.term import parse_terms
from jaxswarm.identify.estimation.base_parameters import find_base
from jaxswarm.identify.estimation.factors import triangular_factor
from jaxswarm.identify.forward.measuring_chain import assemble
from jaxswarm.identify.forward.names import column_names
from jaxswarm.identify.physical.physical_model import random_columns
from jaxswarm.logs.motion import Motion
from jaxswarm.robot import Robot, standard_parameter_names

# Errors of a model of a good arm are about 1 % of its torque: magnified a hundred times they are as large
# as the parameter, thirty times they leave one digit.
_LOST, _WEAK = 100.0, 30.0
# Smooth sign [rad/s or m/s]: sharp against any motion; only its directions matter here.
_WIDTH = 0.01


def identifiable(robot: Robot, motions: list[Motion]) -> dict:
    """Condition number and magnification of every base parameter on these motions.

    Args:
        robot: Kinematics.
        motions: Prepared logs; torque is not needed.

    Returns:
        ``condition_number``, ``base_parameters`` (name, expression, magnification, verdict: determined,
        weak or lost) and ``never_seen`` (base parameters of the arm of which the motion shows nothing,
        or that it cannot tell from others).
    """
    terms = parse_terms(USUAL_FRICTION, robot.joints)
    zero = np.zeros(10 * robot.num_joints)
    parts = []
    for motion in motions:
        kept = motion.decimator.kept(len(motion.t))
        columns = assemble(robot, terms, motion, [_WIDTH] * robot.num_joints, zero)[kept]
        # Small joints count as much as large ones: each is a row of its own scale.
        scale = np.sqrt(np.mean(columns**2, axis=(0, 2)))
        parts.append((columns / np.maximum(scale, 1e-12)[:, None]).reshape(-1, columns.shape[2]))
    names = column_names(robot, terms)
    factor = triangular_factor(np.concatenate(parts))
    base = find_base(factor, names)
    kept = triangular_factor(factor[:, base.kept])
    norm = np.linalg.norm(kept, axis=0)
    left, singular, right = thin_svd(kept / norm)
    del left
    magnified = np.sqrt(np.sum((right / singular[:, None]) ** 2, axis=0))
    rows = [
        {
            "name": names[column].split(":")[0],
            "expression": text,
            "magnification": float(value),
            "verdict": "lost" if value > _LOST else "weak" if value > _WEAK else "determined",
        }
        for column, text, value in zip(base.kept, base.expressions(), magnified, strict=True)
    ]
    arm = random_columns(robot).reshape(-1, zero.size)
    whole = find_base(arm, standard_parameter_names(robot))
    seen = {names[c] for c in base.kept}
    missing = [
        text
        for column, text in zip(whole.kept, whole.expressions(), strict=True)
        if whole.names[column] not in seen
    ]
    return {
        "condition_number": float(singular[0] / singular[-1]),
        "base_parameters": rows,
        "never_seen": missing,
    }
