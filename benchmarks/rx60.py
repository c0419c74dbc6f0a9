"""Wall time of the RX60 paper's experiment beside pyswarms and mealpy, warm and as one cold process.

    python -m benchmarks.rx60 [--fast]

The experiment: 2 schemes x 2 noise cases x 10 runs, 50 particles, 500 iterations, 7001 samples of three
joints. Ours runs GPSO and AELSPSO through the triangular factor on two threads, ten runs as one program;
compressing the logs counts as ours. The peers have one swarm each, which stands for both schemes.
Two comparisons:

- as people use them: the fitness is NumPy matrix products over all samples, pyswarms for a whole swarm
  at once, mealpy for one particle at a time;
- the same fitness handed to them: our 13 x 13 factor, in NumPy.

A peer's time for the experiment is extrapolated: that of some runs (printed) times 40 / runs, which are
independent and equal. Cold times are those of a new process with imports, once without and once with a
filled compile cache. On a shared machine look at the CPU seconds of the warm experiment: load hardly moves
them, and ours spreads its own over two threads.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

from benchmarks.rx60_report import report

NEEDS = ("pyswarms", "mealpy")
TAKES = "10 minutes; --fast 2 minutes"
os.environ.setdefault("OPENBLAS_NUM_THREADS", "2")

PARTICLES, STEPS, RUNS = 50, 500, 40
TARGETS = {"as used": (300.0, 6.0), "same fitness": (30.0, 1.0)}  # warm, cold


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fast", action="store_true", help="few iterations: does it run at all")
    parser.add_argument("--alone", choices=tuple(_SOLVERS), help="one contestant, as JSON")
    options = parser.parse_args()
    if options.alone:
        print(json.dumps(alone(options.alone, options.fast)))
        return
    rows = []
    with tempfile.TemporaryDirectory() as cache:
        for name in _SOLVERS:
            for kind in ("cold", "cold, cached") if name == "jaxswarm" else ("cold",):
                # The first process of ours fills the cache that the second one reads.
                extra = {"JAX_COMPILATION_CACHE_DIR": cache} if name == "jaxswarm" else {}
                rows.append(_process(name, kind, options.fast, extra))
    report(rows, TARGETS, RUNS)
    from benchmarks.timing import write_lines

    print("written to", write_lines("rx60.jsonl", rows))


def alone(name: str, fast: bool) -> dict:
    """Run one contestant in this process: seconds of the first and of the second experiment."""
    begin = time.perf_counter()
    try:
        solve, runs = _SOLVERS[name](fast)
    except ImportError as error:
        return {"name": name, "missing": str(error)}
    scale = RUNS / runs
    ready, busy = time.perf_counter(), time.process_time()
    best = solve()
    first, busy = time.perf_counter(), (time.process_time() - busy) * scale
    # A peer compiles nothing: its first experiment is as good as its second.
    warm = (first - ready) * scale
    if name == "jaxswarm":
        times = []
        for _ in range(2 if fast else 15):
            start = time.perf_counter(), time.process_time()
            solve()
            times.append((time.perf_counter() - start[0], time.process_time() - start[1]))
        warm, busy = (sorted(column)[len(times) // 2] for column in zip(*times, strict=True))
    row = {"name": name, "runs": runs, "setup": ready - begin, "first": (first - ready) * scale}
    return row | {"warm": warm, "warm_cpu": busy, "median_fbest": best}


def _process(name: str, kind: str, fast: bool, extra: dict[str, str]) -> dict:
    command = [sys.executable, "-m", "benchmarks.rx60", "--alone", name] + ["--fast"] * fast
    environment = os.environ | {"JAX_ENABLE_X64": "1"} | extra
    environment |= {"JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0"} if extra else {}
    start = time.perf_counter()
    output = subprocess.run(command, capture_output=True, text=True, env=environment)
    seconds = time.perf_counter() - start
    if output.returncode:
        sys.exit(output.stderr)
    row = json.loads(output.stdout.splitlines()[-1]) | {"kind": kind}
    if "missing" not in row:
        # What a process costs besides its experiments, plus one experiment.
        row["cold"] = row["setup"] + row["first"] + _interpreter()
        row["process"] = seconds
    return row


def _interpreter() -> float:
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", "pass"], check=True)
    return time.perf_counter() - start


def _data():
    """The noisy problem and its box without importing JAX: what a user of NumPy would have."""
    import numpy as np

    rng = np.random.default_rng(0)
    # The columns' values do not matter for the time; their shape and the 13 unknowns do.
    columns, true = rng.normal(size=(21003, 13)), rng.normal(size=13)
    tau = columns @ true + 0.1 * rng.normal(size=21003)
    return columns, tau, -5.0 * np.ones(13), 5.0 * np.ones(13)


def _fitness(factored: bool):
    import numpy as np

    columns, tau, lower, upper = _data()
    if not factored:
        samples = len(tau) // 3

        def fitness(x):
            error = tau[:, None] - columns @ np.atleast_2d(x).T
            return np.sqrt((error**2).sum(axis=0) / samples)

        return fitness, lower, upper
    stacked = np.column_stack([columns, tau]) / np.sqrt(len(tau) / 3)
    triangle = np.linalg.qr(stacked, mode="r")
    factor, target, rest = triangle[:13, :13], triangle[:13, 13], triangle[13, 13] ** 2

    def compressed(x):
        return np.sqrt(((np.atleast_2d(x) @ factor.T - target) ** 2).sum(axis=1) + rest)

    return compressed, lower, upper


def _ours(fast):
    from concurrent.futures import ThreadPoolExecutor

    import jax
    import jax.numpy as jnp
    import numpy as np

    from jaxswarm.swarm import Space, aelspso, gpso, minimize_runs

    steps = 20 if fast else STEPS
    columns, tau, lower, upper = _data()
    keys = jax.random.split(jax.random.key(0), 10)
    space = Space.vector(lower, upper)
    schemes = aelspso(PARTICLES, steps), gpso(PARTICLES, steps)

    def fitness(x, problem):
        factor, target, rest = problem
        return jnp.sqrt(jnp.sum((factor @ x.T - target[:, None]) ** 2, axis=0) + rest)

    def compress(_):
        # Part of the experiment: two cases, one QR each.
        stacked = np.column_stack([columns, tau]) / np.sqrt(len(tau) / 3)
        # By blocks that stay in the cache, as ``identify.least_squares.triangular_factor`` has it.
        rows = len(stacked) // 512 * 512
        blocks = np.linalg.qr(stacked[:rows].reshape(-1, 512, 14), mode="r").reshape(-1, 14)
        r = np.linalg.qr(np.concatenate([blocks, stacked[rows:]]), mode="r")
        return r[:13, :13], r[:13, 13], r[13, 13] ** 2

    def solve():
        with ThreadPoolExecutor(2) as pool:
            problems = list(pool.map(compress, ("clean", "noisy")))

            def search(scheme, problem):
                found = minimize_runs(fitness, scheme, space, keys, problem, num_steps=steps)
                return jax.device_get(found.value)

            # The scheme that takes longer first, so that the two threads end together.
            tasks = [(scheme, p) for scheme in schemes for p in problems]
            return float(np.median(list(pool.map(lambda task: search(*task), tasks))))

    return solve, RUNS


def _pyswarms(factored):
    def build(fast):
        import logging

        import numpy as np
        from pyswarms.single import GlobalBestPSO

        logging.disable(logging.CRITICAL)
        fitness, lower, upper = _fitness(factored)
        runs, steps = (1, 20) if fast else (10 if factored else 5, STEPS)

        def solve():
            options = {"c1": 2.0, "c2": 2.0, "w": 0.6}
            best = []
            for seed in range(runs):
                np.random.seed(seed)
                swarm = GlobalBestPSO(PARTICLES, 13, options, bounds=(lower, upper))
                best.append(swarm.optimize(fitness, iters=steps, verbose=False)[0])
            return float(np.median(best))

        return solve, runs

    return build


def _mealpy(factored):
    def build(fast):
        import numpy as np
        from mealpy import FloatVar
        from mealpy.swarm_based.PSO import OriginalPSO

        fitness, lower, upper = _fitness(factored)
        runs, steps = (1, 20) if fast else (2 if factored else 1, STEPS)
        problem = {
            "obj_func": lambda x: float(fitness(x)[0]),
            "bounds": FloatVar(lb=lower, ub=upper),
            "minmax": "min",
            "log_to": None,
        }

        def solve():
            best = []
            for seed in range(runs):
                model = OriginalPSO(epoch=steps, pop_size=PARTICLES, c1=2.0, c2=2.0, w=0.6)
                best.append(model.solve(problem, seed=seed).target.fitness)
            return float(np.median(best))

        return solve, runs

    return build


_SOLVERS = {
    "jaxswarm": _ours,
    "pyswarms, as used": _pyswarms(False),
    "mealpy, as used": _mealpy(False),
    "pyswarms, same fitness": _pyswarms(True),
    "mealpy, same fitness": _mealpy(True),
}


if __name__ == "__main__":
    main()
