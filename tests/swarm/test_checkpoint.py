"""Checkpoints: bit for bit, whole or not at all, and nothing accepted that does not fit."""

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
    pso,
    restart,
    restore,
    save,
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


def test_another_search_is_refused(tmp_path):
    options = dict(path=tmp_path / "a.npz", every=2, num_steps=4)
    minimize_resumable(sphere, pso(4), SPACE, KEY, **options)
    other = Space.vector([-5.0] * 3, [6.0] * 3)
    for optimizer, space, key, message in [
        (pso(4, inertia=0.5), SPACE, KEY, "optimizer is"),
        (pso(4), other, KEY, "space is"),
        (pso(4), SPACE, jax.random.key(4), "key is"),
    ]:
        with pytest.raises(InputError, match=message):
            minimize_resumable(sphere, optimizer, space, key, **options)


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
