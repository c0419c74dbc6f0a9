"""What dry friction remembers: bristles that bend before they slip.

A torque that follows a reversal over a short way, as in harmonic drives, looks late by up to 60 ms.
"""

import numpy as np

# Ways over which they bend, as parts of a joint's travel.
_WAYS = (0.01, 0.05)


def bristles(q: np.ndarray) -> np.ndarray:
    """What they carry, as a part of the friction: it follows the joint to 1 or -1, until that turns back.

    Args:
        q: Positions [rad or m] in the order of time, (T, n).

    Returns:
        (T, n, 2): for a short and for a longer way.

    >>> bristles(np.array([[0.0], [1.0], [0.5]]))[:, 0, 0].tolist()
    [0.0, 1.0, -1.0]
    """
    ways = np.maximum(np.ptp(q, axis=0)[:, None] * np.array(_WAYS), 1e-12)
    states = np.zeros((*q.shape, len(_WAYS)))
    steps = np.diff(q, axis=0)[:, :, None] / ways
    # Written where they stay, a step after the other: a log is asked for them some dozen times.
    for before, step, state in zip(states, steps, states[1:], strict=False):
        np.add(before, step, out=state)
        np.minimum(state, 1.0, out=state)
        np.maximum(state, -1.0, out=state)
    return states
