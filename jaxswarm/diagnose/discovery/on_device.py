"""Programs scored as fixed-length code under ``vmap``: thousands at once, as an accelerator wants them."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.diagnose.discovery.grammar import MOST_CONSTANTS
from jaxswarm.diagnose.discovery.machine import LENGTHS, Codes, encode, length_for, run
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import SearchRows, share_of

# Programs evaluated at once: memory of some tens of megabytes.
_LANES = 1024
# Members and steps of the swarm of one program.
PARTICLES, STEPS = 12, 30


class Box(NamedTuple):
    """Ranges of constants as arrays (..., M): how the unit cube is decoded."""

    lower: np.ndarray
    upper: np.ndarray
    log: np.ndarray


def survey(
    names: Sequence[str],
    searched: SearchRows,
    pieces: Sequence[Piece],
    lattices: Mapping[int, np.ndarray],
) -> tuple[np.ndarray, np.ndarray]:
    """Best point of every program in the unit cube (P, M), and its share (P,).

    Args:
        names: Of the variables.
        searched: The rows.
        pieces: The programs.
        lattices: Points (m, M) at which one is looked at, by the number of its constants.
    """
    best = np.full((len(pieces), MOST_CONSTANTS), 0.5, np.float32)
    shares = np.zeros(len(pieces))
    for length in LENGTHS:
        own = [i for i, one in enumerate(pieces) if length_for(len(one.program)) == length]
        lanes = [(i, u) for i in own for u in lattices[len(pieces[i].constants)]]
        if not lanes:
            continue
        codes, box = _arrays(names, [pieces[i] for i in own], length)
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


def _arrays(names: Sequence[str], pieces: Sequence[Piece], length: int) -> tuple[Codes, Box]:
    """Programs and the ranges of their constants."""
    constants = [[p.name for p in one.constants] for one in pieces]
    codes = encode([one.program for one in pieces], names, constants, length)
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
    return share_of(run(codes, _decode(box, u), jnp.asarray(searched.variables)), searched)


_shares = jax.jit(jax.vmap(_share, in_axes=(0, 0, None)))


def _cost(u: jax.Array, args) -> jax.Array:
    program, low, width, searched = args
    return -_share(program, low + width * u, searched)


@partial(jax.jit, static_argnames="steps")
def _swarms(programs, low, width, keys, searched: SearchRows, steps: int):
    """A swarm for every program, in a cube around its best point: positions (P, M), shares (P,)."""
    from jaxswarm.swarm import Space, de, minimize  # a diagnosis without --discover needs no swarm

    unit = Space.vector(*np.outer([0.0, 1.0], np.ones(MOST_CONSTANTS)).astype(np.float32))

    def one(program, low, width, key):
        args = (program, low, width, searched)
        found = minimize(_cost, de(PARTICLES), unit, key, args, num_steps=steps)
        return low + width * found.params, -found.value

    return jax.vmap(one)(programs, low, width, keys)


def refined(
    names: Sequence[str],
    searched: SearchRows,
    pieces: Sequence[Piece],
    low: np.ndarray,
    width: np.ndarray,
    seed: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Points (P, M) in cubes of the unit cube at which programs explain most, and their shares (P,).

    Args:
        names: Of the variables.
        searched: The rows.
        pieces: The programs.
        low, width: Corner (P, M) and width (P, M) of every program's cube.
        seed: Of the swarms, by differential evolution.
    """
    codes, box = _arrays(names, pieces, LENGTHS[-1])
    keys = jax.random.split(jax.random.key(seed), len(pieces))
    place, share = _swarms((codes, box), low, width, keys, searched, STEPS)
    return np.asarray(place), np.asarray(share)
