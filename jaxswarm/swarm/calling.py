"""How a search calls what it is given: with what, and what has to come back; else it is told what to change.

Objectives, and the functions that a search or an optimizer is built of: stop rules, records, velocity rules.
"""

import inspect
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.swarm.pytree import as_part

__all__ = ["called", "check_args", "check_not_varying", "check_shape", "check_takes", "part_of"]

# NumPy, ``if`` and ``x[x > 0]`` ask for numbers where a program is made; whoever writes these has a remedy.
UNTRACED = (
    jax.errors.ConcretizationTypeError,
    jax.errors.NonConcreteBooleanIndexError,
    jax.errors.TracerArrayConversionError,
    jax.errors.TracerIntegerConversionError,
)


def check_takes(fn: Any, *names: str, what: str = "fn") -> None:
    """Refuse what cannot be called with arguments of these names, before anything is traced."""
    if not callable(fn):
        raise InputError(f"{what}={fn!r} must be a function of ({', '.join(names)}).")
    try:
        signature = inspect.signature(fn)
    except (TypeError, ValueError):
        return  # compiled ones need not tell
    try:
        signature.bind(*names)
    except TypeError as error:
        named = getattr(fn, "__name__", "<>")
        remedy = f"Write lambda {', '.join(names)}: ... around it."
        if named.isidentifier() and what != "fn" and _takes_nothing(signature):
            remedy = f"Is it a factory? Call it, {named}()."
        raise InputError(
            f"{what} takes {signature}, it is called as {what}({', '.join(names)}): {error}. {remedy}"
        ) from None


def _takes_nothing(signature):
    try:
        signature.bind()
    except TypeError:
        return False
    return True


def part_of(name: str, part: Any, *takes: str) -> Any:
    """A function that an optimizer is built of, as a pytree; refused where it cannot be called so."""
    check_takes(part, *takes, what=name)
    return as_part(part)


def check_shape(name: str, given: Any, shape: tuple[int, ...]) -> Any:
    """Return what a part gave, refused if it has another shape than (n, d)."""
    if given is None or jnp.shape(given) != shape:
        told = "None" if given is None else f"shape {jnp.shape(given)}"
        raise InputError(f"{name} returned {told}, expected {shape}: a row for each particle.")
    return given


def check_not_varying(given: Any) -> None:
    """Refuse inputs of which ``jax.shard_map`` checks along which axes of a mesh they vary.

    A search begins with constants, which do not vary, and goes on with what does: no loop may do that.
    """
    if any(_varies(jax.typeof(leaf)) for leaf in jax.tree.leaves(given)):
        raise InputError(
            "the search is within jax.shard_map, which checks how its parts vary over the devices: give it "
            "check_vma=False, or let minimize_sharded(...) spread the runs."
        )


def _varies(kind):
    """Axes along which a type varies; the attribute has had two names."""
    of_axes = getattr(kind, "manual_axis_type", None)
    return getattr(kind, "vma", None) if of_axes is None else of_axes.varying


def check_args(args: Any) -> Any:
    """Return data, refused where a program cannot be given them: text, tables, objects."""
    for path, leaf in jax.tree_util.tree_flatten_with_path(args)[0]:
        array = isinstance(leaf, jax.Array) or hasattr(leaf, "__jax_array__")
        kind = None if array else np.asarray(leaf).dtype.kind
        if kind is not None and kind not in "biufcV":
            raise InputError(
                f"args{jax.tree_util.keystr(path)} is a {type(leaf).__name__}, no number and no array of "
                "numbers: give what is no data by functools.partial(fn, ...)."
            )
    return args


def called(fn: Callable[..., Any], given: tuple, lead: tuple, width: int | None, vectorized: bool):
    """What an objective returns as an array, checked: (*lead,), or (*lead, width)."""
    try:
        out = fn(*given)
    except UNTRACED as error:
        told = str(error).partition("\n")[0]
        raise InputError(
            f"fn cannot be compiled: {told} Write it in jax.numpy, with jnp.where in the place of if, or "
            "search with Driver, whose objectives run on the host."
        ) from error
    return _values(out, lead, width, vectorized)


def _real(out):
    """What an objective returned as an array of real numbers; refused if it is none."""
    try:
        array = jnp.asarray(out)
    except (TypeError, ValueError) as error:
        if not isinstance(out, tuple | list | dict):
            remedy = f"{out!r}, which is no number: is a return missing?"
        else:
            remedy = (
                f"a {type(out).__name__} of {len(out)}, which is no number: return the value alone; "
                "(value, constraints) go to constrained(...), several objectives to nsga2(...)."
            )
        raise InputError(f"fn returned {remedy}") from error
    if jnp.iscomplexobj(array):
        raise InputError(
            f"fn returned {array.dtype} numbers, which have no order: take .real or abs."
        )
    return array


def _values(out, lead, width, vectorized):
    """What an objective returned as an array, checked: (*lead,), or (*lead, width)."""
    if width is not None and isinstance(out, tuple | list):
        out = jnp.concatenate([_real(part).reshape(*lead, -1) for part in out], axis=-1)
    out = _real(out)
    shape, expected = jnp.shape(out), lead if width is None else (*lead, width)
    if shape == expected:
        return out
    if width is not None:
        raise InputError(
            f"fn returned values of shape {shape}, the optimizer needs {expected}: one row of "
            f"{width} numbers a candidate (value and constraints, or objectives)."
        )
    if vectorized:
        raise InputError(
            f"fn returned shape {shape} for a population, expected {expected}: with "
            "vectorized=True it must return one value a candidate; if yours evaluates one candidate, pass "
            "vectorized=False."
        )
    raise InputError(
        f"fn returned shape {shape}, expected a scalar: fn(params, args) gets one candidate; "
        "if yours evaluates the whole population, pass vectorized=True; if it returns several "
        "objectives, search with nsga2(...) or mopso(...)."
    )
