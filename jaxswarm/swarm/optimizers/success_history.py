"""What SHADE learns: pairs of F and CR that succeeded, and draws around them; references in ``shade``."""

import math
from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.swarm.random import Random

SPREAD = 0.1  # scale of the distributions around a remembered pair


def remember(state: Any, gain: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Put the weighted means of what succeeded into the oldest slot of the memory.

    Args:
      state: what holds trial_weight and trial_rate (n,), memory_weight and memory_rate (h,), slot.
      gain: (n,) improvement by each trial, 0 where there was none.

    Returns:
      memory_weight (h,), memory_rate (h,) and the slot to be replaced next.
    """
    total = jnp.sum(gain)
    share = gain / jnp.where(total > 0.0, total, 1.0)
    share = jnp.where(jnp.isfinite(share), share, 0.0)
    weight, rate = state.trial_weight, state.trial_rate
    mean_weight = jnp.sum(share * weight**2) / jnp.maximum(jnp.sum(share * weight), 1e-12)
    mean_rate = jnp.sum(share * rate)
    success = (total > 0.0) & (jnp.sum(share) > 0.5)
    here = (jnp.arange(state.memory_weight.shape[0]) == state.slot) & success
    slot = (state.slot + success) % state.memory_weight.shape[0]
    return (
        jnp.where(here, mean_weight, state.memory_weight),
        jnp.where(here, mean_rate, state.memory_rate),
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
