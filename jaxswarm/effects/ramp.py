"""A smooth step in time, for what begins or ends in the middle of a log."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

# Time [s] that a step takes: below what the filtered torque shows, and some samples of any log.
_RAMP = 0.05


def ramp(t: Any, start: Any) -> Any:
    """Rise from exactly zero to exactly one around a time, with a derivative by that time.

    Arrays of NumPy give arrays of NumPy: each operation outside of a program would be one of its own.

    >>> [float(x) for x in ramp(jnp.array([0.9, 1.0, 1.1]), 1.0)]
    [0.0, 0.5, 1.0]
    """
    arrays: Any = jnp if any(isinstance(x, jax.Array) for x in (t, start)) else np
    u = arrays.clip((t - start) / _RAMP + 0.5, 0.0, 1.0)
    return u * u * (3.0 - 2.0 * u)
