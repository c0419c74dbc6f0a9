"""A mark on values that cannot be differentiated in reverse: the reader is told why, and what to do."""

from typing import Any

import jax
from jax.extend.core import Primitive
from jax.interpreters import ad, batching, mlir

from jaxswarm.errors import InputError

__all__ = ["forward_only"]


def forward_only(tree: Any) -> Any:
    """Return ``tree`` unchanged; ``jax.grad`` through it raises :class:`InputError`.

    Forward mode (``jax.jvp``, ``jax.jacfwd``) and ``vmap`` go through.
    """

    def mark(leaf):
        # Keys and integers have no derivatives.
        numeric = jax.numpy.issubdtype(leaf.dtype, jax.numpy.inexact)
        return _forward_only.bind(leaf) if numeric else leaf

    return jax.tree.map(mark, tree)


def _refuse(cotangent, value):
    raise InputError(
        "a search with stop= has no reverse mode (jax.grad): its number of steps is not known before "
        "it runs. Leave stop out, or use forward mode (jax.jacfwd, jax.jvp)."
    )


_forward_only = Primitive("forward_only")
_forward_only.def_impl(lambda value: value)
_forward_only.def_abstract_eval(lambda value: value)
ad.deflinear2(_forward_only, _refuse)
batching.primitive_batchers[_forward_only] = lambda args, axes: (
    _forward_only.bind(*args),
    axes[0],
)
mlir.register_lowering(_forward_only, lambda context, value: [value])
