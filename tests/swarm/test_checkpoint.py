"""Checkpoints: bit for bit, whole or not at all, and nothing accepted that does not fit."""

import importlib
import os
import signal
import subprocess
import sys
import time

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.swarm import (
    Space,
    aelspso,
    gpso,
    minimize,
    minimize_resumable,
    minimize_runs,
    pso,
    restart,
    restore,
    save,
    stalled,
    target,
)

KEY = jax.random.key(3)
SPACE = Space.vector([-5.0] * 3, [5.0] * 3)


def sphere(x, _):
    return jnp.sum(x**2)


def same(a, b):
    pairs = zip(jax.tree.leaves(a), jax.tree.leaves(b), strict=True)
    return all(np.array_equal(x, y, equal_nan=True) for x, y in pairs)


@pytest.mark.parametrize("optimizer", [gpso(8, 30), restart(aelspso(6, 30), patience=4)])
def test_interrupted_equals_uninterrupted(tmp_path, optimizer):
    path = tmp_path / "search.npz"
    whole = minimize(sphere, optimizer, SPACE, KEY, num_steps=25)
    options = dict(path=path, every=10)
    minimize_resumable(sphere, optimizer, SPACE, KEY, num_steps=13, **options)
    resumed = minimize_resumable(sphere, optimizer, SPACE, KEY, num_steps=25, **options)
    assert same(whole, resumed)
    modified = path.stat().st_mtime_ns
    again = minimize_resumable(sphere, optimizer, SPACE, KEY, num_steps=25, **options)
    assert same(whole, again) and path.stat().st_mtime_ns == modified


def test_state_survives_the_round_trip(tmp_path):
    optimizer = aelspso(6, adapt_coefficients=True)
    state = optimizer.init(KEY, 3)
    state, _ = optimizer.update(KEY, state, jnp.arange(7.0).at[3].set(jnp.nan))
    save(tmp_path / "state.npz", state, note="x")
    like = jax.eval_shape(lambda: optimizer.init(KEY, 3))
    loaded = restore(tmp_path / "state.npz", like, note="x")
    assert same(state, loaded)
    assert jax.tree.structure(loaded) == jax.tree.structure(state)


