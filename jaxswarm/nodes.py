"""Dataclasses as nodes of JAX's trees, told apart by their class.

JAX keeps a compiled program by the structure of what it was called with. With
``jax.tree_util.register_dataclass`` structures of two classes are equal in JAX 0.10 (0.9.2: they are not) if
their fields are: ``jax.jit(f)(A())`` after ``jax.jit(f)(B())`` is one time in a hundred, where the hashes of
both fall into one slot, the program of ``B``. A swarm of one rule of velocities was that of another.
"""

import dataclasses
from collections.abc import Callable, Iterable
from operator import attrgetter
from typing import Any, TypeVar

import jax
from jax.tree_util import GetAttrKey

T = TypeVar("T")

__all__ = ["node", "node_of"]


def node(cls: type[T]) -> type[T]:
    """Class decorator: make a dataclass a node, whose fields are leaves.

    Those with ``metadata={"static": True}`` are structure, compared and hashed with it. Copies are made by the
    class itself.

    >>> @node
    ... @dataclasses.dataclass
    ... class Left:
    ...     x: float
    >>> @node
    ... @dataclasses.dataclass
    ... class Right:
    ...     x: float
    >>> jax.tree.structure(Left(1.0)) == jax.tree.structure(Right(1.0))
    False
    """
    fields = [field for field in dataclasses.fields(cls) if field.init]  # type: ignore[arg-type]
    fixed = [field.name for field in fields if field.metadata.get("static", False)]
    return node_of(cls, [field.name for field in fields if field.name not in fixed], fixed)


def node_of(cls: type[T], leaves: Iterable[str], fixed: Iterable[str]) -> type[T]:
    """The same for a class that names its fields here, and is made anew of both kinds by name."""
    leaves, fixed = tuple(leaves), tuple(fixed)
    keys = tuple(GetAttrKey(name) for name in leaves)
    taken, structure = _all_of(leaves), _all_of(fixed)

    def flatten(x):
        return taken(x), structure(x)

    def flatten_with_keys(x):
        return tuple(zip(keys, taken(x), strict=True)), structure(x)

    def unflatten(of, values):
        return cls(**dict(zip(leaves, values, strict=True)), **dict(zip(fixed, of, strict=True)))

    jax.tree_util.register_pytree_with_keys(cls, flatten_with_keys, unflatten, flatten)
    return cls


def _all_of(names: tuple[str, ...]) -> Callable[[Any], tuple]:
    """A function that returns the named attributes, as quickly as can be."""
    if len(names) > 1:
        return attrgetter(*names)
    if not names:
        return lambda x: ()
    one = attrgetter(names[0])
    return lambda x: (one(x),)
