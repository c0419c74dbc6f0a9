"""Clocks of single joints: what a residual may hold of when, in a sample, each drive's torque was read."""

from dataclasses import replace

import numpy as np

from jaxswarm.identify.estimation.estimate import CLOCKS_APART, Estimate
from jaxswarm.identify.estimation.time_slopes import change_by_time
from jaxswarm.identify.forward.model import model_torque


def clock_slopes(found: Estimate) -> np.ndarray:
    """What it does to the torque that each joint's is read for itself apart from the others, (T, n, 2 n).

    A drive filters its torque for itself, and holds it for as long as its slowest loop takes: all of it, or
    the weight that a slower computer tells it. Sampled where that loop begins, it is half of its turn early:
    on a clean log of another simulator, with the weight held for the 10 ms between two samples, by 3 to 4 times
    the noise on five joints of seven, of which one clock of all takes a part. The columns are the changes by
    time of the whole torque of each joint and of its weight, in units of the standard deviation of clocks that
    nobody delayed.
    """
    regression, joints = found.regression, found.regression.torque.shape[1]
    weight = np.zeros_like(regression.torque)
    for number, motion in enumerate(found.motions):
        still = replace(motion, dq=0.0 * motion.dq, ddq=0.0 * motion.ddq)
        rows = regression.log == number
        weight[rows] = motion.decimator.apply(model_torque(found.model, still))
    whole = regression.torque - found.fit.residual
    apart = CLOCKS_APART * np.array([m.interval for m in found.motions])[regression.log]
    slopes = [
        (apart[:, None] * change_by_time(torque, regression))[:, :, None] * np.eye(joints)
        for torque in (whole, weight)
    ]
    return np.concatenate(slopes, axis=2)