def test_what_does_not_fit_is_refused(tmp_path):
    path = tmp_path / "state.npz"
    save(path, pso(6).init(KEY, 3))
    for like, message in [
        (pso(7).init(KEY, 3), r"position has shape \(6, 3\)"),
        (aelspso(6).init(KEY, 3), "is missing|not expected"),
        (pso(6).init(KEY, 3, dtype=jnp.float32), "dtype float64, expected"),
    ]:
        with pytest.raises(InputError, match=message):
            restore(path, like)
    with pytest.raises(InputError, match="note is None, expected 'y'"):
        restore(path, pso(6).init(KEY, 3), note="y")
    whole = path.read_bytes()
    for content in (b"", b"no archive", whole[: len(whole) // 2]):
        path.write_bytes(content)
        with pytest.raises(InputError, match="no checkpoint"):
            restore(path, pso(6).init(KEY, 3))


def rosenbrock(x, _):
    return jnp.sum(100.0 * (x[1:] - x[:-1] ** 2) ** 2 + (1.0 - x[:-1]) ** 2)


def test_another_search_is_refused(tmp_path):
    space = Space.vector([1.0] * 3, [5.0] * 3)
    given = dict(fn=sphere, optimizer=pso(4), space=space, key=KEY, args=None)
    options = dict(path=tmp_path / "a.npz", every=2, num_steps=4)
    minimize_resumable(**given, **options)

    def shifted(x, _):
        return sphere(x, _) + 1e-6

    shifted.__qualname__ = "sphere"
    for change, message in [
        (dict(optimizer=pso(4, inertia=0.5)), "optimizer is"),
        (dict(space=Space.vector([1.0] * 3, [6.0] * 3)), "space is"),
        (dict(space=Space.vector([1.0] * 3, [5.0] * 3, scale="log")), "scales is"),
        (dict(key=jax.random.key(4)), "key is"),
        (dict(fn=rosenbrock), "objective is"),
        (dict(fn=shifted), "objective is"),
        (dict(stop=target(0.5)), "stop is"),
        (dict(start=jnp.full(3, 2.0)), "start is"),
    ]:
        with pytest.raises(InputError, match=message):
            minimize_resumable(**(given | change), **options)


@pytest.mark.parametrize("stop", [stalled(4, tolerance=0.1), target(1e-3)])
def test_a_stop_rule_goes_on_where_it_was(tmp_path, stop):
    options = dict(num_steps=40, stop=stop)
    whole = minimize(sphere, pso(8), SPACE, KEY, **options)
    assert 5 < int(whole.num_steps) < 40  # within a piece that is not the first
    for _ in range(2):  # the second call finds a search that has ended
        path = tmp_path / "a.npz"
        resumed = minimize_resumable(sphere, pso(8), SPACE, KEY, path=path, every=5, **options)
        assert same(whole, resumed)


def test_many_runs_go_on_with_a_stop_rule(tmp_path):
    keys, centers = jax.random.split(KEY, 3), jnp.array([0.0, 1.0, 4.5])

    def near(x, center):
        return jnp.sum((x - center) ** 2)

    options = dict(num_steps=20, stop=target(0.5), args_axes=0, vectorized=False)
    whole = minimize_runs(near, gpso(8), SPACE, keys, centers, **options)
    assert len(set(np.asarray(whole.num_steps).tolist())) > 1
    path = tmp_path / "a.npz"
    steps = dict(path=path, every=3)
    broken = []

    def fail(*args, **kwargs):
        save(*args, **kwargs)
        broken.append(1)
        if len(broken) == 2:
            raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(importlib.import_module("jaxswarm.swarm.resume"), "save", fail)
        minimize_resumable(near, gpso(8), SPACE, keys, centers, **options, **steps)
    resumed = minimize_resumable(near, gpso(8), SPACE, keys, centers, **options, **steps)
    assert same(whole, resumed)


WRITER = """
import sys, numpy as np
from jaxswarm.swarm import save
step = 0
while True:
    step += 1
    save(sys.argv[1], {"a": np.full(400_000, step), "b": np.full(400_000, -step)})
    print(step, flush=True)
"""


def test_kill_in_the_middle_of_a_write(tmp_path):
    """A process that only writes is killed at odd moments; the file is always whole."""
    path = tmp_path / "state.npz"
    like = {name: jax.ShapeDtypeStruct((400_000,), jnp.int64) for name in "ab"}
    for delay in (0.0, 0.003, 0.011):
        command = [sys.executable, "-c", WRITER, str(path)]
        writer = subprocess.Popen(command, stdout=subprocess.PIPE, env=dict(os.environ))
        writer.stdout.readline()  # the first checkpoint is there
        time.sleep(delay)
        writer.send_signal(signal.SIGKILL)
        writer.wait()
        writer.stdout.close()
        loaded = restore(path, like)
        step = int(loaded["a"][0])
        assert step >= 1
        assert bool((loaded["a"] == step).all()) and bool((loaded["b"] == -step).all())


def test_damaged_checkpoints_are_refused_or_read_whole(tmp_path):
    path, rng = tmp_path / "state.npz", np.random.default_rng(0)
    tree = {"x": np.arange(4.0)}
    save(path, tree)
    good = path.read_bytes()
    for _ in range(300):
        data = bytearray(good)
        for place in rng.integers(0, len(data), rng.integers(1, 4)):
            data[place] = rng.integers(256)
        path.write_bytes(
            bytes(data[: rng.integers(1, len(data) + 1)] if rng.random() < 0.3 else data)
        )
        try:
            assert restore(path, tree)["x"].shape == (4,)
        except InputError as error:
            assert str(path) in str(error)


def test_unfinished_checkpoints_of_dead_processes_are_removed(tmp_path):
    code = (
        "import os, sys; import numpy as np; from jaxswarm.swarm import save\n"
        "np.savez = lambda *a, **k: os._exit(9)\n"
        "save(sys.argv[1], {'x': np.zeros(3)})"
    )
    path = tmp_path / "state.npz"
    ended = subprocess.run([sys.executable, "-c", code, str(path)], check=False)
    assert ended.returncode == 9
    (orphan,) = tmp_path.iterdir()
    foreign = tmp_path / ".state.npz.another.machine-1.part"
    foreign.write_text("")
    save(path, {"x": np.zeros(3)})
    assert {p.name for p in tmp_path.iterdir()} == {"state.npz", foreign.name} and orphan.suffix
