"""A motion moved against its torque: by the clocks that a fit found, or those of another log."""

from dataclasses import replace

from jaxswarm.logs.motion import Motion
from jaxswarm.logs.resampling import earlier


def shift_motion(motion: Motion, seconds: float, weight: float = 0.0) -> Motion:
    """The motion as it was ``seconds`` earlier, against an unmoved torque; a fraction of a sample.

    Args:
        motion: The motion.
        seconds: By how much all of it is moved.
        weight: By how much more the weight in its torque lags.
    """
    q, dq, ddq = (earlier(motion.t, x, seconds) for x in (motion.q, motion.dq, motion.ddq))
    skew, weight = motion.skew + seconds, motion.weight_skew + weight
    return replace(motion, q=q, dq=dq, ddq=ddq, skew=skew, weight_skew=weight)


def with_skew_of(motion: Motion, like: Motion) -> Motion:
    """Another log by the clocks that were found on one."""
    return shift_motion(motion, like.skew - motion.skew, like.weight_skew - motion.weight_skew)
