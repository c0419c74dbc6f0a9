r"""Nonlinear parameters of laws by swarms, for all laws, joints and folds through the same compiled programs.

For a candidate :math:`\nu` the law's columns c on its joint are computed along the whole log, decimated,
freed of what the model absorbs, and the linear parameters eliminated: the cost is minus the explained
sum of squares, :math:`h^T G^{-1} h` with :math:`G = c_\perp^T c_\perp`, :math:`h = c_\perp^T r`.
A coarse lattice over the cube finds the valley, which a torque ripple has one of per order, and a GPSO
swarm in its cell finds the floor. The law is chosen inside the program and lengths are rounded up, so
that neither another candidate nor a log of another length costs a compilation.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.diagnose.candidates.lattice import (
    BATCH,
    batch_of,
    lattice_of,
    ordered,
    points_of,
    seen_of,
)
from jaxswarm.diagnose.folds.fold_data import FoldData, decimating, explained, explained_of
from jaxswarm.effects import REGISTRY
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.measurement import shifted
from jaxswarm.effects.sample import Sample
from jaxswarm.effects.series import law_columns
from jaxswarm.identify.forward.columns import Load, joint_series
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.logs.motion import Motion
from jaxswarm.programs import program

_PARTICLES, _STEPS = 12, 10
# What explains less of the residual than this share on every fold is not refined: it comes to nothing.
_WORTH = 0.02
# Threads that search: beside the one that builds other candidates, and when that has finished.
_WORKERS = 2
# Lengths are rounded up to multiples of these: samples, filter taps.
_CHUNK, _TAPS = 1024, 32


class _Task(NamedTuple):
    """One law on one joint with its folds (S, ...): the law by its number among those of the program."""

    law: jax.Array | np.int32
    positive: jax.Array | np.bool_
    cell: jax.Array | np.ndarray
    series: Sample
    folds: FoldData


@partial(jax.jit, static_argnames=("laws", "factor"))
def _columns_at(
    laws: tuple[TorqueLaw, ...], factor: int, task: _Task, taps: jax.Array, u: jax.Array
):
    """Decimated columns (T', k) of the task's law at a point of the unit cube, filled up to the widest law.

    Every law decimates its own: what a switch gives is written to memory, and there before decimation it is as
    long as the log, which took half of a search.
    """
    width, low = max(len(law.linear) for law in laws), decimating(taps, factor)

    def columns_of(law, u):
        columns = low(law_columns(law, _decode(law, u), task.series))
        return jnp.pad(columns, ((0, 0), (0, width - columns.shape[1])))

    return jax.lax.switch(task.law, [partial(columns_of, law) for law in laws], u)


@program("laws", "factor", "batch")
def _survey(
    laws: tuple[TorqueLaw, ...],
    factor: int,
    batch: int,
    task: _Task,
    lattice: jax.Array,
    count,
    taps: jax.Array,
):
    """The best of a lattice's first points and what it explains, one per fold: (S, d), (S,).

    ``count`` batches are looked at, so that a fine lattice is no program of its own.
    """
    at = partial(_columns_at, laws, factor, task, taps)

    def look(k, best):
        points = jax.lax.dynamic_slice_in_dim(lattice, k * batch, batch)
        gains = explained_of(jax.vmap(at)(points), task.folds, task.positive)
        # A law may have no finite torque at a point; it must not hide the others.
        gains = jnp.where(jnp.isnan(gains), -jnp.inf, gains)

        def one_fold(gains, point, most):
            pick = jnp.argmax(gains)
            better = gains[pick] > most
            return jnp.where(better, points[pick], point), jnp.where(better, gains[pick], most)

        return jax.vmap(one_fold)(gains, *best)

    folds, kind = task.folds.residual.shape[0], task.folds.residual.dtype
    nowhere = jnp.full((folds, lattice.shape[1]), 0.5, kind), jnp.full(folds, -jnp.inf, kind)
    return jax.lax.fori_loop(0, count, look, nowhere)


@program("laws", "factor")
def _refine(
    laws: tuple[TorqueLaw, ...], factor: int, task: _Task, survey, taps: jax.Array, key: jax.Array
):
    """Best positions in the unit cube, by a swarm in the cell of a lattice's best point: (S, d)."""
    # Swarms load for a tenth of a second what nobody needs where the program is found ready on disk.
    from jaxswarm.swarm import Space, gpso, minimize

    def one_fold(fold, point, gain):
        low = jnp.clip(point - task.cell, 0.0, 1.0 - 2.0 * task.cell)

        def cost(u, fold):
            columns = _columns_at(laws, factor, task, taps, low + 2.0 * task.cell * u)
            return -explained(columns, fold, task.positive)

        unit = Space.vector(np.zeros(task.cell.shape[0]), np.ones(task.cell.shape[0]))
        swarm = minimize(cost, gpso(_PARTICLES), unit, key, fold, num_steps=_STEPS)
        return jnp.where(-swarm.value > gain, low + 2.0 * task.cell * swarm.params, point)

    return jax.vmap(one_fold)(task.folds, *survey)


@contextmanager
def searching(
    tasks: list[tuple[TorqueLaw, int, int | None]],
    motions: Sequence[Motion],
    width: Sequence[float],
    loads: Sequence[Load],
    folds: Sequence[FoldData],
    key: jax.Array,
    delay: float = 0.0,
) -> Iterator[Callable[[], list[list[dict[str, float]]]]]:
    """Search the best nonlinear parameters of laws on joints, for every fold, in the background.

    The searches run in threads of their own, two at a time: programs started by one thread wait for each
    other. One at a time they were the last that a round waited for, on one core.
    What has not begun when the context ends is given up.

    Args:
        tasks: Law, joint and partner of every search; a law with a torque and nonlinear parameters.
        motions: The logs, with equal decimators.
        width: Width of every joint's smooth sign, (n,).
        loads: Rigid torque of the current model, of every log.
        folds: Of every log, leading axes (joints of the robot, folds); rows as its decimator keeps
            them.
        key: Random key.
        delay: Time [s] by which the model's torque clock lags: a law's torque is reported as late.

    Yields:
        A function that waits for the end: values by name, for every task and every fold.
    """
    taps, factor = np.asarray(motions[0].decimator.taps), motions[0].decimator.factor
    taps = np.pad(taps, (0, -len(taps) % _TAPS))
    # One log after the other, each from a sample that is kept; rows that reach into the next are empty.
    ends = [-len(m.t) % factor for m in motions[:-1]]
    length = sum(len(m.t) for m in motions) + sum(ends)
    ends.append(_TAPS - (length + _TAPS) % -_CHUNK)
    rows = [(len(m.t) + end) // factor for m, end in zip(motions[:-1], ends, strict=False)]
    rows.append((length + ends[-1] - len(taps)) // factor + 1 - sum(rows))
    laws = _searched(law for law, _, _ in tasks)
    points = max(BATCH * -(-points_of(law) // BATCH) for law in laws)
    most = points, max(len(law.nonlinear) for law in laws)
    batch = batch_of(length + ends[-1])
    precise = jax.config.jax_enable_x64  # type: ignore[attr-defined]

    def search(law: TorqueLaw, joint: int, other: int | None) -> list[dict[str, float]]:
        parts = [
            _held(_late(joint_series(motion, width, load, joint, other), delay, motion), end)
            for motion, load, end in zip(motions, loads, ends, strict=True)
        ]
        series = jax.tree.map(lambda *x: np.concatenate(x), *parts)
        points = points_of(law)
        lattice, cell = lattice_of(len(law.nonlinear), points, most)
        low, span = seen_of(law, [m.q[:, joint] for m in motions], most[1])
        lattice, cell = low + span * lattice, span * cell
        task = _Task(
            np.int32(laws.index(law)),
            np.bool_(law.positive),
            cell,
            series,
            _of_joint(folds, joint, rows),
        )
        with jax.enable_x64(precise):  # a thread has settings of its own
            best = _survey(laws, factor, batch, task, lattice, -(-points // batch), taps)
            positions, gains = map(np.asarray, best)
            if (gains > _WORTH * (task.folds.residual**2).sum(axis=1)).any():
                positions = np.asarray(_refine(laws, factor, task, best, taps, key))
        return [{n: float(x) for n, x in _decode(law, u).items()} for u in positions]

    pool = ThreadPoolExecutor(max_workers=_WORKERS)
    try:
        found = [pool.submit(search, *task) for task in tasks]
        yield lambda: [one.result() for one in found]
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _held(series: Sample, count: int) -> Sample:
    """A series whose last sample is repeated ``count`` times."""
    return jax.tree.map(lambda x: np.pad(x, (0, count), mode="edge"), series)


def _of_joint(folds: Sequence[FoldData], joint: int, counts: Sequence[int]) -> FoldData:
    """One joint's folds of all logs, (folds, ...), each with empty rows up to its count."""

    def fill(x: np.ndarray, count: int) -> np.ndarray:
        own = x[joint]
        return np.pad(own, ((0, 0), (0, count - own.shape[1]), *((0, 0),) * (own.ndim - 2)))

    parts = [
        jax.tree.map(partial(fill, count=count), fold)
        for fold, count in zip(folds, counts, strict=True)
    ]
    return parts[0] if len(parts) == 1 else jax.tree.map(lambda *x: np.concatenate(x, 1), *parts)


def _searched(laws: Iterable[TorqueLaw]) -> tuple[TorqueLaw, ...]:
    """The laws that share compiled programs: all that are registered, and these."""
    known = {one.name: one for one in (*REGISTRY.values(), *laws)}
    laws_of = (one for one in known.values() if isinstance(one, TorqueLaw))
    return tuple(one for one in laws_of if one.searched)


def _decode(law: TorqueLaw, u) -> dict:
    """Nonlinear parameters by name at a point of the unit cube."""
    return {p.name: p.decode(u[k]) for k, p in enumerate(ordered(law))}


def _late(series: Sample[np.ndarray], seconds: float, motion: Motion) -> Sample[np.ndarray]:
    """What a law sees, so much later: its torque is then what a late clock reports of it."""
    if not seconds:
        return series
    later = (np.asarray(shifted(x, seconds, 1.0 / motion.rate)) for x in filled(series))
    return Sample(*(x[: len(motion.t)] for x in later))
