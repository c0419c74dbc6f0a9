"""The torque's noise in the compared band: what no model can go below."""

import numpy as np

from jaxswarm.identify.estimation.estimate import Estimate

# Without any measured noise, this share of a joint's torque counts as it: what a sensor of 10 bits tells.
_LEAST_NOISE = 1e-3


def noise_of(found: Estimate) -> np.ndarray:
    """Standard deviation of the torque's noise below the cutoff [N m or N], (n,): the least of the logs."""
    measured = np.min([m.torque_noise for m in found.motions], axis=0)
    size = np.sqrt((found.regression.torque**2).mean(axis=0))
    return np.maximum(np.maximum(measured, _LEAST_NOISE * size), 1e-12)
