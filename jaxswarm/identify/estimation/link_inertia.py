r"""No link has a negative inertia: what the fit of a soft joint has to keep to.

A rigid joint shows the sum of its rotor's and its link's inertia only. Through a soft gear the link lags by
its own, so that the two separate, but weakly; a split that noise has decided may leave a link of negative
inertia, which turns the lag's equation of motion around and harms every joint beyond it. The link's
inertia :math:`M_{jj}(q)` is linear in the rigid parameters and positive in every position, reached or not.
"""

from collections.abc import Sequence

import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.kinds import TransmissionLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.model import Robot

# Positions at which the inertia is asked for, and its least share of the mean: an arm that folds upon its
# axis falls to a few percent of it.
_POSITIONS, _SHARE = 256, 0.02


def link_inertias(
    robot: Robot, terms: tuple[Term, ...], motions: Sequence[Motion]
) -> np.ndarray | None:
    """Rows whose products with the rigid parameters must not be negative, (m, 10 n); None: no soft joint.

    Args:
        robot: Kinematics.
        terms: The model's.
        motions: The logs, for the travel of slides; turning joints are asked over the whole turn.
    """
    soft = sorted({t.joint for t in of_kind(terms, TransmissionLaw)})
    if not soft:
        return None
    reached = np.concatenate([m.q for m in motions])
    low, high = reached.min(axis=0), reached.max(axis=0)
    turning = np.array([kind == "revolute" for kind in robot.kinds])
    low, high = np.where(turning, -np.pi, low), np.where(turning, np.pi, high)
    q = np.random.default_rng(0).uniform(low, high, (_POSITIONS, robot.num_joints))
    weightless = robot.replace(gravity=jnp.zeros(3))
    rows = []
    for j in soft:
        moved = np.zeros_like(q)
        moved[:, j] = 1.0
        inertia = np.asarray(rigid_columns(weightless, q, np.zeros_like(q), moved)[:, j])
        rows.append(inertia - _SHARE * inertia.mean(axis=0))
    return np.concatenate(rows)
