r"""The noise in the compared band: what no model can go below.

Two things make it. The torque's own sensor noise is told by its sample-to-sample differences. And the motion
is known only as well as its encoders tell: its noise goes through smoothing and derivatives into
:math:`M(q)\,\delta\ddot q`, and, where a joint hardly moves, through the steep sign of its friction. What comes
out of the model is found by drawing that noise once and sending it the same way.
"""

from dataclasses import replace

import numpy as np

from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import model_torque
from jaxswarm.logs.filtering import derivatives
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.smoothing import smooth

# Without any measured noise, this share of a joint's torque counts as it: what a sensor of 10 bits tells.
_LEAST_NOISE = 1e-3


def noise_of(found: Estimate) -> np.ndarray:
    """Standard deviation of the noise below the torque cutoff [N m or N], (n,): the least of the logs."""
    measured = np.min([m.torque_noise for m in found.motions], axis=0)
    size = np.sqrt((found.regression.torque**2).mean(axis=0))
    return np.maximum(np.maximum(measured, _LEAST_NOISE * size), 1e-12)


def with_motion_noise(found: Estimate, seed: int = 0) -> Estimate:
    """The same fit, the noise of its logs' torque raised by what that of the motion makes of the model."""
    motions = tuple(
        replace(m, torque_noise=np.hypot(m.torque_noise, _motion_noise(found, m, seed)))
        for m in found.motions
    )
    return replace(found, motions=motions)


def _motion_noise(found: Estimate, motion: Motion, seed: int) -> np.ndarray:
    """RMS torque (n,) that the noise of a log's positions makes of a model below the torque cutoff."""
    if motion.position_noise is None:
        return np.zeros(motion.q.shape[1])
    rng = np.random.default_rng(seed)
    noise = motion.position_noise * rng.normal(size=motion.q.shape)
    ratio, speed = motion.velocity_ratio, None
    if ratio is not None:
        speed = motion.position_noise / np.sqrt(ratio) * rng.normal(size=motion.q.shape)
    torques = []
    for share in (0.0, 1.0):
        given = None if speed is None else motion.dq + share * speed
        q = smooth(
            motion.q + share * noise, motion.rate, np.array(motion.motion_cutoff), given, ratio
        )
        dq, ddq = derivatives(q, motion.rate, 2)
        torques.append(model_torque(found.model, replace(motion, q=q, dq=dq, ddq=ddq)))
    return np.sqrt((motion.decimator.apply(torques[1] - torques[0]) ** 2).mean(axis=0))
