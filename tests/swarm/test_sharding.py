"""Runs and sweeps over eight forced devices equal those on one."""

import os
import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.swarm import Space, minimize_runs, minimize_sharded, pso, stalled

SCRIPT = """
import jax, numpy as np
from jaxswarm.swarm import Space, minimize_runs, minimize_sharded, pso, stalled
assert len(jax.devices()) == 8
space, keys = Space.vector([-5.0] * 2, [5.0] * 2), jax.random.split(jax.random.key(0), 16)
def sphere(x, center):
    return ((x - center) ** 2).sum(axis=1)
# The same task for all runs, then a sweep: a task for each.
for args, axes, stop in ((1.0, None, None), (1.0, None, stalled(3)), (np.arange(16.0), 0, stalled(3))):
    options = dict(num_steps=12, stop=stop, args_axes=axes)
    one = minimize_runs(sphere, pso(6), space, keys, args, **options)
    all_ = minimize_sharded(sphere, pso(6), space, keys, args, **options)
    assert len(all_.value.sharding.device_set) == 8
    for a, b in zip(jax.tree.leaves(one), jax.tree.leaves(all_), strict=True):
        np.testing.assert_array_equal(a, b)
"""


def test_eight_devices_give_the_same_result():
    environment = os.environ | {"XLA_FLAGS": "--xla_force_host_platform_device_count=8"}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


def test_one_device_and_compiled_once():
    traces = []

    def sphere(x, _):
        traces.append(1)
        return jnp.sum(x**2, axis=1)

    space, keys = Space.vector([-5.0] * 2, [5.0] * 2), jax.random.split(jax.random.key(0), 3)
    for _ in range(2):
        result = minimize_sharded(sphere, pso(6), space, keys, num_steps=5, stop=stalled(3))
        if _ == 0:
            first = len(traces)
    assert len(traces) == first
    single = minimize_runs(sphere, pso(6), space, keys, num_steps=5, stop=stalled(3))
    np.testing.assert_allclose(result.value, single.value)


def test_runs_must_divide_among_the_devices():
    keys = jax.random.split(jax.random.key(0), 3)
    with pytest.raises(InputError, match="3 runs for 2 devices"):
        space = Space.vector([0.0], [1.0])
        devices = [jax.devices()[0]] * 2
        minimize_sharded(lambda x, _: x[:, 0], pso(4), space, keys, num_steps=2, devices=devices)
