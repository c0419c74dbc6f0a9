"""Many runs one batch after the other, so that what a batch carries stays in the cache of a processor.

Runs know nothing of each other. All in one program walk through the whole population several times a
step, and beyond the cache each walk waits for memory: swarms of 1000 x 30 in 100 runs took twice the
core-seconds. A batch makes all its steps before the next one begins. Accelerators have the bandwidth, and
want as many lanes as there are.
"""

from functools import partial
from typing import Any

import jax

from jaxswarm.swarm.needed import state_bytes
from jaxswarm.swarm.search import search

__all__ = ["batch_of", "search_in_batches"]

CACHED = 4 * 2**20
"""Bytes of state in a batch: with what a step computes between about twice that, a share of a cache of
16 MiB or more, and still enough for several cores."""
FEWEST = 4
"""Batches that would hold less than a quarter of ``CACHED`` cost more in calls than they save."""


def batch_of(optimizer: Any, num_dims: int, dtype: Any, runs: int) -> int:
    """Runs of a batch, a divisor of ``runs``; ``runs`` itself where a batch would not help."""
    most = CACHED // max(state_bytes(optimizer, num_dims, dtype), 1)
    if jax.default_backend() != "cpu" or most >= runs or most < 1:
        return runs
    batch = max(divisor for divisor in range(1, most + 1) if runs % divisor == 0)
    return batch if batch * FEWEST >= most else runs


@partial(jax.jit, static_argnames="batch")
def search_in_batches(loop, optimizer, space, keys, args, start, *, batch: int) -> Any:
    """The ``Result`` of all runs, ``batch`` of them at a time; without a stop rule, from the beginning."""
    split = keys.reshape(-1, batch, *keys.shape[1:])
    one = lambda some: search(loop, optimizer, space, some, args, None, start, None)[0]  # noqa: E731
    found = jax.lax.map(one, split)
    return jax.tree.map(lambda leaf: leaf.reshape(-1, *leaf.shape[2:]), found)
