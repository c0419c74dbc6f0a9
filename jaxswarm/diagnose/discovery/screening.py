"""The first look at all programs: each at a few points of its constants, the best of them refined by swarms.

A program's own linear constant is eliminated, and its column freed of what the model absorbs, so that it is
credited only with what the model cannot do without it.
"""

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import scipy

from jaxswarm.diagnose.discovery.grammar import MOST_CONSTANTS
from jaxswarm.diagnose.discovery.machine import LENGTHS, Codes, encode, length_for, run
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import Joint, SearchRows, share_of
from jaxswarm.swarm import Space, de, minimize

# Points of the constants at which a program is looked at, by their number; and the half width of the cube in
# which the best point is refined.
_POINTS = {0: 1, 1: 12, 2: 36, 3: 64}
_CELL = {0: 0.0, 1: 0.1, 2: 0.2, 3: 0.3}
# Programs evaluated at once: memory of some tens of megabytes.
_LANES = 1024
# Programs of every number of constants that are refined.
_KEPT = 24
_PARTICLES, _STEPS = 12, 30
_UNIT = Space.vector(*np.outer([0.0, 1.0], np.ones(MOST_CONSTANTS)).astype(np.float32))


class Trial(NamedTuple):
    """A program with values for its constants.

    Attributes:
        piece: The program.
        values: Of its constants.
        share: Share of the residual's square that it takes off, where it was fitted.
    """

    piece: Piece
    values: dict[str, float]
    share: float


class Box(NamedTuple):
    """Ranges of constants as arrays (..., M): how the unit cube is decoded."""

    lower: np.ndarray
    upper: np.ndarray
    log: np.ndarray


def screen(
    problem: Joint, searched: SearchRows, pieces: Sequence[Piece], seed: int = 0
) -> list[Trial]:
    """The best programs with refined constants, the best first."""
    points, shares = _survey(problem, searched, pieces)
    chosen: list[int] = []
    for count in _POINTS:
        own = [i for i, one in enumerate(pieces) if len(one.constants) == count]
        own.sort(key=lambda i: (-shares[i], len(pieces[i].program)))
        chosen += own[:_KEPT]
    trials = _refined(problem, searched, [pieces[i] for i in chosen], points[chosen], seed)
    return sorted(trials, key=lambda one: -one.share)


def _survey(
    problem: Joint, searched: SearchRows, pieces: Sequence[Piece]
) -> tuple[np.ndarray, np.ndarray]:
    """Best point of every program in the unit cube (P, M), and its share (P,)."""
    best = np.full((len(pieces), MOST_CONSTANTS), 0.5, np.float32)
    shares = np.zeros(len(pieces))
    for length in LENGTHS:
        own = [i for i, one in enumerate(pieces) if length_for(len(one.program)) == length]
        lanes = [(i, u) for i in own for u in _lattice(len(pieces[i].constants))]
        if not lanes:
            continue
        codes, box = _arrays(problem, [pieces[i] for i in own], length)
        row = {i: k for k, i in enumerate(own)}
        for start in range(0, len(lanes), _LANES):
            part = lanes[start : start + _LANES]
            part += [part[-1]] * (_LANES - len(part))  # one shape, one compiled program
            at = np.array([row[i] for i, _ in part])
            cube = np.stack([u for _, u in part])
            told = _shares(jax.tree.map(lambda x, at=at: x[at], (codes, box)), cube, searched)
            for (i, u), share in zip(part, np.asarray(told), strict=True):
                if share > shares[i]:
                    shares[i], best[i] = share, u
    return best, shares


def _lattice(count: int) -> np.ndarray:
    """Points of the unit cube, (m, M); what a program does not have stays in the middle."""
    full = np.full((_POINTS[count], MOST_CONSTANTS), 0.5, np.float32)
    if count == 1:
        full[:, 0] = (np.arange(_POINTS[1]) + 0.5) / _POINTS[1]
    elif count:
        draws = scipy.stats.qmc.Halton(count, scramble=False)
        full[:, :count] = draws.random(_POINTS[count] + 1)[1:]
    return full


def _arrays(problem: Joint, pieces: Sequence[Piece], length: int) -> tuple[Codes, Box]:
    """Programs and the ranges of their constants."""
    names = [[p.name for p in one.constants] for one in pieces]
    codes = encode([one.program for one in pieces], problem.names, names, length)
    shape = (len(pieces), MOST_CONSTANTS)
    box = Box(np.ones(shape), np.full(shape, 2.0), np.zeros(shape, bool))
    for i, one in enumerate(pieces):
        for k, p in enumerate(one.constants):
            box.lower[i, k], box.upper[i, k] = p.lower, p.upper
            box.log[i, k] = p.scale == "log"
    return codes, box


def _decode(box: Box, u: jax.Array) -> jax.Array:
    ratio = jnp.where(box.log, box.upper / jnp.where(box.log, box.lower, 1.0), 1.0)
    return jnp.where(box.log, box.lower * ratio**u, box.lower + u * (box.upper - box.lower))


def _share(program: tuple[Codes, Box], u: jax.Array, searched: SearchRows) -> jax.Array:
    codes, box = program
    return share_of(run(codes, _decode(box, u), searched.variables), searched)


_shares = jax.jit(jax.vmap(_share, in_axes=(0, 0, None)))


def _cost(u: jax.Array, args) -> jax.Array:
    program, low, width, searched = args
    return -_share(program, low + width * u, searched)


@partial(jax.jit, static_argnames="steps")
def _swarms(programs, low, width, keys, searched: SearchRows, steps: int):
    """A swarm for every program, in a cube around its best point: positions (P, M), shares (P,)."""

    def one(program, low, width, key):
        args = (program, low, width, searched)
        found = minimize(_cost, de(_PARTICLES), _UNIT, key, args, num_steps=steps)
        return low + width * found.params, -found.value

    return jax.vmap(one)(programs, low, width, keys)


def _refined(
    problem: Joint, searched: SearchRows, pieces: list[Piece], points: np.ndarray, seed: int
) -> list[Trial]:
    """Programs with the constants that explain most, by differential evolution near the best point."""
    done: list[Trial] = []
    for length in LENGTHS:
        own = [i for i, one in enumerate(pieces) if length_for(len(one.program)) == length]
        if not own:
            continue
        group = [pieces[i] for i in own]
        # Filled up to a fixed number: one compiled program a length.
        most = _KEPT * len(_POINTS)
        group += [group[-1]] * (most - len(group))
        codes, box = _arrays(problem, group, length)
        center = np.stack([points[i] for i in own] + [points[own[-1]]] * (most - len(own)))
        cell = np.array([_CELL[len(one.constants)] for one in group], np.float32)[:, None]
        low = np.clip(center - cell, 0.0, 1.0 - 2.0 * cell).astype(np.float32)
        width = np.broadcast_to(2.0 * cell, low.shape).astype(np.float32)
        keys = jax.random.split(jax.random.key(seed), most)
        place, share = _swarms((codes, box), low, width, keys, searched, _STEPS)
        values = np.asarray(jax.vmap(_decode)(box, place))
        for k in range(len(own)):
            table = group[k].constants
            named = {p.name: _inside(p, float(values[k, n])) for n, p in enumerate(table)}
            done.append(Trial(group[k], named, float(share[k])))
    return done


def _inside(p, value: float) -> float:
    return float(np.clip(value, p.lower, p.upper))
