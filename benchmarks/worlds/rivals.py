"""Other methods on the same worlds: sparse choice from a library, and black boxes on the residual.

All start from the plain weighted least squares of the declared model with its best filter; those that choose
refit the declared model together with what they chose. The Gaussian process and the boosted trees learn
the residual of each joint from positions, velocities and accelerations, and name nothing.
"""

import time
import warnings

import numpy as np
from sklearn.ensemble import HistGradientBoostingRegressor
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

from benchmarks.worlds import plain
from benchmarks.worlds.choosers import CHOOSERS, blocks
from benchmarks.worlds.files import TESTS, label, world_truth
from benchmarks.worlds.library import library
from benchmarks.worlds.rigid import Absorber, rms
from benchmarks.worlds.score import COPIED, HARM, labels_of
from benchmarks.worlds.world import World

_GP_ROWS = 400


def score_rivals(world: World) -> dict:
    """One row: what each rival names, and its error on unseen motion."""
    truth = world_truth(world)
    row = {key: truth[key] for key in COPIED} | {"world": world.number}
    row |= {key: labels_of(truth[key]) for key in ("effects", "outside", "inseparable")}
    logs = {name: world.log(name, run) for name, run in world.runs.items()}
    floor = plain.oracle_error(world, logs)
    noise = plain.band_noise(world)
    cutoff = plain.best_cutoff(world, *logs["train"], known=False)
    ready = {name: plain.prepare(world, *log, cutoff) for name, log in logs.items()}
    base = plain.Plain(world, ready["train"])
    clean = {}
    for name in TESTS:  # on the clock of the fits, which know the lag of the torque channel
        log, hidden = logs[name]
        quiet = {**log, "tau": hidden["tau_clean"]}
        clean[name] = plain.prepare(world, quiet, hidden, cutoff).tau

    def errors(torques: dict) -> dict:
        return {name: _error(world, torques[name] - clean[name]) for name in TESTS}

    declared = errors({name: base.raw(ready[name]) @ base.values for name in TESTS})
    row["floor"] = {k: np.maximum(floor[k], noise).tolist() for k in TESTS}
    row["declared_error"] = {k: v.tolist() for k, v in declared.items()}
    row["rivals"] = {}
    for name, torques, named, seconds in (*_sparse(world, base, ready), *_black(base, ready)):
        found = errors(torques)
        row["rivals"][name] = {
            "named": named,
            "error": {k: v.tolist() for k, v in found.items()},
            "harm": any((found[k] > np.maximum(HARM * declared[k], noise)).any() for k in TESTS),
            "seconds": seconds,
        }
    row["there"] = [label(e) for e in world.effects]
    return row


def _error(world: World, rest: np.ndarray) -> np.ndarray:
    """RMS per joint below the band, without the ends."""
    rate = world.logging.rate
    return rms(plain.inner(plain.low_pass(rest, rate, plain.BAND), rate))


def _sparse(world: World, base: plain.Plain, ready: dict):
    """Each chooser: name, torque on the tests, labels, seconds."""
    arm, rate = world.arm, base.rate
    labels, raw = library(arm, base, ready["train"])
    columns = plain.band_columns(raw, rate)
    del raw
    rows, n, count = columns.shape
    left = np.stack([base.absorber.left(columns[:, :, k]) for k in range(count)], axis=2)
    x = (left / base.noise[:, None]).reshape(rows * n, count)
    norms = np.linalg.norm(x, axis=0)
    whole = np.linalg.norm((columns / base.noise[:, None]).reshape(rows * n, count), axis=0)
    free = np.flatnonzero(norms > 1e-3 * np.maximum(whole, 1e-12))
    x = x[:, free] / norms[free]
    y = (base.left / base.noise).ravel()
    fold = np.repeat(blocks(rows), n)
    tests = {name: library(arm, base, ready[name])[1] for name in TESTS}
    for name, choose in CHOOSERS.items():
        start = time.perf_counter()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)
            kept = free[choose(x, y, fold)] if len(free) else free
        both = np.concatenate([base.columns, columns[:, :, kept]], axis=2)
        values = Absorber(both, base.noise).fit(base.target)
        p = base.columns.shape[2]
        torques = {
            k: base.raw(ready[k]) @ values[:p] + tests[k][:, :, kept] @ values[p:] for k in TESTS
        }
        named = sorted({labels[k] for k in kept})
        yield name, torques, named, time.perf_counter() - start


def _black(base: plain.Plain, ready: dict):
    """Regression of the residual on the state: name, torque on the tests, no labels, seconds."""
    train = ready["train"]
    states = plain.band_columns(_states(train), base.rate)[:, 0]
    mean, spread = states.mean(axis=0), states.std(axis=0) + 1e-9
    rng = np.random.default_rng(0)
    few = rng.permutation(len(states))[:_GP_ROWS]
    makers = {
        "Gaussian process": (_process, few),
        "boosted trees": (lambda size: HistGradientBoostingRegressor(max_iter=200), slice(None)),
    }
    for name, (make, rows) in makers.items():
        start = time.perf_counter()
        torques = {k: base.raw(ready[k]) @ base.values for k in TESTS}
        for j in range(base.arm.size):
            model = make(states.shape[1])
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", ConvergenceWarning)
                scale = base.left[:, j].std() + 1e-12
                model.fit(((states - mean) / spread)[rows], base.left[rows, j] / scale)
            for k in TESTS:
                inputs = (_states(ready[k])[:, 0] - mean) / spread
                torques[k][:, j] += scale * model.predict(inputs)
        yield name, torques, [], time.perf_counter() - start


def _states(log: plain.Prepared) -> np.ndarray:
    """Position, velocity and acceleration of all joints, (T, 1, 3 n)."""
    return np.concatenate([log.q, log.dq, log.ddq], axis=1)[:, None, :]


def _process(size: int) -> GaussianProcessRegressor:
    kernel = ConstantKernel(1.0) * RBF(3.0, (0.1, 100.0)) + WhiteKernel(0.5)
    return GaussianProcessRegressor(kernel, random_state=0)
