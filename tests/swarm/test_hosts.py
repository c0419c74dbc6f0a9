"""Processes on loopback share out the runs of one search; one that is lost ends the others by name."""

import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

SCRIPT = """
import sys
import jax, numpy as np
jax.config.update("jax_cpu_collectives_implementation", "gloo")
number, count = map(int, sys.argv[2:4])
jax.distributed.initialize("127.0.0.1:" + sys.argv[1], num_processes=count, process_id=number)
from jaxswarm.swarm import Space, around, minimize_runs, minimize_sharded, pso, stalled
assert len(jax.devices()) == count and len(jax.local_devices()) == 1
make = jax.random.key if sys.argv[4] == "typed" else jax.random.PRNGKey
space, keys = Space.vector([-5.0] * 2, [5.0] * 2), jax.random.split(make(0), 4)
centers = np.arange(4.0)
def sphere(x, center):
    return ((x - center) ** 2).sum()
shared = dict(num_steps=12, stop=stalled(3, tolerance=1e6), vectorized=False, args_axes=0)
shared["start"] = around(np.array([1.0, 1.0]), 0.1)
spread = minimize_sharded(sphere, pso(6), space, keys, centers, **shared)
assert not spread.value.is_fully_addressable
mine = [(s.index[0].start, np.asarray(s.data)) for s in spread.value.addressable_shards]
with jax.default_device(jax.local_devices()[0]):
    alone = minimize_runs(sphere, pso(6), space, keys, centers, **shared)
for first, values in mine:
    np.testing.assert_allclose(values, alone.value[first : first + len(values)], rtol=1e-6)
assert spread.status.message == ["best value stalled"] * (4 // count), spread.status.message
assert f"{4 // count} run" in repr(spread) and spread.check() is spread
"""


# What a host has done is kept by itself: the runs of a lost one are not those of the others.
LOST = """
import sys, time
import jax, numpy as np
number, folder = int(sys.argv[2]), sys.argv[3]
if sys.argv[1] != "alone":
    jax.distributed.initialize(
        "127.0.0.1:" + sys.argv[1], num_processes=2, process_id=number, heartbeat_timeout_seconds=10
    )
from jaxswarm.swarm import Space, minimize_runs, pso, resume
space, keys = Space.vector([-5.0] * 2, [5.0] * 2), jax.random.split(jax.random.key(0), 4)
mine = keys[2 * number : 2 * number + 2]
def sphere(x, _):
    return ((x - 1.0) ** 2).sum()
write = resume.save
def save(path, *tree, **header):
    write(path, *tree, **header)
    if sys.argv[1] != "alone" and header["steps"] == 8:
        print("half", flush=True)
        time.sleep(300)  # a long search: the test ends it
if __name__ == "__main__":
    resume.save = save
    options = dict(num_steps=16, vectorized=False)
    path = f"{folder}/{number}.npz"
    with jax.default_device(jax.local_devices()[0]):
        done = resume.minimize_resumable(sphere, pso(6), space, mine, path=path, every=4, **options)
        whole = minimize_runs(sphere, pso(6), space, mine, **options)
    np.testing.assert_array_equal(done.value, whole.value)
"""


def port() -> str:
    """A free one of this machine."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return str(free.getsockname()[1])


def begun(script: str, *words: str) -> subprocess.Popen:
    """A process of this script."""
    root = str(Path(__file__).resolve().parents[2])
    return subprocess.Popen(
        [sys.executable, "-c", script, *words],
        env=os.environ | {"PYTHONPATH": root, "JAX_PLATFORMS": "cpu"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


@pytest.mark.parametrize(("kind", "count"), [("typed", 2), ("raw", 2), ("typed", 4)])
def test_processes_with_keys_of_either_kind(kind, count):
    place = port()
    every = [begun(SCRIPT, place, str(number), str(count), kind) for number in range(count)]
    try:
        ends = [process.communicate(timeout=240)[0] for process in every]
    finally:
        for process in every:
            process.kill()
    assert [process.returncode for process in every] == [0] * count, "\n".join(ends)[-3000:]


def test_a_lost_process_ends_the_others_by_its_name_and_all_go_on_from_their_checkpoints(tmp_path):
    place = port()
    both = [begun(LOST, place, str(number), str(tmp_path)) for number in range(2)]
    try:
        for process in both:
            lines = iter(process.stdout.readline, "")
            assert any(line == "half\n" for line in lines), "ended before its checkpoint"
        both[1].send_signal(signal.SIGKILL)
        lost = time.monotonic()
        told = both[0].communicate(timeout=60)[0]
    finally:
        for process in both:
            process.kill()
    assert both[0].returncode != 0 and time.monotonic() - lost < 60
    # Its number, or its name, as the version of JAX has it.
    assert re.search(r"heartbeats?\)?:?\s+1\b|task:1\b", told), told[-3000:]
    again = [begun(LOST, "alone", str(number), str(tmp_path)) for number in range(2)]
    ends = [process.communicate(timeout=240)[0] for process in again]
    assert [process.returncode for process in again] == [0, 0], "\n".join(ends)[-3000:]
