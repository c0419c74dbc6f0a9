r"""Nonlinear parameters of a law by swarms, on all joints and folds in one compiled program.

For a candidate :math:`\nu` the law's columns c on its joint are computed along the whole log, decimated,
freed of what the model absorbs, and the linear parameters eliminated: the cost is minus the explained
sum of squares, :math:`h^T G^{-1} h` with :math:`G = c_\perp^T c_\perp`, :math:`h = c_\perp^T r`.
A coarse lattice over the cube finds the valley, which a torque ripple has one of per order, and a GPSO
swarm in its cell finds the floor.
"""

from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.base import Law, Sample
from jaxswarm.effects.series import law_columns
from jaxswarm.identify.columns import Load, joint_series
from jaxswarm.logs.motion import Motion
from jaxswarm.swarm import Space, gpso, minimize

_PARTICLES, _STEPS = 12, 10
# Lattice points per dimension; the order of a ripple has a narrow valley.
_LATTICE = {1: 40, 2: 9, 3: 5}
_FINE = {"torque_ripple": 480}


class Stage(NamedTuple):
    """One joint on one fold, ready for a search: the rows of the joint only.

    Attributes:
        basis: Q of the joint's rows, (T', b), zero outside the training rows.
        residual: Weighted residual of those rows, (T',), zero outside the training rows.
        train: 1 on training rows, else 0, (T',).
    """

    basis: jax.Array
    residual: jax.Array
    train: jax.Array


def decimate(x: jax.Array, taps: jax.Array, factor: int) -> jax.Array:
    """Decimate columns (T, k) like :class:`jaxswarm.logs.filtering.Decimator`, shape (T', k)."""
    size = taps.shape[0]
    kept = (x.shape[0] - size) // factor + 1
    spans = -(-size // factor)
    padded = jnp.pad(x, ((0, (kept + spans) * factor - x.shape[0]), (0, 0)))
    frames = padded.reshape(kept + spans, factor, -1)
    weights = jnp.pad(taps, (0, spans * factor - size)).reshape(spans, factor)
    parts = jnp.einsum("sf,tfk->stk", weights, frames)
    return sum(parts[s, s : s + kept] for s in range(spans))


def explained(columns: jax.Array, stage: Stage, positive: bool) -> jax.Array:
    """Sum of squares that free linear parameters of the columns (T', k) take off the residual.

    ``positive`` refuses a single column whose coefficient would be negative.
    """
    columns = columns * stage.train[:, None]
    inner = stage.basis.T @ columns
    gram = columns.T @ columns - inner.T @ inner
    size = jnp.sqrt(jnp.diag(columns.T @ columns)) + 1e-300
    gram = gram / size / size[:, None] + 1e-9 * jnp.eye(columns.shape[1])
    right = (columns.T @ stage.residual) / size
    gain = right @ jnp.linalg.solve(gram, right)
    if positive and columns.shape[1] == 1:
        gain = jnp.where(right[0] > 0, gain, 0.0)
    return gain


def _lattice(law: Law) -> np.ndarray:
    """Lattice points in the unit cube, (m, d)."""
    dims = len(law.nonlinear)
    count = _FINE.get(law.name, _LATTICE[dims])
    axis = (np.arange(count) + 0.5) / count
    return np.stack(np.meshgrid(*[axis] * dims, indexing="ij"), axis=-1).reshape(-1, dims)


@partial(jax.jit, static_argnames=("law", "factor"))
def _search(law: Law, factor: int, series: Sample, stages: Stage, taps: jax.Array, key: jax.Array):
    """Positions in the unit cube (J, S, d): joints one after the other, folds together."""
    table = sorted(law.nonlinear, key=lambda p: p.name)
    lower = jnp.array([p.lower for p in table])
    upper = jnp.array([p.upper for p in table])
    log = np.array([p.scale == "log" for p in table])
    lattice = jnp.asarray(_lattice(law))
    cell = 1.0 / round(len(lattice) ** (1 / len(table)))

    def decode(u):
        linear = lower + u * (upper - lower)
        ratio = jnp.where(log, upper, 1.0) / jnp.where(log, lower, 1.0)
        x = jnp.where(log, lower * ratio**u, linear)
        return {p.name: x[k] for k, p in enumerate(table)}

    def one_joint(joint):
        series, stages = joint
        all_columns = jax.lax.map(
            lambda u: decimate(law_columns(law, decode(u), series), taps, factor),
            lattice,
            batch_size=32,
        )
        positive = all(p.lower >= 0 for p in law.linear)

        def one_fold(stage):
            gains = jax.vmap(lambda c: explained(c, stage, positive))(all_columns)
            low = jnp.clip(lattice[jnp.argmax(gains)] - cell, 0.0, 1.0 - 2.0 * cell)

            def cost(u, data):
                series, stage = data
                columns = law_columns(law, decode(low + 2.0 * cell * u), series)
                return -explained(decimate(columns, taps, factor), stage, positive)

            unit = Space.vector(np.zeros(len(table)), np.ones(len(table)))
            swarm = minimize(cost, gpso(_PARTICLES), unit, key, (series, stage), num_steps=_STEPS)
            better = -swarm.value > jnp.max(gains)
            return jnp.where(better, low + 2.0 * cell * swarm.params, lattice[jnp.argmax(gains)])

        return jax.vmap(one_fold)(stages)

    return jax.lax.map(one_joint, (series, stages))


def search_law(
    law: Law,
    motion: Motion,
    width: float,
    load: Load,
    stages: Stage,
    joints: list[tuple[int, int | None]],
    key: jax.Array,
) -> list[list[dict[str, float]]]:
    """Best nonlinear parameters of a law on several joints and folds.

    Args:
        law: A law with nonlinear parameters and a torque.
        motion: The log.
        width: Width of the smooth sign.
        load: Rigid torque of the current model.
        stages: Leading axes (joints of the robot, folds).
        joints: Joint (and partner) of every search.
        key: Random key.

    Returns:
        Values by name, for every entry of ``joints`` and every fold.
    """
    series = [joint_series(motion, width, load, j, o) for j, o in joints]
    stacked = jax.tree.map(lambda *x: jnp.stack(x), *series)
    own = jax.tree.map(lambda x: x[jnp.array([j for j, _ in joints])], stages)
    taps = jnp.asarray(motion.decimator.taps)
    position = _search(law, motion.decimator.factor, stacked, own, taps, key)
    table = sorted(law.nonlinear, key=lambda p: p.name)
    found = []
    for per_joint in np.asarray(position):
        found.append([])
        for u in per_joint:
            values = {}
            for p, x in zip(table, u, strict=True):
                if p.scale == "log":
                    values[p.name] = float(p.lower * (p.upper / p.lower) ** x)
                else:
                    values[p.name] = float(p.lower + x * (p.upper - p.lower))
            found[-1].append(values)
    return found
