"""Nonlinear parameters of laws on joints, searched in threads beside what else is computed; see ``best_of``.

Lengths are rounded up, so that a log of another length costs no compilation.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial

import jax
import numpy as np

from jaxswarm.diagnose.candidates.best_of import PARTICLES, Task, best_of, decoded
from jaxswarm.diagnose.folds.fold_data import FoldData
from jaxswarm.effects import REGISTRY
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.lattice import batch_of, lattice_of, points_of, seen_of
from jaxswarm.effects.measurement import shifted
from jaxswarm.effects.sample import Sample
from jaxswarm.identify.forward.joint_series import Load, joint_series
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.logs.motion import Motion

# Threads that search: beside the one that builds other candidates, and when that has finished.
_WORKERS = 2
# Lengths are rounded up to multiples of these: samples, filter taps.
_CHUNK, _TAPS = 1024, 32


@contextmanager
def searching(
    tasks: list[tuple[TorqueLaw, int, int | None]],
    motions: Sequence[Motion],
    width: Sequence[float],
    loads: Sequence[Load],
    folds: Sequence[FoldData],
    key: jax.Array,
    delay: float = 0.0,
) -> Iterator[Callable[[], Iterator[list[dict[str, float]]]]]:
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
        A function that gives values by name of every fold, task after task, as the searches end.
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
    at_once = folds[0].residual.shape[1] * PARTICLES
    points = max(at_once * -(-points_of(law) // at_once) for law in laws)
    most = points, max(len(law.nonlinear) for law in laws)
    batch = batch_of(length + ends[-1], at_once)
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
        task = Task(
            np.int32(laws.index(law)),
            np.bool_(law.positive),
            cell,
            series,
            _of_joint(folds, joint, rows),
        )
        with jax.enable_x64(precise):  # a thread has settings of its own
            count = -(-points // at_once)
            positions, _ = best_of(laws, factor, batch, task, lattice, count, taps, key)
        return [{n: float(x) for n, x in decoded(law, u).items()} for u in np.asarray(positions)]

    pool = ThreadPoolExecutor(max_workers=_WORKERS)
    try:
        found = [pool.submit(search, *task) for task in tasks]
        yield lambda: (one.result() for one in found)
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


def _late(series: Sample[np.ndarray], seconds: float, motion: Motion) -> Sample[np.ndarray]:
    """What a law sees, so much later: its torque is then what a late clock reports of it."""
    if not seconds:
        return series
    later = (np.asarray(shifted(x, seconds, 1.0 / motion.rate)) for x in filled(series))
    return Sample(*(x[: len(motion.t)] for x in later))
