"""Many lanes in blocks: each block runs start to end in the processor's nearest cache.

XLA on a CPU compiles every elementwise pass over stored intermediates into a function of its own,
hands each call to a scheduler, and over thousands of lanes each pass goes through memory; the
arithmetic in between is short, so memory and scheduling bound the speed. A block of a few dozen lanes
keeps its intermediates in the first-level cache, and a loop over blocks that is compiled into one
function is scheduled once. ``benchmarks/dynamics.py`` shows what that gains.

Only programs of plain arithmetic, slices and loops can be compiled so. Everything else, derivatives,
and machines with other or several devices get the function on all lanes at once, with the same results.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax.experimental.xla_metadata import set_xla_metadata

BLOCK = 64

# Primitives a single compiled function may hold, calls and loops of them included.
_PLAIN = frozenset(
    """abs add and atan2 broadcast_in_dim ceil clamp closed_call concatenate cond convert_element_type
    copy cos cosh custom_jvp_call div dynamic_slice dynamic_update_slice eq exp expm1 floor ge gt
    integer_pow iota is_finite jit le log log1p logistic lt max min mul ne neg not or pjit pow
    reduce_max reduce_min reduce_sum rem reshape rev round scan select_n sign sin sinh slice split
    sqrt square squeeze stack stop_gradient sub tan tanh transpose while xor""".split()
)


def in_blocks(function: Callable[..., Any], lanes: Any, *shared: Any, size: int = BLOCK) -> Any:
    """Return ``function(lanes, *shared)``, block by block on one core of a CPU.

    Args:
        function: Elementwise in the lanes.
        lanes: Pytree of arrays (..., L), the lanes last, L >= 1.
        *shared: Further arguments, pytrees of arrays, the same for every block.
        size: Lanes of a block, >= 1.

    Returns:
        What the function returns: arrays with the L lanes last.

    >>> in_blocks(lambda x, y: 2.0 * x + y, jnp.arange(3.0), 1.0, size=2).tolist()
    [1.0, 3.0, 5.0]
    """
    lanes, shared = jax.tree.map(jnp.asarray, (lanes, shared))
    plain, plain_known = jax.closure_convert(function, lanes, *shared)
    if not _one_cpu() or not _is_plain(jax.make_jaxpr(plain)(lanes, *shared, *plain_known)):
        return function(lanes, *shared)
    blocked, blocked_known = jax.closure_convert(_blocked(function, size), lanes, *shared)

    @jax.custom_jvp
    def run(arguments, plain_known, blocked_known):
        with set_xla_metadata(inlineable="false", xla_cpu_small_call="true"):
            return jax.jit(blocked)(*arguments, *blocked_known)

    @run.defjvp
    def derive(primals, tangents):
        return jax.jvp(
            lambda arguments, known: plain(*arguments, *known), primals[:2], tangents[:2]
        )

    return run((lanes, *shared), plain_known, blocked_known)


def _blocked(function: Callable[..., Any], size: int) -> Callable[..., Any]:
    """Return the function as a loop over blocks of lanes."""

    def run(lanes, *shared):
        some = jax.tree.leaves(lanes)[0]
        count = some.shape[-1]
        width = min(size, count)

        def block(start):
            return jax.tree.map(
                lambda x: jax.lax.dynamic_slice_in_dim(x, start, width, x.ndim - 1), lanes
            )

        def body(i, results):
            # The last block starts early enough to be whole: some lanes are computed twice.
            start = jnp.minimum(i * width, count - width)
            return jax.tree.map(
                lambda all, new: jax.lax.dynamic_update_slice_in_dim(all, new, start, new.ndim - 1),
                results,
                function(block(start), *shared),
            )

        # Every lane is overwritten. The number comes from the lanes: sharded, it is where they are.
        number = some.ravel()[0]
        results = jax.tree.map(
            lambda s: jnp.broadcast_to(number.astype(s.dtype), (*s.shape[:-1], count)),
            jax.eval_shape(lambda *a: function(block(0), *a), *shared),
        )
        return jax.lax.fori_loop(0, -(-count // width), body, results)

    return run


def _one_cpu() -> bool:
    """Tell whether this is a single CPU: among several devices XLA may put exchanges in a block."""
    return jax.default_backend() == "cpu" and jax.device_count() == 1


def _is_plain(program: Any) -> bool:
    """Tell whether a traced program holds plain arithmetic, slices and loops only."""
    for equation in program.eqns:
        if equation.primitive.name not in _PLAIN:
            return False
        parts = jax.tree.leaves(
            list(equation.params.values()), is_leaf=lambda x: hasattr(x, "eqns")
        )
        if not all(_is_plain(part) for part in parts if hasattr(part, "eqns")):
            return False
    return True
