"""Frozen dataclasses that JAX can trace: numbers are leaves, structure is static.

A field is a leaf unless it is declared with :func:`static`. Leaves may be traced, mapped and
differentiated, and changing one never compiles anew; a static field is part of the program.
"""

import dataclasses
from collections.abc import Callable
from typing import Any, TypeVar, cast, dataclass_transform

import jax

from jaxswarm.nodes import node

T = TypeVar("T")


def static(**options: Any) -> Any:
    """Declare a dataclass field as structure: hashable, compared, compiled into the program."""
    return dataclasses.field(metadata={"static": True}, **options)


@dataclass_transform(frozen_default=True, field_specifiers=(static, dataclasses.field))
def pytree(cls: type[T]) -> type[T]:
    """Class decorator: make ``cls`` a frozen dataclass and register it with JAX.

    >>> @pytree
    ... class Line:
    ...     slope: float
    ...     name: str = static(default="line")
    >>> jax.tree.leaves(Line(2.0))
    [2.0]
    """
    return node(dataclasses.dataclass(frozen=True)(cls))


def facts(**named: Any) -> Callable[[type[T]], type[T]]:
    """Class decorator: constants of a class whose body may hold fields alone, a NamedTuple.

    >>> from typing import NamedTuple
    >>> @facts(MEMORY=("seen",))
    ... class Kept(NamedTuple):
    ...     seen: float
    >>> Kept.MEMORY, Kept(1.0)
    (('seen',), Kept(seen=1.0))
    """

    def give(cls: type[T]) -> type[T]:
        for name, value in named.items():
            setattr(cls, name, value)
        return cls

    return give


def replace(state: T, **changes: Any) -> T:
    """Return ``state`` (a NamedTuple or a frozen dataclass) with some fields changed."""
    if hasattr(state, "_replace"):
        return state._replace(**changes)
    return dataclasses.replace(cast(Any, state), **changes)


def on_device(tree: T) -> T:
    """Put the numbers of Python and NumPy in a tree on the device, if a transfer guard is on.

    A program is given coefficients, bounds and thresholds as they are, which transfers them unasked; a guard
    (``jax.transfer_guard("disallow")``) lets only what is put there by name pass. Without a guard the program
    does the same in a tenth of the time. Data of the user are left to the guard.

    >>> with jax.transfer_guard("disallow"):
    ...     held = on_device((0.5, 2))
    >>> [leaf.tolist() for leaf in held]
    [0.5, 2]
    """
    if cast(Any, jax.config).jax_transfer_guard_host_to_device in (None, "allow"):
        return tree
    return jax.tree.map(
        lambda leaf: leaf if isinstance(leaf, jax.Array) else jax.device_put(leaf), tree
    )


def as_part(part: Any) -> Any:
    """Make a callable part (topology, boundary, rule, schedule) a pytree.

    Callables that are pytrees already keep their leaves; a plain function becomes a
    ``jax.tree_util.Partial``, whose function is static.
    """
    if jax.tree_util.all_leaves([part]) and callable(part):
        return jax.tree_util.Partial(part)
    return part
