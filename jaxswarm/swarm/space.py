"""The search space: a unit cube that decodes to named parameters.

Every optimizer searches [0, 1]^d, so step sizes, limits and diversity carry no units and a
parameter of 1e-6 is treated like one of 1e3. A :class:`Space` turns a point u of the cube into
parameters:

    linear   x = lower + u (upper - lower)
    log      x = lower (upper / lower)^u

The bounds are leaves (change or map them without compiling), names and scales are static.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError, nearest

__all__ = ["Bound", "Space"]

SCALES = ("linear", "log")


class Bound(NamedTuple):
    """Box of one named parameter, a scalar or an array.

    Attributes:
      lower: smallest value, scalar or array.
      upper: largest value, larger than ``lower`` everywhere.
      scale: ``"linear"``, or ``"log"`` for positive parameters that range over decades.
      unit: for people, e.g. ``"N m s/rad"``.
    """

    lower: Any
    upper: Any
    scale: str = "linear"
    unit: str = ""


class Space:
    """Named, bounded parameters as the unit cube that optimizers search.

    Args:
      **bounds: for each parameter a :class:`Bound`, a pair ``(lower, upper)``, or a dict of these.

    Coordinates stand in the order in which JAX flattens a dict: sorted by name.

    Attributes:
      lower, upper: bounds of all coordinates, (d,).
      names: name of each coordinate; those of arrays and dicts are joined, ``"joint.fc[0]"``.
      log: whether each coordinate is on a logarithmic scale.

    Raises:
      InputError: bounds that are not finite, ``lower >= upper``, a log scale that reaches zero.

    >>> space = Space(mass=Bound(0.1, 10.0, "log", "kg"), offset=(-1.0, 1.0))
    >>> space.size
    2
    >>> params = space.decode(jnp.array([0.5, 0.25]))
    >>> {name: round(float(value), 4) for name, value in sorted(params.items())}
    {'mass': 1.0, 'offset': -0.5}
    >>> space.encode(params)
    Array([0.5 , 0.25], dtype=float64)
    """

    def __init__(self, **bounds: Any):
        if not bounds:
            raise InputError("Space() has no parameters: name at least one, Space(x=(0.0, 1.0)).")
        leaves, structure = jax.tree_util.tree_flatten_with_path(bounds, is_leaf=_is_bound)
        boxes = [(_name(path), *_as_bound(_name(path), leaf)) for path, leaf in leaves]
        _fill(
            self,
            lower=np.concatenate([lower.ravel() for _, lower, *_ in boxes]),
            upper=np.concatenate([upper.ravel() for _, _, upper, *_ in boxes]),
            names=tuple(n for name, lower, *_ in boxes for n in _names(name, lower.shape)),
            log=tuple(s == "log" for _, lower, _, s, _ in boxes for _ in range(lower.size)),
            units=tuple(unit for _, lower, _, _, unit in boxes for _ in range(lower.size)),
            shapes=tuple(lower.shape for _, lower, *_ in boxes),
            structure=structure,
        )

    @classmethod
    def from_arrays(
        cls, names: Any, lower: Any, upper: Any, *, scale: Any = "linear", units: Any = ""
    ) -> "Space":
        """Build a space of scalars from arrays; ``scale`` and ``units`` may be one or one each.

        >>> Space.from_arrays(["a", "b"], [0.0, 1.0], [1.0, 2.0]).names
        ('a', 'b')
        """
        names = tuple(names)
        lower, upper = _vectors(lower, upper)
        if lower.size != len(names):
            raise InputError(
                f"names has {len(names)} entries, lower {lower.size}: give one a name."
            )
        scales = (scale,) * len(names) if isinstance(scale, str) else tuple(scale)
        units = (units,) * len(names) if isinstance(units, str) else tuple(units)
        bounds = map(Bound, lower, upper, scales, units)
        return cls(**dict(zip(names, bounds, strict=True)))

    @classmethod
    def vector(
        cls, lower: Any, upper: Any, *, names: Any = None, scale: Any = "linear", units: Any = ""
    ) -> "Space":
        """Build a space that decodes to a flat vector (d,), a population to a matrix (n, d).

        >>> Space.vector([0.0, 0.0], [2.0, 4.0]).decode(jnp.array([0.5, 0.5]))
        Array([1., 2.], dtype=float64)
        """
        lower, upper = _vectors(lower, upper)
        size = lower.size
        names = tuple(names) if names is not None else _names("x", (size,))
        scales = (scale,) * size if isinstance(scale, str) else tuple(scale)
        units = (units,) * size if isinstance(units, str) else tuple(units)
        for name, low, high, one in zip(names, lower, upper, scales, strict=True):
            _as_bound(name, Bound(low, high, one))
        log = tuple(one == "log" for one in scales)
        shapes = ((size,),)
        fields = dict(names=names, log=log, units=units, shapes=shapes, structure=None)
        return _fill(object.__new__(cls), lower=lower, upper=upper, **fields)

    @property
    def size(self) -> int:
        """Number of coordinates d."""
        return len(self.names)

    @property
    def dtype(self) -> Any:
        """Floating type of the bounds, in which a search is carried out."""
        return jnp.result_type(jax.dtypes.canonicalize_dtype(jnp.result_type(self.lower)), 0.0)

    def decode(self, position: jax.Array) -> Any:
        """Turn a point of the unit cube, (d,), into parameters; map over a population with vmap."""
        lower, upper = self._bounds(position.dtype)
        flat = lower + position * (upper - lower)
        if any(self.log):
            log = np.array(self.log)
            low, high = jnp.where(log, lower, 1.0), jnp.where(log, upper, 1.0)
            flat = jnp.where(log, low * jnp.exp(position * jnp.log(high / low)), flat)
        flat = jnp.clip(flat, lower, upper)  # rounding must not leave the box
        if self.structure is None:
            return flat
        ends = np.cumsum([int(np.prod(shape)) for shape in self.shapes])
        parts = [
            part.reshape(s) for part, s in zip(jnp.split(flat, ends[:-1]), self.shapes, strict=True)
        ]
        return jax.tree_util.tree_unflatten(self.structure, parts)

    def encode(self, params: Any) -> jax.Array:
        """Turn parameters into a point, (d,): in [0, 1] where they are within the bounds."""
        leaves = [jnp.asarray(leaf) for leaf in jax.tree.leaves(params)]
        flat = jnp.concatenate([leaf.ravel() for leaf in leaves]).astype(self.dtype)
        if flat.size != self.size:
            raise InputError(f"params hold {flat.size} numbers, the space has {self.size}.")
        lower, upper = self._bounds(flat.dtype)
        position = (flat - lower) / (upper - lower)
        if any(self.log):
            log = np.array(self.log)
            low, high = jnp.where(log, lower, 1.0), jnp.where(log, upper, 2.0)
            safe = jnp.where(log, flat, 1.0)
            position = jnp.where(log, jnp.log(safe / low) / jnp.log(high / low), position)
        return position

    def _bounds(self, dtype):
        return jnp.asarray(self.lower, dtype), jnp.asarray(self.upper, dtype)

    def __repr__(self) -> str:
        shown = ", ".join(self.names[:6]) + (", ..." if self.size > 6 else "")
        return f"Space({self.size}: {shown})"


_LEAVES = ("lower", "upper")
_STATIC = ("names", "log", "units", "shapes", "structure")


def _flatten(space):
    children = tuple((jax.tree_util.GetAttrKey(n), getattr(space, n)) for n in _LEAVES)
    return children, tuple(getattr(space, n) for n in _STATIC)


def _unflatten(static, leaves):
    fields = dict(zip(_LEAVES + _STATIC, (*leaves, *static), strict=True))
    return _fill(object.__new__(Space), **fields)


jax.tree_util.register_pytree_with_keys(Space, _flatten, _unflatten)


def _fill(space, **fields):
    for name, value in fields.items():
        object.__setattr__(space, name, value)
    return space


def _is_bound(node) -> bool:
    return isinstance(node, Bound) or not isinstance(node, dict)


def _name(path) -> str:
    return ".".join(str(entry.key) for entry in path)


def _names(name: str, shape: tuple[int, ...]) -> tuple[str, ...]:
    if not shape:
        return (name,)
    return tuple(f"{name}[{','.join(map(str, index))}]" for index in np.ndindex(*shape))


def _as_bound(name: str, bound: Any) -> tuple[np.ndarray, np.ndarray, str, str]:
    if not isinstance(bound, Bound):
        if not isinstance(bound, tuple) or len(bound) != 2:
            raise InputError(f"{name}={bound!r}: give a Bound or a pair (lower, upper).")
        bound = Bound(*bound)
    lower, upper = _floats(bound.lower), _floats(bound.upper)
    lower, upper = np.broadcast_arrays(lower, upper)
    if not (np.isfinite(lower).all() and np.isfinite(upper).all()):
        raise InputError(f"{name}: bounds {bound.lower} and {bound.upper} must be finite numbers.")
    if not (lower < upper).all():
        raise InputError(
            f"{name}: lower={bound.lower} must be below upper={bound.upper}; "
            "to hold a parameter fixed use the wrapper freeze."
        )
    if bound.scale not in SCALES:
        raise InputError(f"{name}: scale={bound.scale!r}. {nearest(str(bound.scale), SCALES)}")
    if bound.scale == "log" and not (lower > 0).all():
        raise InputError(f"{name}: a log scale needs lower > 0, not {bound.lower}.")
    return lower, upper, bound.scale, bound.unit


def _floats(value) -> np.ndarray:
    array = np.asarray(value)
    return array if np.issubdtype(array.dtype, np.floating) else array.astype(float)


def _vectors(lower, upper) -> tuple[np.ndarray, np.ndarray]:
    lower, upper = np.broadcast_arrays(np.atleast_1d(_floats(lower)), np.atleast_1d(_floats(upper)))
    if lower.ndim != 1:
        raise InputError(f"lower and upper have shape {lower.shape}: one number a coordinate.")
    return lower, upper
