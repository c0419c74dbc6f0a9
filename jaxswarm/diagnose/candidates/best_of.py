r"""The best nonlinear parameters of a law on a joint, by a lattice and swarms in one compiled program.

For a candidate :math:`\nu` the law's columns c on its joint are computed along the whole log, decimated,
weighted, freed of what the model absorbs, and the linear parameters eliminated: the cost is minus the explained
sum of squares, :math:`h^T G^{-1} h` with :math:`G = c_\perp^T c_\perp`, :math:`h = c_\perp^T r`.
A coarse lattice over the cube finds the valley, which a torque ripple has one of per order, and a GPSO
swarm in its cell finds the floor. The law is chosen inside the program, so that another candidate costs no
compilation.
"""

from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.diagnose.folds.fold_data import FoldData, decimating, explained
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.lattice import ordered
from jaxswarm.effects.sample import Sample
from jaxswarm.effects.series import law_columns
from jaxswarm.programs import program

# Of one swarm; as many lattice points as the swarms of all folds have particles are looked at together.
PARTICLES, _STEPS = 12, 10
# What explains less of the residual than this share on every fold is not refined: it comes to nothing.
_WORTH = 0.02


class Task(NamedTuple):
    """One law on one joint with its folds (S, ...): the law by its number among those of the program."""

    law: jax.Array | np.int32
    positive: jax.Array | np.bool_
    cell: jax.Array | np.ndarray
    series: Sample
    folds: FoldData


@partial(jax.jit, static_argnames=("laws", "factor"))
def _columns_at(
    laws: tuple[TorqueLaw, ...], factor: int, task: Task, taps: jax.Array, u: jax.Array
):
    """Weighted columns (T', k) of the task's law at a point of the unit cube, filled up to the widest law.

    Every law decimates its own: what a switch gives is written to memory, and there before decimation it is as
    long as the log, which took half of a search.
    """
    width, low = max(len(law.linear) for law in laws), decimating(taps, factor)
    weight = task.folds.weight[0][:, None]

    def columns_of(law, u):
        columns = low(law_columns(law, decoded(law, u), task.series))
        return jnp.pad(columns * weight, ((0, 0), (0, width - columns.shape[1])))

    return jax.lax.switch(task.law, [partial(columns_of, law) for law in laws], u)


@program("laws", "factor", "batch")
def best_of(
    laws: tuple[TorqueLaw, ...],
    factor: int,
    batch: int,
    task: Task,
    lattice: jax.Array,
    count,
    taps: jax.Array,
    key: jax.Array,
):
    """The best point of the unit cube for every fold, and what it explains: (S, d), (S,).

    A step looks at as many points as the swarms of all folds have particles, ``batch`` at a time: ``count``
    steps at the lattice's, and where these found what is worth it, others at those of a swarm for every fold
    in the cell of its best. So laws are compiled once for both, which is most of what a program costs.
    """
    # Swarms load for a tenth of a second what nobody needs where the program is found ready on disk.
    from jaxswarm.swarm import gpso
    from jaxswarm.swarm.random import fold as fold_key

    swarm, at = gpso(PARTICLES, _STEPS), partial(_columns_at, laws, factor, task, taps)
    folds, dims, kind = len(task.folds.residual), lattice.shape[1], task.folds.residual.dtype
    worth = _WORTH * (task.folds.residual**2).sum(axis=1)

    def explain(points):
        gains = explained(jax.vmap(at)(points), task.folds, task.positive)
        # A law may have no finite torque at a point; it must not hide the others.
        return jnp.where(jnp.isnan(gains), -jnp.inf, gains)

    def placed(u, best):
        """Points of a swarm in the cell of a lattice's best."""
        return jnp.clip(best - task.cell, 0.0, 1.0 - 2.0 * task.cell) + 2.0 * task.cell * u

    def look(points, gains, best, most, swarms):
        pick = jnp.argmax(gains, axis=1)
        gain = jnp.take_along_axis(gains, pick[:, None], axis=1)[:, 0]
        better = gain > most
        best = jnp.where(better[:, None], points[pick], best)
        return best, jnp.where(better, gain, most), swarms

    def move(points, gains, best, most, swarms):
        own = jnp.diagonal(gains.reshape(folds, folds, PARTICLES)).T

        def one(state, gain):
            return swarm.update(fold_key(key, state.count), state, -gain)[0]

        return best, most, jax.vmap(one)(swarms, own)

    def step(state):
        k, best, most, swarms = state
        looked = jax.lax.dynamic_slice_in_dim(lattice, k * folds * PARTICLES, folds * PARTICLES)
        swarmed = placed(swarms.position, best[:, None]).reshape(-1, dims)
        points = jnp.where(k < count, looked, swarmed)
        gains = jax.lax.map(explain, points.reshape(-1, batch, dims))
        gains = jnp.moveaxis(gains, 1, 0).reshape(folds, -1)
        return k + 1, *jax.lax.cond(k < count, look, move, points, gains, best, most, swarms)

    def goes_on(state):
        k, _, most, _ = state
        return (k < count) | ((k < count + _STEPS) & (most > worth).any())

    begin = swarm.init(key, dims, kind)
    swarms = jax.tree.map(lambda x: jnp.broadcast_to(x, (folds, *x.shape)), begin)
    nowhere = jnp.full((folds, dims), 0.5, kind), jnp.full(folds, -jnp.inf, kind)
    _, best, most, swarms = jax.lax.while_loop(goes_on, step, (0, *nowhere, swarms))
    better = -swarms.best_value > most
    found = jnp.where(better[:, None], placed(swarms.best_position, best), best)
    return found, jnp.where(better, -swarms.best_value, most)


def decoded(law: TorqueLaw, u) -> dict:
    """Nonlinear parameters by name at a point of the unit cube."""
    return {p.name: p.decode(u[k]) for k, p in enumerate(ordered(law))}
