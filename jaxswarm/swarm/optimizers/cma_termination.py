r"""When a CMA-ES has nothing more to find: the criteria of the tutorial's appendix B.3, and a plateau.

    tol_x          standard deviations of all coordinates and sigma p_c below tol_x sigma_0
    tol_fun        the best values of the last 10 + ceil(30 d / n) generations are all equal, or they
                   and all values of the present one lie within tol_fun
    stagnation     of the best and of the median values of the last 20 % of all generations, at least
                   120 + 30 d / n, neither has a better median in the latest than in the first 30 %
    condition      largest over smallest eigenvalue of C above 1e14 (1 / (2 eps) if that is less)
    no effect      0.1 standard deviations along an axis, or 0.2 along a coordinate, are lost in the
                   rounding of the mean
    diverged       the longest axis has grown 1e4 times
    plateau        the best candidate is no better than the one at three quarters of the generation, twice
                   in a row (as in pycma)

On steps, such as BBOB's f7, ranks among equal values are chance: sigma and C walk at random, and values
differ now and then, so that the criteria of equal values took most of the evaluations of a life.

The first that holds is kept. The search may go on: ``restart`` begins anew, a stop rule ends it.
Histories have a fixed length. Of a search longer than five times the shortest window only one in
some generations is entered, so that they reach back over about 20 % of it.

Reference:
    N. Hansen, "The CMA evolution strategy: a tutorial", 2016, arXiv 1604.00772, B.3.
"""

import math
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.swarm.optimizers.cma_distribution import Distribution, deviations
from jaxswarm.swarm.optimizers.counting import place

__all__ = ["REASONS", "Watch", "unwatched", "watch"]

REASONS = (
    "searching",
    "the distribution is as small as tol_x",
    "values differ by less than tol_fun",
    "best and median values stagnate",
    "condition number of the covariance too high",
    "a step along an axis is lost in rounding",
    "a step along a coordinate is lost in rounding",
    "the distribution has grown without bound",
    "most values of a generation are equal",
)
"""Text of each code of :class:`Watch`."""

CONDITION = 1e14
GROWTH = 1e4
EQUAL_SHARE, EQUAL_TIMES = 0.75, 2
"""Of a generation, and generations in a row: as many are equal by chance on steps that can be walked."""
SHARE = 0.3
"""First and latest part of a history that are compared."""
LOOK = 8
"""Entries between two looks for stagnation, which takes as long as all other criteria together."""
WINDOW_OF = 5
"""A window is a fifth of all generations."""


class Watch(NamedTuple):
    """What the criteria look back on, and the first that held.

    Attributes:
      recent_value: (r,) best values of the last generations, in a ring.
      best_value, median_value: (w,) of entered generations, in a ring.
      entered: () int32, entries made.
      equal: () int32, latest generations in a row most of whose values were equal.
      code: () int32, index into ``REASONS``, 0 as long as none holds.
    """

    recent_value: jax.Array
    best_value: jax.Array
    median_value: jax.Array
    entered: jax.Array
    equal: jax.Array
    code: jax.Array


def unwatched(n: int, d: int, dtype: Any) -> Watch:
    """Return empty histories for populations of n or more."""
    window = 120 + math.ceil(30 * d / n)
    zero = jnp.zeros((), jnp.int32)
    blank = jnp.full((window,), jnp.inf, dtype)
    recent = jnp.full((10 + math.ceil(30 * d / n),), jnp.inf, dtype)
    return Watch(recent, blank, blank, entered=zero, equal=zero, code=zero)


