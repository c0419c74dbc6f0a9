"""Lengths of logs rounded up, so that a log of another length needs no program of its own.

What is compiled for one number of samples serves no other. Where every sample depends on those before it
alone, the last one may be held for a while and what comes of it cut off again: the numbers stay the same.
"""

from typing import Any

import jax
import numpy as np

# Lengths are rounded up to multiples of this: the work on held samples is small beside a compilation.
CHUNK = 1024


def filled(series: Any, axis: int = 0) -> Any:
    """Arrays whose last sample is repeated up to a multiple of :data:`CHUNK` samples.

    Args:
        series: An array, or any nesting of arrays of equal length.
        axis: That of time.

    >>> filled(np.arange(3.0)).shape, filled(np.zeros((2, 1025)), axis=1).shape
    ((1024,), (2, 2048))
    """
    done: dict[int, np.ndarray] = {}

    def fill(given: Any) -> np.ndarray:
        found = done.get(id(given))  # of what laws see half is the same zeros
        if found is None:
            x = np.asarray(given)
            last = x[(slice(None),) * (axis % x.ndim) + (slice(-1, None),)]
            found = np.concatenate([x, np.repeat(last, -x.shape[axis] % CHUNK, axis)], axis)
            done[id(given)] = found
        return found

    return jax.tree.map(fill, series)
