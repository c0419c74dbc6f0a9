"""What SHADE learns: pairs of F and CR that succeeded, and draws around them; references in ``shade``."""

import math
from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.swarm.random import Random

SPREAD = 0.1  # scale of the distributions around a remembered pair


def successes(weight: jax.Array, rate: jax.Array, gain: jax.Array) -> jax.Array:
    """Sums over trials (4,) that the means of what succeeded follow from; sums of parts add up.

    Args:
      weight, rate: (n,) F and CR of the trials.
      gain: (n,) improvement by each trial, 0 where there was none.
    """
    return jnp.stack(
        [gain.sum(), jnp.sum(gain * weight), jnp.sum(gain * weight**2), jnp.sum(gain * rate)]
    )


def remember(state: Any, sums: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Put the means of what succeeded, weighted by the gain, into the oldest slot of the memory.

    Args:
      state: what holds memory_weight and memory_rate (h,) and slot.
      sums: (4,) of :func:`successes`.

    Returns:
      memory_weight (h,), memory_rate (h,) and the slot to be replaced next.
    """
    success = jnp.all(jnp.isfinite(sums)) & (sums[0] > 0.0) & (sums[1] > 0.0)
    total, first, second, rate = jnp.where(success, sums, 1.0)
    here = (jnp.arange(state.memory_weight.shape[0], dtype=jnp.int32) == state.slot) & success
    slot = (state.slot + success.astype(jnp.int32)) % state.memory_weight.shape[0]
    return (
        jnp.where(here, second / first, state.memory_weight),
        jnp.where(here, rate / total, state.memory_rate),
        slot.astype(jnp.int32),
    )


def draw_pair(
    random: Random, memory_weight: jax.Array, memory_rate: jax.Array, n: int, dtype: Any
) -> tuple[jax.Array, jax.Array]:
    """Draw F (Cauchy, positive, at most 1) and CR (normal, in [0, 1]) for n trials."""
    slot = random.integers("slot", (n,), memory_weight.shape[0])
    center = memory_weight[slot]
    # Inversion of the Cauchy distribution restricted to F > 0 replaces redrawing.
    below = 0.5 - jnp.arctan(center / SPREAD) / math.pi
    u = below + (1.0 - below) * random.uniform("weight", (n,), dtype)
    weight = jnp.clip(center + SPREAD * jnp.tan(math.pi * (u - 0.5)), 1e-6, 1.0)
    rate = memory_rate[slot] + SPREAD * random.normal("rate", (n,), dtype)
    return weight, jnp.clip(rate, 0.0, 1.0)
