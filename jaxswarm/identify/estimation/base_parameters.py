r"""Base parameters: the combinations of columns that data can tell apart.

The columns of the torque regressor are linearly dependent: an inertia about a fixed vertical axis
cannot be told from the next link's. Walking through the columns in order, a column that the kept ones
already span is dropped, and its coefficients say how its parameter merges into the kept ones,

.. math:: W_{dep} = W_{base} \beta, \qquad \theta_{base}^* = \theta_{base} + \beta\,\theta_{dep}.

Done on the triangular factor of the data, not on a symbolic model, so that a joint that never moved is
seen as well. Reference: M. Gautier, "Numerical calculation of the base inertial parameters of robots",
J. Robotic Systems 8(4), 1991.
"""

from dataclasses import dataclass

import numpy as np

from jaxswarm.decomposition import lstsq

# A column below this share of the largest one is zero, and one of which no more than this share is its own
# follows from the others: what is left comes of an angle written with nine digits, or of rounding, and noise
# hides a parameter that shows through it unless it is ten million times the usual.
_NOTHING = 1e-7


@dataclass(frozen=True)
class BaseParameters:
    """A basis of the column space and how the other columns merge into it.

    Attributes:
        names: Names of all p columns.
        kept: Indices of the b independent columns.
        dropped: Indices of the dependent columns that merge into kept ones.
        dead: Indices of the columns that are zero: the data never excite them.
        merge: beta, shape (b, len(dropped)).
    """

    names: tuple[str, ...]
    kept: np.ndarray
    dropped: np.ndarray
    dead: np.ndarray
    merge: np.ndarray

    @property
    def size(self) -> int:
        """Number of base parameters."""
        return len(self.kept)

    @property
    def unfelt(self) -> np.ndarray:
        """Directions of full vectors along which the columns' sum stays as it is, (p, p - b)."""
        directions = np.zeros((len(self.names), len(self.dropped) + len(self.dead)))
        gone = np.concatenate([self.dropped, self.dead])
        directions[gone, np.arange(len(gone))] = 1.0
        directions[self.kept, : len(self.dropped)] = -self.merge
        return directions

    def expressions(self, tolerance: float = 1e-6) -> tuple[str, ...]:
        """Each base parameter in the standard ones, for example ``Izz1 + Iyy2 + Iyy3``."""
        lines = []
        for row, column in enumerate(self.kept):
            text = self.names[column].split(":")[0]
            for k, other in enumerate(self.dropped):
                factor = self.merge[row, k]
                if abs(factor) > tolerance:
                    size = "" if abs(abs(factor) - 1.0) < tolerance else f"{abs(factor):.5g} "
                    text += f" {'-' if factor < 0 else '+'} {size}{self.names[other].split(':')[0]}"
            lines.append(text)
        return tuple(lines)

    def reduce(self, theta: np.ndarray) -> np.ndarray:
        """Base combinations of full parameter vectors: (..., p) -> (..., b)."""
        theta = np.asarray(theta)
        return theta[..., self.kept] + theta[..., self.dropped] @ self.merge.T

    def expand(self, base: np.ndarray) -> np.ndarray:
        """A full vector with the given base combinations and zeros elsewhere: (..., b) -> (..., p)."""
        full = np.zeros((*np.shape(base)[:-1], len(self.names)))
        full[..., self.kept] = base
        return full


def find_base(
    factor: np.ndarray, names: tuple[str, ...], tolerance: float = _NOTHING
) -> BaseParameters:
    """Split columns into independent, merging and dead ones.

    Args:
        factor: Any matrix with the columns' geometry, such as the triangular factor of the data,
            shape (m, p), m >= p or not.
        names: Column names, p of them.
        tolerance: A column whose part outside the kept span is smaller than this share of its norm
            is dependent.

    >>> base = find_base(np.array([[1.0, 2.0, 0.0], [0.0, 0.0, 1.0]]), ("a", "b", "c"))
    >>> base.expressions()
    ('a + 2 b', 'c')
    """
    norms = np.linalg.norm(factor, axis=0)
    scale = norms.max(initial=0.0)
    every = np.zeros(factor.shape, order="F")
    independent: list[int] = []
    dependent: list[int] = []
    dead: list[int] = []
    for k in range(factor.shape[1]):
        if norms[k] <= _NOTHING * scale or norms[k] == 0.0:
            dead.append(k)
            continue
        rest = factor[:, k] / norms[k]
        for _ in range(2):  # twice is enough for orthogonality (Kahan)
            basis = every[:, : len(independent)]
            rest = rest - basis @ (basis.T @ rest)
        size = np.linalg.norm(rest)
        if size <= tolerance:
            dependent.append(k)
        else:
            every[:, len(independent)] = rest / size
            independent.append(k)
    kept, dropped = np.array(independent, dtype=int), np.array(dependent, dtype=int)
    scaled = factor[:, kept] / norms[kept]
    merge = lstsq(scaled, factor[:, dropped]) / norms[kept][:, None]
    merge[np.abs(merge) < 1e-9 * np.abs(merge).max(initial=0.0)] = 0.0
    return BaseParameters(tuple(names), kept, dropped, np.array(dead, dtype=int), merge)
