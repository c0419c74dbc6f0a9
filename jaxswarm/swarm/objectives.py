"""What searches for a front share: the objectives of a step, checked, and the best mean of them."""

from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError

__all__ = ["lowest_mean", "objectives_of"]


def objectives_of(state: Any, value: jax.Array, width: int) -> jax.Array:
    """Values (n, width) of the candidates of ``state``; +inf in all where one is no finite number."""
    expected = (state.position.shape[0], width)
    if jnp.shape(value) != expected:
        raise InputError(
            f"value has shape {jnp.shape(value)}, expected {expected}: all objectives."
        )
    value = jnp.asarray(value, state.position.dtype)
    # Without one of its values a candidate has no place on a front.
    return jnp.where(jnp.isfinite(value).all(axis=1, keepdims=True), value, jnp.inf)


def lowest_mean(state: Any, value: jax.Array) -> tuple[tuple[jax.Array, jax.Array], jax.Array]:
    """Best position (d,) and mean of objectives () so far, and whether this step improved them."""
    mean = value.mean(axis=1)
    lead = jnp.argmin(mean)
    improved = mean[lead] < state.best_value
    best_position = jnp.where(improved, state.position[lead], state.best_position)
    return (best_position, jnp.minimum(mean[lead], state.best_value)), improved
