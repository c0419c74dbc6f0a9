"""The search space: a unit cube that decodes to named parameters.

Every optimizer searches [0, 1]^d, so step sizes, limits and diversity carry no units and a
parameter of 1e-6 is treated like one of 1e3. A :class:`Space` turns a point of the cube into
parameters, each on a scale of its own (:mod:`jaxswarm.swarm.scales`).
The bounds are leaves (change or map them without compiling), names and scales are static.
"""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.swarm.bounds import (
    Bound,
    Choice,
    array_of,
    as_box,
    is_bound,
    joined,
    name_of,
    names_in,
    one_each,
    point_of,
    searched,
    vectors,
)
from jaxswarm.swarm.scales import COUNTED, to_unit, to_values

__all__ = ["Bound", "Choice", "Space"]


class Space:
    """Named, bounded parameters as the unit cube that optimizers search.

    Args:
      **bounds: for each parameter a :class:`Bound`, a :class:`Choice`, a pair ``(lower, upper)``, or
        a dict, list or tuple of these. A tuple is a container if it holds tuples: bounds that are
        arrays are written ``Bound((0, 0), (1, 2))`` or ``([0, 0], [1, 2])``.

    Coordinates stand in the order in which JAX flattens a dict: sorted by name.

    Attributes:
      lower, upper: bounds of all coordinates, (d,).
      names: name of each coordinate; ``"joint.fc[0]"`` in arrays, dicts and lists.
      scales: scale of each coordinate; units: unit of each.

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
    >>> network = Space(layers=[Bound(1, 64, "integer")] * 2, kind=Choice(("relu", "tanh")))
    >>> network.labeled(network.decode(jnp.array([0.9, 0.0, 0.5])))
    {'kind': 'tanh', 'layers': [1, 33]}
    """

    lower: Any
    upper: Any
    names: tuple[str, ...]
    scales: tuple[str, ...]
    units: tuple[str, ...]
    shapes: tuple[tuple[int, ...], ...]
    structure: Any
    options: tuple[Any, ...]

    def __init__(self, /, **bounds: Any):
        leaves, structure = jax.tree_util.tree_flatten_with_path(bounds, is_leaf=is_bound)
        if not leaves:
            raise InputError("Space() has no parameters: name at least one, Space(x=(0.0, 1.0)).")
        named = [(name_of(path), leaf) for path, leaf in leaves]
        boxes = [as_box(name, leaf) for name, leaf in named]

        def spread(field):
            return tuple(getattr(box, field) for box in boxes for _ in range(box.lower.size))

        _fill(
            self,
            lower=joined([box.lower for box in boxes]),
            upper=joined([box.upper for box in boxes]),
            names=tuple(
                one
                for (name, _), box in zip(named, boxes, strict=True)
                for one in names_in(name, box.lower.shape)
            ),
            scales=spread("scale"),
            units=spread("unit"),
            shapes=tuple(box.lower.shape for box in boxes),
            structure=structure,
            options=tuple(box.options for box in boxes),
        )

    @classmethod
    def from_arrays(
        cls, names: Any, lower: Any, upper: Any, *, scale: Any = "linear", units: Any = ""
    ) -> "Space":
        """Build a space of scalars from arrays; ``scale`` and ``units`` may be one or one each.

        >>> Space.from_arrays(["a", "b"], [0.0, 1.0], [1.0, 2.0]).names
        ('a', 'b')
        """
        lower, upper = vectors(lower, upper)
        names = one_each("names", names, lower.size)
        scales, units = one_each("scale", scale, lower.size), one_each("units", units, lower.size)
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
        lower, upper = vectors(lower, upper)
        size = lower.size
        names = names_in("x", (size,)) if names is None else one_each("names", names, size)
        scales = one_each("scale", scale, size)
        for i in range(size):
            as_box(names[i], Bound(lower[i], upper[i], scales[i]))
        return _fill(
            object.__new__(cls),
            lower=lower,
            upper=upper,
            names=names,
            scales=scales,
            units=one_each("units", units, size),
            shapes=((size,),),
            structure=None,
            options=(None,),
        )

    @property
    def size(self) -> int:
        """Number of coordinates d."""
        return len(self.names)

    @property
    def log(self) -> tuple[bool, ...]:
        """Whether each coordinate is on a logarithmic scale."""
        return tuple(scale == "log" for scale in self.scales)

    @property
    def dtype(self) -> Any:
        """Floating type of the bounds, float32 at least, in which a search is carried out."""
        return searched(jnp.result_type(self.lower))

    def decode(self, position: jax.Array) -> Any:
        """Turn a point of the unit cube, (d,), into parameters; map over a population with vmap.

        Parameters on an integer scale and choices are int32, in a flat vector floats.
        """
        position = point_of(position, self.size, flat=self.structure is None)
        flat = to_values(position, *self._bounds(position.dtype), self.scales)
        if self.structure is None:
            return flat
        ends = np.cumsum([int(np.prod(shape)) for shape in self.shapes])
        parts = jnp.split(flat, ends[:-1])
        counted = [self.scales[end - 1] in COUNTED for end in ends]
        leaves = [
            (part.astype(jnp.int32) if whole else part).reshape(shape)
            for part, whole, shape in zip(parts, counted, self.shapes, strict=True)
        ]
        return jax.tree_util.tree_unflatten(self.structure, leaves)

    def encode(self, params: Any) -> jax.Array:
        """Turn parameters into a point, (d,): in [0, 1] where they are within the bounds.

        Args:
          params: as :meth:`decode` returns them; of a choice also the option itself.

        Raises:
          InputError: other names, other shapes, an option that is not among the choices.
        """
        leaves = [params] if self.structure is None else self._leaves(params)
        firsts = np.cumsum(np.array([0, *(int(np.prod(shape)) for shape in self.shapes[:-1])]))
        flat = []
        rows = zip(leaves, self.shapes, self.options, firsts, strict=True)
        for leaf, shape, options, first in rows:
            name = self.names[first]
            value = array_of(name, leaf, options)
            if value.shape != shape:
                raise InputError(
                    f"{name}: params hold {value.size} numbers of shape {value.shape}, the space has "
                    f"shape {shape}."
                )
            flat.append(value.ravel().astype(self.dtype))
        return to_unit(jnp.concatenate(flat), *self._bounds(self.dtype), self.scales)

    def labeled(self, params: Any) -> Any:
        """Return parameters for people, on the host: choices by their options, numbers as numbers."""
        leaves = jax.tree.leaves(params) if self.structure is None else self._leaves(params)
        shown = [
            np.asarray(leaf).tolist() if options is None else options[int(leaf)]
            for leaf, options in zip(leaves, self.options, strict=True)
        ]
        return shown[0] if self.structure is None else jax.tree.unflatten(self.structure, shown)

    def _leaves(self, params):
        leaves, structure = jax.tree_util.tree_flatten_with_path(params)
        if structure == self.structure:
            return [leaf for _, leaf in leaves]
        blank = jax.tree.unflatten(self.structure, self.shapes)
        shape = lambda node: isinstance(node, tuple) and node in self.shapes  # noqa: E731
        own = jax.tree_util.tree_flatten_with_path(blank, is_leaf=shape)[0]
        found, wanted = ({name_of(path) for path, _ in some} for some in (leaves, own))
        raise InputError(
            f"params are other than the space's: {sorted(wanted - found) or 'nothing'} missing, "
            f"{sorted(found - wanted) or 'nothing'} unknown; the space decodes to {self.structure}."
        )

    def _bounds(self, dtype: Any) -> tuple[jax.Array, jax.Array]:
        return jnp.asarray(self.lower, dtype), jnp.asarray(self.upper, dtype)

    def __repr__(self) -> str:
        shown = ", ".join(self.names[:6]) + (", ..." if self.size > 6 else "")
        return f"Space({self.size}: {shown})"


_LEAVES = ("lower", "upper")
_STATIC = ("names", "scales", "units", "shapes", "structure", "options")


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
