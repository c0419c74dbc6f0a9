"""How a search calls an objective: with what, and what has to come back; else it is told what to change."""

import inspect
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError

__all__ = ["called", "check_takes"]

# NumPy, ``if`` and ``x[x > 0]`` ask for numbers where a program is made; whoever writes these has a remedy.
UNTRACED = (
    jax.errors.ConcretizationTypeError,
    jax.errors.NonConcreteBooleanIndexError,
    jax.errors.TracerArrayConversionError,
    jax.errors.TracerIntegerConversionError,
)


def check_takes(fn: Callable[..., Any], *names: str) -> None:
    """Refuse a function that cannot be called with arguments of these names, before anything is traced."""
    try:
        signature = inspect.signature(fn)
    except (TypeError, ValueError):
        return  # compiled ones need not tell
    try:
        signature.bind(*names)
    except TypeError as error:
        call = f"fn({', '.join(names)})"
        raise InputError(
            f"fn takes {signature}, it is called as {call}: {error}. Write lambda {', '.join(names)}: ... "
            "around it."
        ) from None


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
        raise InputError(
            f"fn returned {out!r}, which is no number: is a return missing?"
        ) from error
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
            "vectorized=True it must return one value a candidate."
        )
    raise InputError(
        f"fn returned shape {shape}, expected a scalar: fn(params, args) gets one candidate; "
        "if yours evaluates the whole population, pass vectorized=True."
    )
