"""A smooth step in time, for what begins or ends in the middle of a log."""

import jax
import jax.numpy as jnp

# Time [s] that a step takes: below what the filtered torque shows, and some samples of any log.
_RAMP = 0.05


def ramp(t: jax.Array, start: jax.Array) -> jax.Array:
    """Rise from exactly zero to exactly one around a time, with a derivative by that time.

    >>> [float(x) for x in ramp(jnp.array([0.9, 1.0, 1.1]), 1.0)]
    [0.0, 0.5, 1.0]
    """
    u = jnp.clip((t - start) / _RAMP + 0.5, 0.0, 1.0)
    return u * u * (3.0 - 2.0 * u)
