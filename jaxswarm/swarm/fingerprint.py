"""What an object is, as a text that another process writes the same way.

``repr`` will not do: that of a function holds its address, that of a set follows the hash seed. Here
a text follows from structure and numbers alone: parts of a dataclass or a container by name, numbers
in full, arrays by their values, a function by its name and by what it closes over, and a schedule,
which is a function of a count, by its values at fixed counts.
"""

import dataclasses
import functools
import hashlib
from collections.abc import Callable, Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

__all__ = ["fingerprint"]

COUNTS = (0, 1, 2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 233, 377, 610, 987, 2584, 6765, 17711, 121393)
"""Counts at which a schedule is sampled: as dense as schedules are short, up to 1e5 updates."""
DIGITS = 9
"""Of a sampled value: more than a change by hand needs, fewer than two machines may differ in."""
WRITTEN_OUT = 32
"""Elements up to which an array is written out; a longer one stands by its digest."""


def fingerprint(thing: Any) -> str:
    """Describe a tree of parts, such as an optimizer, independently of the process.

    >>> from jaxswarm.swarm.schedules import linear
    >>> fingerprint({"inertia": linear(0.9, 0.4, 100)})
    "{'inertia': Linear(start=0.9, end=0.4, num_steps=100.0, of_run=False)}"
    """
    return _describe(thing, ())


def _describe(thing: Any, above: tuple[int, ...]) -> str:
    """``above`` holds the ids of the functions and objects being described: they may hold each other."""
    if thing is None or isinstance(thing, bool | int | float | complex | str | bytes):
        return repr(thing)
    if isinstance(thing, jax.Array | np.ndarray | np.generic):
        return _array(thing)
    if id(thing) in above:
        return "..."
    part = functools.partial(_describe, above=(*above, id(thing)))
    if isinstance(thing, type):
        return _name(thing)
    if dataclasses.is_dataclass(thing):
        fields = [field.name for field in dataclasses.fields(thing)]
        return _call(type(thing), [], {name: getattr(thing, name) for name in fields}, part)
    if isinstance(thing, tuple) and hasattr(thing, "_fields"):
        return _call(type(thing), [], dict(zip(thing._fields, thing, strict=True)), part)
    if isinstance(thing, tuple | list):
        return _call(type(thing), thing, {}, part)
    if isinstance(thing, set | frozenset):
        return _name(type(thing)) + "(" + ", ".join(sorted(map(part, thing))) + ")"
    if isinstance(thing, Mapping):
        pairs = sorted((part(key), part(value)) for key, value in thing.items())
        return "{" + ", ".join(f"{key}: {value}" for key, value in pairs) + "}"
    if callable(thing):
        return _function(thing, part)
    return _call(type(thing), [], getattr(thing, "__dict__", {}), part)


def _function(function: Callable, part: Callable[[Any], str]) -> str:
    samples = _samples(function)
    if isinstance(function, functools.partial):  # jax.tree_util.Partial too
        text = _call(type(function), [function.func, *function.args], function.keywords, part)
        return text if samples is None else f"{text} at counts: {samples}"
    if samples is not None:
        return f"{_name(function)} at counts: {samples}"
    if hasattr(function, "__self__"):  # a method: its object tells the rest
        return f"{part(function.__self__)}.{_name(function)}"
    code = getattr(function, "__code__", None)
    if code is None:
        return _call(type(function), [], getattr(function, "__dict__", {}), part)
    cells = zip(code.co_freevars, function.__closure__ or (), strict=True)
    inside = {name: cell.cell_contents for name, cell in cells}
    numbers = [value for value in code.co_consts if isinstance(value, int | float)]
    defaults = [*(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).items()]
    return _call(function, [numbers, defaults], inside, part)


def _samples(function: Callable) -> str | None:
    """Values of a schedule at fixed counts; None for a function of something else."""
    with jax.enable_x64(True):
        try:
            out = jax.eval_shape(function, jax.ShapeDtypeStruct((), jnp.int32))
            if jnp.shape(out) != () or not jnp.issubdtype(out.dtype, jnp.number):
                return None
            values = jax.vmap(function)(jnp.asarray(COUNTS, jnp.int32))
        except Exception:  # whatever a function of something else does with a count
            return None
    return " ".join(f"{float(value):.{DIGITS}g}" for value in values)


def _array(array: Any) -> str:
    if jnp.issubdtype(array.dtype, jax.dtypes.prng_key):
        array = jax.random.key_data(array)
    array = np.asarray(array)
    if array.size <= WRITTEN_OUT:
        return f"{array.dtype}{array.shape}{array.tolist()}"
    digest = hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()[:32]
    return f"{array.dtype}{array.shape}sha256:{digest}"


def _call(thing: Any, args: Any, kwargs: Mapping[str, Any], part: Callable[[Any], str]) -> str:
    named = [f"{name}={part(value)}" for name, value in kwargs.items()]
    return f"{_name(thing)}({', '.join([*map(part, args), *named])})"


def _name(thing: Any) -> str:
    """Qualified name; our own parts without their module, which may be moved."""
    kind = thing if hasattr(thing, "__qualname__") else type(thing)
    module = getattr(kind, "__module__", "") or ""
    plain = module.partition(".")[0] in ("jaxswarm", "builtins")
    return kind.__qualname__ if plain else f"{module}.{kind.__qualname__}"
