"""Two processes on loopback share out the runs of one search."""

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import sys
import jax, numpy as np
jax.config.update("jax_cpu_collectives_implementation", "gloo")
jax.distributed.initialize("127.0.0.1:" + sys.argv[1], num_processes=2, process_id=int(sys.argv[2]))
from jaxswarm.swarm import Space, around, minimize_runs, minimize_sharded, pso, stalled
assert len(jax.devices()) == 2 and len(jax.local_devices()) == 1
make = jax.random.key if sys.argv[3] == "typed" else jax.random.PRNGKey
space, keys = Space.vector([-5.0] * 2, [5.0] * 2), jax.random.split(make(0), 4)
centers = np.arange(4.0)
def sphere(x, center):
    return ((x - center) ** 2).sum()
shared = dict(num_steps=12, stop=stalled(3), vectorized=False, args_axes=0)
shared["start"] = around(np.array([1.0, 1.0]), 0.1)
spread = minimize_sharded(sphere, pso(6), space, keys, centers, **shared)
assert not spread.value.is_fully_addressable
mine = [(s.index[0].start, np.asarray(s.data)) for s in spread.value.addressable_shards]
with jax.default_device(jax.local_devices()[0]):
    alone = minimize_runs(sphere, pso(6), space, keys, centers, **shared)
for first, values in mine:
    np.testing.assert_allclose(values, alone.value[first : first + len(values)], rtol=1e-6)
assert spread.status.message == ["best value stalled"] * 2, spread.status.message
assert "2 runs" in repr(spread) and spread.check() is spread
"""


@pytest.mark.parametrize("kind", ["typed", "raw"])
def test_two_processes_with_keys_of_either_kind(kind):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    root = str(Path(__file__).resolve().parents[2])
    environment = os.environ | {"PYTHONPATH": root, "JAX_PLATFORMS": "cpu"}
    command = [sys.executable, "-c", SCRIPT, port]
    both = [
        subprocess.Popen(
            [*command, str(number), kind],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        for number in range(2)
    ]
    try:
        ends = [process.communicate(timeout=240)[0] for process in both]
    finally:
        for process in both:
            process.kill()
    assert [process.returncode for process in both] == [0, 0], "\n".join(ends)[-3000:]
