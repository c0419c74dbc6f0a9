"""Programs scored by NumPy, one after the other: on a processor that costs a tenth of what code for lanes does.

A lane goes through every operation of the machine at every step to choose one; here each program does its own.
"""

from collections.abc import Mapping, Sequence
from functools import cache

import jax
import numpy as np

from jaxswarm.diagnose.discovery.grammar import MOST_CONSTANTS
from jaxswarm.diagnose.discovery.on_device import PARTICLES, STEPS
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import OWN, SearchRows
from jaxswarm.effects.postfix import evaluate


def survey(
    names: Sequence[str],
    searched: SearchRows,
    pieces: Sequence[Piece],
    lattices: Mapping[int, np.ndarray],
) -> tuple[np.ndarray, np.ndarray]:
    """As :func:`jaxswarm.diagnose.discovery.on_device.survey`."""
    best = np.full((len(pieces), MOST_CONSTANTS), 0.5, np.float32)
    shares = np.zeros(len(pieces))
    for i, piece in enumerate(pieces):
        points = lattices[len(piece.constants)]
        told = shares_at(names, searched, piece, points)
        first = int(np.argmax(told))
        best[i], shares[i] = points[first], told[first]
    return best, shares


def refined(
    names: Sequence[str],
    searched: SearchRows,
    pieces: Sequence[Piece],
    low: np.ndarray,
    width: np.ndarray,
    seed: int,
) -> tuple[np.ndarray, np.ndarray]:
    """As :func:`jaxswarm.diagnose.discovery.on_device.refined`; swarms move at once, programs take turns."""
    place, share = low.copy(), np.zeros(len(pieces))
    for count in range(MOST_CONSTANTS + 1):
        own = [i for i, one in enumerate(pieces) if len(one.constants) == count]
        if not own:
            continue
        if count == 0:
            share[own] = [shares_at(names, searched, pieces[i], low[[i]])[0] for i in own]
            continue
        start, advance = _swarm(count)
        keys = jax.random.split(jax.random.key(seed), (STEPS + 1, len(own)))
        state = start(keys[0])
        # One constant is found in fewer steps than three.
        for step in range(STEPS * (count + 1) // (MOST_CONSTANTS + 1)):
            at = low[own][:, None] + np.zeros((1, PARTICLES, 1), np.float32)
            at[:, :, :count] += width[own][:, None, :count] * np.asarray(state.position)
            told = [shares_at(names, searched, pieces[i], u) for i, u in zip(own, at, strict=True)]
            state = advance(keys[step + 1], state, -np.stack(told).astype(np.float32))
        place[own, :count] += width[own, :count] * np.asarray(state.best_position)
        share[own] = -np.asarray(state.best_value)
    return place, share


@cache
def _swarm(dimensions: int):
    """How the swarms of several programs start and move, compiled once."""
    from jaxswarm.swarm import de  # a diagnosis without --discover needs no swarm

    optimizer = de(PARTICLES)
    start = jax.vmap(lambda key: optimizer.init(key, dimensions, np.float32))
    advance = jax.vmap(lambda key, state, value: optimizer.update(key, state, value)[0])
    return jax.jit(start), jax.jit(advance)


def shares_at(
    names: Sequence[str], searched: SearchRows, piece: Piece, points: np.ndarray
) -> np.ndarray:
    """Shares (m,) of the residual's square that a program takes off at points (m, M) of the unit cube."""
    column = columns_at(names, searched, piece, points)
    with np.errstate(all="ignore"):
        size = np.einsum("mr,mr->m", column, column)
        inner = column @ searched.basis
        left = size - np.einsum("mb,mb->m", inner, inner)
        own = (left > OWN * size) & np.isfinite(size) & (size > 0.0)
        gain = (column @ searched.residual) ** 2 / np.where(own, left, 1.0)
    share = np.where(own, gain, 0.0) / (searched.residual @ searched.residual)
    return np.broadcast_to(share, len(points))


def columns_at(
    names: Sequence[str], searched: SearchRows, piece: Piece, points: np.ndarray
) -> np.ndarray:
    """Weighted columns of a program at points, (m, R); a single one where it has no constants."""
    known = dict(zip(names, searched.variables, strict=True))
    known |= {p.name: p.decode(points[:, k, None]) for k, p in enumerate(piece.constants)}
    with np.errstate(all="ignore"):
        return np.atleast_2d(evaluate(piece.program, known, np)) * searched.weight
