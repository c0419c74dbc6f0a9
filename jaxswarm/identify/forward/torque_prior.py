r"""What is known of a model before it is fitted: on other motion its torque is no multiple of what was seen.

Where joints move one by one and never reverse, two directions of the rigid parameters differ by less than the
noise: a log of six such joints was fitted with an inertia of 9562 kg m^2, whose parts cancel along the log and
leave 4000 N m on any other motion. The torque of a model on motion that a log does not hold, joints anywhere
and moving together as fast as they do there, is taken to be normally distributed about zero, with the largest
torque seen for a standard deviation. That is a g-prior (A. Zellner, in: Bayesian Inference and Decision
Techniques, 1986) with the other motion as its design: its rows stand below those of the log,

.. math:: \begin{bmatrix} W/\sigma \\ W_o/(c\,\tau_{max}\sqrt{N_o}) \end{bmatrix} \theta \approx
   \begin{bmatrix} \tau/\sigma \\ 0 \end{bmatrix},

with c near one, and move nothing that the log tells to a few percent.

What no joint of a level arm feels, such as the height of its masses, acts on the base alone. Where that may
give way it shows, times a softness and a tilt that are as little known: a tilt of 0.02 rad beside a soft base
was told as 0.14 rad and a mass of -830 kg m above the first joint that undoes most of it. The weight of the
arm on a base that stands any way is taken likewise, with ten times that standard deviation.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.effects.hinged_base import TURNS, hinged
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.model import Robot

# Largest torques of a log that one standard deviation on other motion comes to. With 1, 3 and 10 the error on
# the other motion of the log above is 29, 41 and 231 times its noise instead of 10,400; those of four logs
# whose joints move together stay as they are in all digits shown. Torques of other motion are less than half
# the largest one seen, RMS. A row of a log is not independent of the one before, and counts as if it were:
# beside what a log really tells this is weaker by the root of the residual's correlation length.
_TIMES = 1.0
# The same of the moment on the base, which holds more than a joint: masses of the first link, too.
_TIMES_BASE = 10.0
# Least lever [m] of a force on the base: slides alone have no length.
_LEVER = 1.0
# Samples of other motion, and the share of a log's that are slower than what counts as its fastest. The
# accelerations of the fastest are two standard deviations: noise alone is far below.
_MOTIONS, _FAST = 256, 0.99


def torque_prior(robot: Robot, motions: Sequence[Motion]) -> np.ndarray:
    """Rows whose products with the rigid parameters should be about zero, to one each, (r, 10 n).

    Args:
        robot: Kinematics.
        motions: The logs: how far slides went, how fast all joints were, and their torques.
    """
    n = robot.num_joints
    q = np.concatenate([m.q for m in motions])
    turning = np.array([kind == "revolute" for kind in robot.kinds])
    low, high = np.where(turning, -np.pi, q.min(axis=0)), np.where(turning, np.pi, q.max(axis=0))
    torque = np.max([np.abs(m.low_torque).max(axis=0) for m in motions], axis=0)
    rng = np.random.default_rng(0)
    anywhere = rng.uniform(low, high, (_MOTIONS, n))
    speed, acceleration = (
        rng.standard_normal((_MOTIONS, n)) * _fast([getattr(m, name) for m in motions], motions) / 2
        for name in ("dq", "ddq")
    )
    # The moment [N m] of the largest torque, or of the largest force on the arm's length.
    moment = np.max(torque * np.where(turning, 1.0, max(robot.length, _LEVER)))
    usual = np.append(_TIMES * torque, np.full(TURNS, _TIMES_BASE * moment))
    acted = rigid_columns(robot, anywhere, speed, acceleration), _on_the_base(robot, anywhere, rng)
    rows = np.concatenate(acted, axis=1)[:, usual > 0.0]
    rows /= (np.sqrt(_MOTIONS) * usual[usual > 0.0])[:, None]
    return np.asarray(np.linalg.qr(rows.reshape(-1, 10 * n), mode="r"))


def _on_the_base(robot: Robot, q: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Moments about base x and y by the weight of an arm in poses (T, n), turned any way, (T, 2, 10 n)."""
    askew = np.concatenate([rng.uniform(-np.pi, np.pi, (len(q), TURNS)), q], axis=1)
    still = np.zeros_like(askew)
    return rigid_columns(hinged(robot), askew, still, still, first=TURNS)[:, :TURNS]


def _fast(values: Sequence[np.ndarray], motions: Sequence[Motion]) -> np.ndarray:
    """How large values of all logs (T, n) are where they are largest, below the cutoff of the torque, (n,)."""
    low = [m.decimator.apply(x) for m, x in zip(motions, values, strict=True)]
    return np.asarray(np.quantile(np.abs(np.concatenate(low)), _FAST, axis=0))
