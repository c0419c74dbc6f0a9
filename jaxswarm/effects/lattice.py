"""The points at which nonlinear parameters of a law are first tried, and how many of them at a time."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter

# Lattice points, shared by the dimensions, for a law that does not ask for its own number of them.
_POINTS = 128
# Samples times points whose columns are held at a time: with what a law has in between, some hundred megabytes.
_HELD = 2**21


def points_of(law: TorqueLaw) -> int:
    """How many points a law is tried at."""
    return law.grid_size or _POINTS


def batch_of(samples: int, points: int) -> int:
    """How many points pass at a time, a divisor of them.

    >>> batch_of(5_000, 36), batch_of(250_000, 36), batch_of(10**9, 36)
    (36, 6, 1)
    """
    return max(
        n for n in range(1, points + 1) if points % n == 0 and n * samples <= max(_HELD, samples)
    )


def lattice_of(dims: int, points: int, most: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Lattice points in the unit cube, ``most`` in shape, and half the width of a cell with its neighbors.

    Dimensions beyond ``dims`` stay in the middle; the last point repeats up to the most of any law.
    """
    count = int(points ** (1 / dims) + 1e-9)
    axis = (np.arange(count) + 0.5) / count
    grid = np.stack(np.meshgrid(*[axis] * dims, indexing="ij"), axis=-1).reshape(-1, dims)
    lattice = np.full(most, 0.5)
    lattice[:, :dims] = grid[np.minimum(np.arange(most[0]), len(grid) - 1)]
    return lattice, np.where(np.arange(most[1]) < dims, 1.0 / count, 0.5)


def seen_of(
    law: TorqueLaw, positions: Sequence[np.ndarray], dims: int
) -> tuple[np.ndarray, np.ndarray]:
    """Where in the unit cube a law's lattice begins and how far it reaches, (dims,) each.

    What is a place or a width on the way of its joint shows within the positions seen: 0.4 rad from point to
    point is half the motion of many a joint, and twice that of most slides.
    """
    least, most = min(float(x.min()) for x in positions), max(float(x.max()) for x in positions)
    low, high = np.zeros(dims), np.ones(dims)
    for k, parameter in enumerate(ordered(law)):
        if parameter.lies is not None:
            ends = (least, most) if parameter.lies == "place" else (0.0, most - least)
            low[k], high[k] = np.clip([parameter.encode(x) for x in ends], 0.0, 1.0)
    return low, high - low


def ordered(law: TorqueLaw) -> list[Parameter]:
    """Nonlinear parameters as the unit cube has them."""
    return sorted(law.nonlinear, key=lambda p: p.name)
