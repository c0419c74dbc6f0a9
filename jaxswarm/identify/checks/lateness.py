"""By how much torques are late: what a model leaves of them against their derivatives, to first order."""

from dataclasses import dataclass

import numpy as np

from jaxswarm.decomposition import lstsq

# What is left of a joint, below which its logarithm says nothing more.
_NOTHING = 1e-12


@dataclass(frozen=True)
class Lateness:
    """By how much every joint's torque is late against its motion, all found at once, to first order.

    Attributes:
        seconds: Time [s], (n,).
        gain: Logarithm of what is left with it over what is left without, (n,).
    """

    seconds: np.ndarray
    gain: np.ndarray


def late_by(left: np.ndarray, *rates: np.ndarray) -> list[Lateness]:
    """The delays of all joints in several parts of a log, found at once.

    Args:
        left: What a model leaves of the torques, freed of its columns, joint after joint, (n R,).
        rates: For each part of the log the torques' derivatives in it, freed likewise, one column a joint,
            (n R, n).
    """
    joints = rates[0].shape[1]
    every = np.split(lstsq(np.hstack(rates), -left), len(rates))

    def size(x: np.ndarray) -> np.ndarray:
        return np.maximum(np.linalg.norm(x.reshape(joints, -1), axis=1), _NOTHING)

    pairs = zip(rates, every, strict=True)
    return [Lateness(s, np.log(size(left + rate @ s) / size(left))) for rate, s in pairs]
