"""A search has the same bytes whether products of matrices have one thread or more."""

import json
import os
import subprocess
import sys

import pytest

_SEARCH = """
import json, jax
jax.config.update("jax_enable_x64", True)
from jaxswarm.swarm import Space, aelspso, cma_es, minimize
space = Space.vector([-5.0] * 8, [5.0] * 8)
cost = lambda x, args: (x**2 - 10 * jax.numpy.cos(2 * jax.numpy.pi * x)).sum()
runs = (minimize(cost, o, space, jax.random.key(1), num_steps=30) for o in (cma_es(), aelspso(12)))
print(json.dumps([[x.hex() for x in run.params.tolist()] for run in runs]))
"""


@pytest.mark.skipif(
    (os.cpu_count() or 1) < 2, reason="with one core there is no other number of threads"
)
def test_a_search_has_the_same_bytes_with_one_thread():
    def found(flags: str) -> list[list[str]]:
        surroundings = {**os.environ, "XLA_FLAGS": flags}
        words = [sys.executable, "-c", _SEARCH]
        done = subprocess.run(words, env=surroundings, capture_output=True, text=True, check=True)
        return json.loads(done.stdout)

    assert found("") == found("--xla_cpu_multi_thread_eigen=false")
