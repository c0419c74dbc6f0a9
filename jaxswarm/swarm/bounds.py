"""The boxes a space is made of, and the checks that name what is wrong with one."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.swarm.scales import SCALES

__all__ = [
    "Bound",
    "Box",
    "Choice",
    "array_of",
    "as_box",
    "is_bound",
    "joined",
    "name_of",
    "names_in",
    "one_each",
    "point_of",
    "searched",
    "vectors",
]


class Bound(NamedTuple):
    """Box of one named parameter, a scalar or an array.

    Attributes:
      lower: smallest value, scalar or array.
      upper: largest value, larger than ``lower`` everywhere.
      scale: ``"linear"``; ``"log"`` for positive parameters that range over decades; ``"integer"``;
        ``"unbounded"``, where ``lower`` and ``upper`` enclose what is usual (half of the cube).
      unit: for people, e.g. ``"N m s/rad"``.
    """

    lower: Any
    upper: Any
    scale: str = "linear"
    unit: str = ""


class Choice(NamedTuple):
    """One of several options, such as words; a candidate holds the index of its option.

    Attributes:
      options: at least two, hashable.
    """

    options: tuple


class Box(NamedTuple):
    """A checked bound: arrays of equal shape, scale, unit, options of a choice."""

    lower: Any
    upper: Any
    scale: str
    unit: str
    options: tuple | None


def is_bound(node: Any) -> bool:
    """Whether a node of the tree given to ``Space`` is one parameter, and not a container of some.

    A list is a container, and so is a tuple in which a further tuple, dict, ``Bound`` or ``Choice``
    stands; a pair of numbers or arrays is a box.
    """
    if isinstance(node, Bound | Choice):
        return True
    if isinstance(node, dict | list):
        return False
    return not (isinstance(node, tuple) and any(_holds_bounds(entry) for entry in node))


def _holds_bounds(node: Any) -> bool:
    if isinstance(node, list):
        return any(_holds_bounds(entry) for entry in node)
    return isinstance(node, dict | tuple)


def name_of(path: tuple) -> str:
    """Join the keys of a path in a tree: ``joint.fc``, ``gains[0]``."""
    name = ""
    for entry in path:
        if hasattr(entry, "idx"):
            name += f"[{entry.idx}]"
        else:
            key = entry.key if hasattr(entry, "key") else entry.name
            name += f".{key}" if name else str(key)
    return name


def names_in(name: str, shape: tuple[int, ...]) -> tuple[str, ...]:
    """Names of the elements of an array of this name."""
    if not shape:
        return (name,)
    return tuple(f"{name}[{','.join(map(str, index))}]" for index in np.ndindex(*shape))


def as_box(name: str, bound: Any) -> Box:
    """Check one bound; what is traced is taken as it is."""
    if isinstance(bound, Choice):
        options = tuple(bound.options)
        if len(options) < 2 or len(set(options)) < len(options):
            raise InputError(f"{name}: options={options!r} must be two or more that differ.")
        ends = np.zeros(()), np.full((), len(options) - 1.0)
        return Box(*ends, "categorical", "", options)
    if not isinstance(bound, Bound):
        if not isinstance(bound, tuple) or len(bound) != 2:
            raise InputError(f"{name}={bound!r}: give a Bound, a Choice or a pair (lower, upper).")
        bound = Bound(*bound)
    if bound.scale not in SCALES:
        raise InputError(f"{name}: scale={bound.scale!r}. {nearest(str(bound.scale), SCALES)}")
    lower, upper = _broadcast(_floats(name, bound.lower), _floats(name, bound.upper))
    if isinstance(lower, np.ndarray):
        _check(name, lower, upper, bound)
    return Box(lower, upper, bound.scale, bound.unit, None)


def _check(name, lower, upper, bound):
    if not (np.isfinite(lower).all() and np.isfinite(upper).all()):
        raise InputError(
            f"{name}: bounds {bound.lower} and {bound.upper} must be finite numbers; for a parameter "
            'without bounds give what is usual and scale="unbounded".'
        )
    if not (lower < upper).all():
        raise InputError(
            f"{name}: lower={bound.lower} must be below upper={bound.upper}; "
            "to hold a parameter fixed use the wrapper freeze."
        )
    dtype = searched(lower.dtype)
    with np.errstate(over="ignore"):
        lower, upper = lower.astype(dtype), upper.astype(dtype)
        width = upper - lower
    if not ((width > 0) & np.isfinite(width)).all():
        raise InputError(
            f"{name}: from {bound.lower} to {bound.upper} it is {width} in {dtype}: choose a unit in "
            "which it is near one, or float64 (jax_enable_x64)."
        )
    fault = SCALES[bound.scale].fault(lower, upper)
    if fault:
        raise InputError(f"{name}: {fault}.")


def searched(dtype: Any) -> Any:
    """The floating type in which bounds of a type are searched.

    In float16 values above 65504 are infinite, and JAX has no eigenvectors of matrices.
    """
    dtype = jax.dtypes.canonicalize_dtype(dtype)
    wide = jnp.issubdtype(dtype, jnp.floating) and dtype.itemsize >= 4
    return dtype if wide else jnp.dtype(jnp.float32)


def vectors(lower: Any, upper: Any) -> tuple[Any, Any]:
    """Bounds of a flat vector as arrays (d,)."""
    lower, upper = _broadcast(_floats("lower", lower), _floats("upper", upper))
    if not lower.ndim:
        lower, upper = lower[None], upper[None]
    if lower.ndim != 1:
        raise InputError(f"lower and upper have shape {lower.shape}: one number a coordinate.")
    return lower, upper


def _broadcast(lower, upper):
    traced = any(isinstance(end, jax.core.Tracer) for end in (lower, upper))
    try:
        return (jnp if traced else np).broadcast_arrays(lower, upper)
    except ValueError as error:
        raise InputError(
            f"lower has shape {lower.shape}, upper {upper.shape}: give as many of both."
        ) from error


def _floats(name, value):
    if isinstance(value, jax.core.Tracer):  # a leaf that is mapped or differentiated
        return value if jnp.issubdtype(value.dtype, jnp.floating) else value.astype(float)
    try:
        array = np.asarray(value)
        if np.iscomplexobj(array) or array.dtype == bool:
            raise TypeError(array.dtype)
        return array if np.issubdtype(array.dtype, np.floating) else array.astype(float)
    except (TypeError, ValueError) as error:
        yes_or_no = isinstance(value, bool | np.bool_)
        remedy = " A yes or no is Choice((False, True))." if yes_or_no else ""
        raise InputError(
            f"{name}: {value!r} is no number and no array of numbers.{remedy}"
        ) from error


def point_of(position: Any, size: int, *, flat: bool) -> jax.Array:
    """A point of the cube as an array (d,); of a flat vector a population (..., d), too."""
    position = jnp.asarray(position)
    if position.shape[-1:] != (size,) or (position.ndim > 1 and not flat):
        raise InputError(
            f"position has shape {position.shape}, the space {size} coordinates: decode one point "
            f"({size},), and a population by jax.vmap(space.decode)."
        )
    return position


def array_of(name: str, leaf: Any, options: tuple | None) -> jax.Array:
    """A parameter as an array of JAX: of a choice its index; or an error that names it."""
    leaf = _index_of(name, leaf, options)
    try:
        return jnp.asarray(leaf)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: {leaf!r} is no number and no array of numbers.") from error


def joined(parts: list[Any]) -> Any:
    """Flat arrays one after the other, of NumPy unless one of them is traced."""
    traced = any(isinstance(part, jax.core.Tracer) for part in parts)
    return (jnp if traced else np).concatenate([part.ravel() for part in parts])


def one_each(name: str, given: Any, size: int) -> tuple:
    """A text for all coordinates, or as many entries as there are, as a tuple."""
    values = (given,) * size if isinstance(given, str) else tuple(given)
    if len(values) != size:
        raise InputError(f"{name} has {len(values)} entries, lower {size}: give one each.")
    return values


def _index_of(name, leaf, options):
    """The index of an option, given by itself or by its index; anything else as it is."""
    if options is None or isinstance(leaf, jax.Array | np.ndarray | np.generic):
        return leaf
    if leaf in options:
        return options.index(leaf)
    if isinstance(leaf, int) and 0 <= leaf < len(options):
        return leaf
    raise InputError(f"{name}={leaf!r} is none of {', '.join(map(repr, options))}.")
