"""A compiled program whose operations run one after the other on a CPU, where that can be asked for.

XLA orders operations that do not wait for each other so that other threads may take them. Those of a step of
one small population are too short for that: in float64 an update of CMA-ES on 50 x 13 computed for 39 us so and
for 28 in turn (on one core 27). Swarms of 50 x 13 in a hundred runs took a fifth longer in turn.
"""

import functools
from typing import Any

import jax
import jax.numpy as jnp

__all__ = ["InTurn"]

OPTIONS: dict[str, Any] = {"xla_cpu_scheduler_type": "CPU_SCHEDULER_TYPE_MEMORY_OPTIMIZED"}


class InTurn:
    """A function of :func:`jax.jit`; called by itself on a CPU, as a program of its own kind.

    Within another program it is a part of that one, whose options JAX takes from outside alone.

    >>> InTurn(jax.jit(lambda x: 2.0 * x))(jnp.ones(2)).tolist()
    [2.0, 2.0]
    """

    def __init__(self, compiled: Any):
        functools.update_wrapper(self, compiled)
        self._within = compiled
        self._alone: Any = jax.jit(compiled.__wrapped__, compiler_options=OPTIONS)

    def __call__(self, *args: Any) -> Any:
        """What the function gives."""
        given = jax.tree.leaves(args)
        # Within a program that gives it nothing of its own, what is made new is traced all the same; this is
        # made on the device, which transfers nothing.
        traced = any(isinstance(x, jax.core.Tracer) for x in (*given, jax.lax.iota(jnp.int32, 1)))
        return (self._within if traced or not _known() else self._alone)(*args)

    @property
    def made(self) -> int:
        """Programs that this process has made of it."""
        return self._within._cache_size() + self._alone._cache_size()


@functools.cache
def _known() -> bool:
    """Whether what compiles here knows the options, which are those of one compiler and not of JAX."""
    if jax.default_backend() != "cpu":
        return False
    try:
        jax.jit(lambda: 0, compiler_options=OPTIONS).lower().compile()
    except jax.errors.JaxRuntimeError:
        return False
    return True
