"""A search begun in one process goes on in another, whatever the optimizer and however it ended."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import optax
import pytest

from jaxswarm.swarm import OPTIMIZERS, gpso, pso
from jaxswarm.swarm.fingerprint import fingerprint
from jaxswarm.swarm.schedules import linear

# Both processes build the same searches; the second finds the programs of the first compiled.
COMMON = """
import os, signal, sys
os.environ["XLA_FLAGS"] = "--xla_backend_optimization_level=0"
import jax, jax.numpy as jnp, numpy as np, optax
jax.config.update("jax_enable_x64", True)
jax.config.update("jax_compilation_cache_dir", sys.argv[1] + "/compiled")
jax.config.update("jax_persistent_cache_min_compile_time_secs", 0)
from jaxswarm.swarm import OPTIMIZERS, Space, elitist_learning, freeze, islands, pso, restart
from jaxswarm.swarm import resume
from jaxswarm.swarm.schedules import cosine, exponential

def sphere(x, _):
    return jnp.sum((x - 1.0) ** 2)

def falling(slope):
    return lambda count: 0.8 - slope * count

searches = {name: entry.factory(8) for name, entry in OPTIMIZERS.items()}
searches["closure"] = pso(8, inertia=falling(0.01), social=optax.cosine_decay_schedule(2.0, 9))
searches["wrapped"] = restart(
    elitist_learning(islands(pso(8, inertia=cosine(0.9, 0.4)), 2), exponential(1.0, 0.1))
)
searches["frozen"] = freeze(pso(8), [True, False], [0.5, 0.0])
space, key = Space.vector([-5.0] * 2, [5.0] * 2), jax.random.key(3)
folder = sys.argv[1]

def search(name, folder=folder):
    path = os.path.join(folder, name + ".npz")
    options = dict(num_steps=9, every=3, path=path)
    return resume.minimize_resumable(sphere, searches[name], space, key, **options)
"""

BEGIN = (
    COMMON
    + """
write, written = resume.save, []

def save_and_stop(path, result, **header):
    write(path, result, **header)
    written.append(path)
    if name == last and len(written) == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    if name != last:
        raise KeyboardInterrupt

resume.save = save_and_stop
last = list(searches)[-1]
for name in searches:
    written.clear()
    try:
        search(name)
    except KeyboardInterrupt:
        print(name, flush=True)
"""
)

GO_ON = (
    COMMON
    + """
for name in searches:
    before = int(np.load(os.path.join(folder, name + ".npz"))["[0].num_steps"])
    resumed = search(name)
    whole = search(name, sys.argv[2])
    for a, b in zip(jax.tree.leaves(resumed), jax.tree.leaves(whole), strict=True):
        assert np.asarray(a).tobytes() == np.asarray(b).tobytes(), name
    print(name, before, int(resumed.num_steps))
"""
)


def run(script, seed, *folders):
    root = str(Path(__file__).resolve().parents[2])
    environment = os.environ | {"PYTHONHASHSEED": seed, "PYTHONPATH": root}
    command = [sys.executable, "-c", script, *map(str, folders)]
    return subprocess.run(command, capture_output=True, text=True, env=environment)


def test_every_optimizer_goes_on_in_another_process(tmp_path):
    whole = tmp_path / "whole"
    whole.mkdir()
    begun = run(BEGIN, "1", tmp_path)
    assert begun.returncode == -signal.SIGKILL, begun.stderr
    done = run(GO_ON, "2", tmp_path, whole)
    assert done.returncode == 0, done.stderr
    rows = {row.split()[0]: row.split()[1:] for row in done.stdout.splitlines()}
    assert set(OPTIMIZERS) < set(rows)
    assert rows.pop("frozen") == ["6", "9"]  # the one that was killed, after two pieces
    assert all(row == ["3", "9"] for row in rows.values())


def closed(slope, power=1):
    return lambda count: 0.8 - slope * count**power


def topology(share):
    return lambda random, memory, value: share * memory


@pytest.mark.parametrize(
    "first, second",
    [
        (gpso(8, 30), gpso(8, 31)),
        (pso(8, inertia=closed(0.01)), pso(8, inertia=closed(0.02))),
        (pso(8, inertia=closed(0.01)), pso(8, inertia=closed(0.01, 2))),
        (pso(8, inertia=lambda c: 0.5), pso(8, inertia=lambda c: 0.6)),
        (
            pso(8, inertia=optax.linear_schedule(0.9, 0.4, 30)),
            pso(8, inertia=optax.linear_schedule(0.9, 0.4, 31)),
        ),
        (pso(8, topology=topology(0.5)), pso(8, topology=topology(0.6))),
        (np.arange(99.0), np.arange(99.0) + 1e-12),
        ({"a": 1, "b": 2}, {"a": 2, "b": 1}),
    ],
)
def test_what_differs_is_told_apart(first, second):
    assert fingerprint(first) == fingerprint(first)
    assert fingerprint(first) != fingerprint(second)
    assert " at 0x" not in fingerprint(first)


def test_the_order_of_a_container_does_not_matter():
    assert fingerprint({"a": 1, "b": {3, 1}}) == fingerprint({"b": {1, 3}, "a": 1})
    assert fingerprint(linear(1, 0, 5)) == fingerprint(linear(1.0, 0.0, 5.0))


def test_parts_that_hold_each_other_have_an_end():
    def one():
        return other

    def other():
        return one

    assert "..." in fingerprint(one)
