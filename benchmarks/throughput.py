"""How long one update takes, beside the peers, measured in turns within one run.

    python -m benchmarks.throughput [--fast]

For population x dimensions x runs, in float32 and float64: one update and one evaluation of the sphere
(the same for all), with the hash, with ``jax.random``, with random numbers switched off, in evosax, in
pyswarms and, where it is installed, in pagmo. Compile time is that of the first call.
"""

import argparse
import json
import os
import subprocess
import sys

NEEDS = ("evosax", "pyswarms")
TAKES = "5 to 10 minutes; --fast 1 minute"
SIZES = ((50, 13, 1), (50, 13, 10), (50, 13, 1000), (1000, 13, 1), (10000, 50, 1))
TARGETS = (
    "50x13x1000: at least 2 times evosax, at most 1.25 times the update without random numbers; "
    "50x13x1: at least 2.5 times evosax and 25 times pyswarms; cold compile below 1.5 s"
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fast", action="store_true", help="few steps: does it run at all")
    parser.add_argument("--dtype", choices=("float32", "float64"), help="only this one")
    options = parser.parse_args()
    if options.dtype:
        print("\n".join(json.dumps(row) for row in measure(options.dtype, options.fast)))
        return
    rows = []
    for dtype in ("float32", "float64"):  # a process each: float64 is a switch of the whole of JAX
        command = [sys.executable, "-m", "benchmarks.throughput", "--dtype", dtype]
        command += ["--fast"] * options.fast
        environment = os.environ | {"JAX_ENABLE_X64": str(int(dtype == "float64"))}
        output = subprocess.run(command, capture_output=True, text=True, env=environment)
        if output.returncode:
            sys.exit(output.stderr)
        rows += [json.loads(line) for line in output.stdout.splitlines() if line.startswith("{")]

    from benchmarks.timing import write_lines

    report(rows)
    print("written to", write_lines("throughput.jsonl", rows))


def measure(dtype: str, fast: bool) -> list[dict]:
    """Rows of all sizes for one dtype; JAX must already be set to it."""
    import jax
    import jax.numpy as jnp

    from benchmarks.timing import interleaved, machine, ratio
    from jaxswarm.swarm import random

    # Random numbers switched off: the same program, with one number a stream and step for all lanes.
    random.SOURCES["off"] = _one_for_all
    assert jnp.result_type(float) == dtype, "start with JAX_ENABLE_X64"
    sizes = SIZES[:2] if fast else SIZES
    rows = []
    for n, dims, runs in sizes:
        work = n * dims * runs
        steps = max(5, min(2000, int(2e7 / work))) if not fast else 10
        calls = {
            "jaxswarm": _ours(n, dims, runs, steps, "hash"),
            "jaxswarm, random off": _ours(n, dims, runs, steps, "off"),
            "jaxswarm, threefry": _ours(n, dims, runs, steps, "threefry"),
        }
        calls |= _peers(n, dims, runs, steps)
        timed = interleaved(calls, rounds=3 if fast else 9)
        for name, times in timed.items():
            per_step = times.median / steps
            rows.append(
                dict(
                    name=name,
                    num_particles=n,
                    dims=dims,
                    runs=runs,
                    dtype=dtype,
                    us_per_update=1e6 * per_step,
                    times_jaxswarm=ratio(timed, name, "jaxswarm"),
                    compile_s=times.first - times.median,
                    machine=machine(),
                )
            )
        jax.clear_caches()
    return rows


def _one_for_all(key, tag, shape, num):
    import jax
    import jax.numpy as jnp

    word = jax.random.key_data(key)[0]
    return [jnp.broadcast_to(word ^ jnp.uint32(tag + i), shape) for i in range(num)]


def _sphere(x):
    return ((x - 0.3) ** 2).sum(axis=-1)


def _ours(n, dims, runs, steps, source):
    import jax

    from jaxswarm.swarm import Space, minimize, minimize_runs, pso

    optimizer = pso(n, random=source)
    space = Space.vector([0.0] * dims, [1.0] * dims)
    keys = jax.random.split(jax.random.key(0), runs)

    def objective(x, _):  # a new function: every call of _ours compiles for itself
        return _sphere(x)

    if runs == 1:
        options = dict(num_steps=steps, vectorized=True)
        return lambda: minimize(objective, optimizer, space, keys[0], **options).value
    return lambda: minimize_runs(objective, optimizer, space, keys, num_steps=steps).value


def _peers(n, dims, runs, steps):
    calls = {}
    for name, build in (("evosax", _evosax), ("pyswarms", _pyswarms), ("pagmo", _pagmo)):
        if runs > 10 and name in ("pyswarms", "pagmo"):
            continue  # one run after the other: nothing new to learn, and minutes of waiting
        try:
            calls[name] = build(n, dims, runs, steps)
        except ImportError:
            continue
    return calls


def _evosax(n, dims, runs, steps):
    import jax
    import jax.numpy as jnp
    from evosax.algorithms import PSO

    algorithm = PSO(population_size=n, solution=jnp.zeros(dims))
    params = algorithm.default_params

    def run(key):
        key_init, key_run = jax.random.split(key)
        population = jax.random.uniform(key_init, (n, dims))
        state = algorithm.init(key_init, population, _sphere(population), params)

        def step(state, key):
            population, state = algorithm.ask(key, state, params)
            state, _ = algorithm.tell(key, population, _sphere(population), state, params)
            return state, state.best_fitness

        return jax.lax.scan(step, state, jax.random.split(key_run, steps))[1]

    keys = jax.random.split(jax.random.key(0), runs)
    mapped = jax.jit(jax.vmap(run) if runs > 1 else lambda keys: run(keys[0]))
    return lambda: mapped(keys)


def _pyswarms(n, dims, runs, steps):
    import logging

    import numpy as np
    from pyswarms.single import GlobalBestPSO

    logging.disable(logging.CRITICAL)
    options = {"c1": 1.49618, "c2": 1.49618, "w": 0.7298}
    bounds = (np.zeros(dims), np.ones(dims))

    def run():
        for _ in range(runs):
            swarm = GlobalBestPSO(n, dims, options, bounds=bounds)
            swarm.optimize(_sphere, iters=steps, verbose=False)

    return run


def _pagmo(n, dims, runs, steps):
    import numpy as np
    import pygmo

    class Sphere:
        def batch_fitness(self, x):
            return _sphere(x.reshape(-1, dims))

        def fitness(self, x):
            return [_sphere(np.asarray(x))]

        def get_bounds(self):
            return [0.0] * dims, [1.0] * dims

    def run():
        for seed in range(runs):
            population = pygmo.population(pygmo.problem(Sphere()), n, seed=seed)
            algorithm = pygmo.pso_gen(gen=steps)
            algorithm.set_bfe(pygmo.bfe())
            pygmo.algorithm(algorithm).evolve(population)

    return run


def report(rows: list[dict]) -> None:
    """Print the table and how the targets stand."""
    print(
        f"{'n x d x runs':>14} {'dtype':>8} {'name':<22} {'us/update':>11} {'x ours':>7} {'compile s':>9}"
    )
    for row in rows:
        size = f"{row['num_particles']}x{row['dims']}x{row['runs']}"
        print(
            f"{size:>14} {row['dtype']:>8} {row['name']:<22} {row['us_per_update']:>11.1f} "
            f"{row['times_jaxswarm']:>7.2f} {row['compile_s']:>9.2f}"
        )
    print("targets:", TARGETS)


if __name__ == "__main__":
    main()