def watch(
    old: Watch, now: Distribution, value: jax.Array, n: Any, sigma: Any, tol_x: Any, tol_fun: Any
) -> Watch:
    """Enter a generation and ask every criterion.

    Args:
      old: histories before it.
      now: the distribution after its update.
      value: (rows,) values in rising order, of which the first n count.
      n: candidates of a generation, possibly traced.
      sigma: first step size.
      tol_x, tol_fun: see the head of this file.
    """
    generation = now.generation
    best, median, worst = value[0], value[n // 2], value[n - 1]
    recent = _put(old.recent_value, _rem(generation - 1, old.recent_value.size), best)
    window = old.best_value.size
    every = jnp.maximum(1, jax.lax.div(generation, jnp.int32(WINDOW_OF * window)))
    due = _rem(generation, every) == 0
    at = jnp.where(due, _rem(old.entered, window), window)
    bests, medians = _put(old.best_value, at, best), _put(old.median_value, at, median)
    entered = old.entered + due.astype(jnp.int32)

    highest, lowest = recent.max(), recent.min()
    flat = (highest == lowest) | (jnp.maximum(highest, worst) - lowest <= tol_fun)
    look = due & (entered >= window) & (_rem(entered, LOOK) == 0)
    # No slope passes: what comes out is true or false, and mapped by hand it has none to give.
    stale = _stale(look, *jax.lax.stop_gradient((jnp.stack([bests, medians]), entered)))
    level = (EQUAL_SHARE * jnp.asarray(n, best.dtype)).astype(jnp.int32)
    equal = jnp.where(value[level] == best, old.equal + 1, 0)
    held = (
        _small(now, tol_x * sigma),
        flat & (generation >= recent.size),
        stale,
        _ill(now),
        _lost_axis(now),
        jnp.any(now.mean == now.mean + 0.2 * deviations(now)),
        now.sigma * now.spread[-1] > GROWTH * sigma,
        equal >= EQUAL_TIMES,
    )
    code = jnp.int32(0)
    for number, holds in reversed(list(enumerate(held, 1))):
        code = jnp.where(holds, jnp.int32(number), code)
    return Watch(recent, bests, medians, entered, equal, jnp.where(old.code > 0, old.code, code))


def _rem(count, size):
    """What ``%`` gives of counts, which are never negative, in one operation and not in five."""
    return jax.lax.rem(count, jnp.asarray(size, count.dtype))


def _put(ring, at, value):
    """The ring with a value at a place; none where there is no such place.

    As one pass: a scatter is a loop of its own on a CPU, over all runs where there are many.
    """
    return jnp.where(jnp.arange(ring.size, dtype=jnp.int32) == at, value, ring)


def _small(now, limit):
    path = now.sigma * jnp.abs(now.path_covariance)
    return jnp.all((deviations(now) < limit) & (path < limit))


def _ill(now):
    limit = jnp.minimum(CONDITION, 0.5 / jnp.finfo(now.spread.dtype).eps)
    return (now.spread[-1] / now.spread[0]) ** 2 > limit


def _lost_axis(now):
    axis = _rem(now.generation, now.mean.size)
    step = 0.1 * now.sigma * now.spread[axis] * now.basis[:, axis]
    return jnp.all(now.mean == now.mean + step)


@jax.custom_batching.custom_vmap
def _stale(look, history, entered):
    return jax.lax.cond(look, lambda: _no_better(history, entered), lambda: jnp.asarray(False))


@_stale.def_vmap
def _stale_of_runs(num, mapped, look, history, entered):
    """Runs side by side look when one of them does: most are equally old, and all look together.

    A branch that is mapped is taken by every run in every generation.
    """
    given = [
        part if own else jnp.broadcast_to(part, (num, *part.shape))
        for part, own in zip((look, history, entered), mapped, strict=True)
    ]
    look, history, entered = given
    stale = lambda: look & jax.vmap(_no_better)(history, entered)  # noqa: E731
    return jax.lax.cond(look.any(), stale, lambda: jnp.zeros((num,), bool)), True


def _no_better(history, entered):
    """Whether the latest share of both histories (2, w) has no lower median than the first."""
    window = history.shape[1]
    count = int(SHARE * window)
    oldest = jnp.arange(count, dtype=jnp.int32)
    rows = jnp.stack([oldest, window - 1 - oldest]) + entered
    values = history[:, _rem(rows, window)]
    # Ordered by counting: with a sort in its place an update of 50 x 13 took 5 to 8 % longer.
    middle = jax.vmap(jax.vmap(place))(values) == count // 2
    first, latest = jnp.sum(jnp.where(middle, values, 0.0), axis=-1).T
    return jnp.all(latest >= first)
