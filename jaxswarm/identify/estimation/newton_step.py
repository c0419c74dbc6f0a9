"""Steps of free parameters from the triangular factor of columns, tangents and what is left."""

import numpy as np

from jaxswarm.decomposition import lstsq
from jaxswarm.identify.estimation.bounded import solve
from jaxswarm.identify.estimation.factors import triangular_factor

# A step goes no further than this part of a parameter's range. What the linear parameters leave of a tangent is
# rounding below such a part of it, and leads nowhere: as singular values over the largest, and as a ridge.
REACH, _RANK, _RIDGE = 0.2, 1e-8, 1e-6


def step_anywhere(triangle: np.ndarray, count: int) -> np.ndarray:
    """Change (m,) of the positions of the last ``count`` columns before what is left, whatever their bounds.

    >>> step_anywhere(np.array([[1.0, 0.0, 1.0], [0.0, 10.0, 1.0], [0.0, 0.0, 3.0]]), 1).round(9).tolist()
    [0.1]
    """
    matrix, target = triangle[:, :-1], triangle[:, -1]
    scale = np.linalg.norm(matrix, axis=0)
    scale[scale == 0] = 1.0
    step = lstsq(matrix / scale, target, rcond=_RANK) / scale
    return np.clip(step[-count:], -REACH, REACH)


def step_within(triangle: np.ndarray, position: np.ndarray) -> tuple[np.ndarray, float]:
    """The best change (m,) of positions (m,) within [0, 1], and by how much it would lower the cost.

    Args:
        triangle: Upper triangular factor of columns, tangents of the positions and what is left.
        position: Of the free parameters.

    >>> held = np.array([[10.0, -8.0, -1.5], [0.0, 5.0, 0.5], [0.0, 0.0, 3.0]])
    >>> for position in (0.5, 0.0):
    ...     step, promised = step_within(held, np.array([position, 0.5]))
    ...     print(np.abs(step).round(6), round(promised, 6))
    [0.07 0.1 ] 2.5
    [0.       0.162921] 2.36236
    """
    size, count = triangle.shape[1] - 1, len(position)
    own = slice(size - count, size)
    matrix, target = triangle[own, own], triangle[own, -1]
    ridge = np.diag(_RIDGE * np.linalg.norm(triangle[:, own], axis=0))
    rows = np.concatenate([matrix, ridge])
    held = triangular_factor(np.column_stack([rows, np.append(target, np.zeros(count))]))
    # A width beyond the range of its joint's motion has so far to go, and may go on from there.
    least, most = -position, 1.0 - position
    low = np.maximum(least, np.minimum(most, 0.0) - REACH)
    high = np.minimum(most, np.maximum(least, 0.0) + REACH)
    step, _ = solve(held, low, high)
    return step, float(target @ target - np.square(target - matrix @ step).sum())
