r"""What weight that is told in steps makes of other torques, where samples keep time with the steps.

A slower computer tells the weight, and drives hold it: between two steps the torque is off by
:math:`\dot w\,(t - T/2)`, which shakes all joints, and shakes them anew with each step. When a step comes
speeds are off by up to :math:`\ddot q_k T / 12`, :math:`\ddot q = M^{-1} \dot w T`, and the speed loop of each
joint answers to that. Samples in time with the steps read the answer at its largest, always of one sign.
"""

import jax.numpy as jnp
import numpy as np
import scipy

from jaxswarm.identify.estimation.time_slopes import low_weight
from jaxswarm.identify.forward.columns import torque_of
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Motion

# Of the steps' time, what a speed loop makes of it that is as fast as they come: the peak of a parabola of mean
# zero between two of them. Loops of 3 to 7 Hz at steps of 20 ms make 0.5 to 1.2 of it.
_ANSWER = 1.0 / 12.0
# Decimated rows over which the power is averaged, as that of other doubts of the motion is.
_ROWS = 7


def stair_noise(model: Model, motion: Motion) -> np.ndarray:
    r"""Standard deviation (T', n) of what speed loops answer to steps of the weight of other joints.

    Joint j answers to those of joint k by :math:`M_{jj} (M^{-1})_{jk}`, which a fit does not tell: small
    inertias are known badly beside large ones. It is of the size of :math:`\sqrt{M_{jj} / M_{kk}}`.

    Args:
        model: With its rigid parameters.
        motion: A log whose weight has a clock of its own; all others have none of it.
    """
    kept = motion.decimator.kept(len(motion.t))
    if not motion.weight_skew or len(kept) < 3:
        return np.zeros((len(kept), motion.q.shape[1]))
    robot, pi = model.robot, np.asarray(model.robot.parameters).ravel()
    rest = np.zeros_like(motion.q)
    t = motion.t[kept]
    change = scipy.interpolate.CubicSpline(t, low_weight(model, motion))(t, 1)
    weightless, own = robot.replace(gravity=jnp.zeros(3)), np.eye(motion.q.shape[1])
    inertia = np.array(
        [
            torque_of(weightless, motion.q, rest, rest + one, pi)[:, j].mean()
            for j, one in enumerate(own)
        ]
    )
    inertia = np.maximum(inertia, np.finfo(float).tiny)
    power = change**2 @ (np.divide.outer(1.0 / inertia, 1.0 / inertia) * (1.0 - own))
    power = np.maximum(scipy.ndimage.uniform_filter1d(power, _ROWS, axis=0), 0.0)
    return _ANSWER * motion.interval * np.sqrt(power)
