"""How cost grows: against particles, dimensions, runs, samples, joints, logs and workers, with exponents.

    python -m benchmarks.scaling [--only particles,samples] [--workers 1,2] [--rounds 5]

One panel a quantity in ``benchmarks/results/scaling.png``, rows in ``scaling.jsonl``. The cost is what the
process computed, in core-seconds, after a first call that compiles; the exponent is the slope of a straight
line through the logarithms of the larger half of the sizes, where what every call costs anyway counts least.
Workers are those of ``diagnose --fleet``: their cost is the time per log on the clock, so that -1 is perfect.
"""

import argparse
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

NEEDS = ("distributed", "fsspec", "pyarrow")
TAKES = "4 minutes; --only without workers 2"
FRICTION = "viscous_friction,coulomb_friction"
STEPS = 100
Call = Callable[[], Any]


class Curve(NamedTuple):
    """One quantity: what is done, and the call that does it at each size."""

    what: str
    sizes: tuple[int, ...]
    call: Callable[[int], Call]


def search(particles: int = 50, dims: int = 13, runs: int = 1) -> Call:
    """A hundred steps of a swarm on a sphere."""
    import jax

    from jaxswarm.swarm import Space, minimize_runs, pso

    space = Space.vector([0.0] * dims, [1.0] * dims)
    keys = jax.random.split(jax.random.key(0), runs)

    def sphere(x, _):  # a new function at each size: it compiles for itself
        return ((x - 0.3) ** 2).sum(axis=-1)

    return lambda: minimize_runs(sphere, pso(particles), space, keys, num_steps=STEPS).value


def fit(seconds: float = 20.0, joints: int = 3, logs: int = 1) -> Call:
    """A least-squares fit of rigid body and friction to logs at 250 Hz of a chain of joints."""
    from benchmarks.dynamics_joints import chain
    from jaxswarm.effects.term import parse_terms
    from jaxswarm.identify.estimation.estimate import estimate
    from jaxswarm.identify.synthetic import random_links, synthetic_log
    from jaxswarm.logs.motion import prepare

    robot = chain(joints)
    robot = robot.replace(parameters=random_links(robot, np.random.default_rng(0)))
    terms = parse_terms(FRICTION, robot.joints)
    known = tuple(replace(t, values={p.name: 2.0 for p in t.law.parameters}) for t in terms)
    read = [synthetic_log(robot, known, k, duration=seconds, rate=250.0) for k in range(logs)]
    return lambda: estimate(robot, terms, [prepare(log) for log in read]).fit.values


CURVES = {
    "particles": Curve("100 steps, 13 dimensions", (64, 256, 1024, 4096, 16384), search),
    "dimensions": Curve("100 steps, 256 particles", (4, 16, 64, 256), lambda d: search(256, d)),
    "runs": Curve("100 steps, 50 x 13", (1, 4, 16, 64, 256), lambda r: search(runs=r)),
    "samples": Curve("fit of 3 joints", (2500, 5000, 10000, 20000), lambda n: fit(n / 250.0)),
    "joints": Curve("fit of 20 s", (1, 2, 4, 8, 12), lambda n: fit(joints=n)),
    "logs": Curve("fit of 3 joints, 5 s each", (1, 2, 4, 8), lambda n: fit(5.0, logs=n)),
}


def measured(name: str, curve: Curve, rounds: int) -> Iterator[dict]:
    """Rows of one quantity: the least core-seconds of all rounds, taken in turns."""
    from benchmarks.timing import interleaved

    times = interleaved({str(size): curve.call(size) for size in curve.sizes}, rounds)
    for size in curve.sizes:
        cost = float(times[str(size)].computed.min())
        yield {"quantity": name, "what": curve.what, "size": size, "cost": cost}


def of_workers(counts: tuple[int, ...]) -> Iterator[dict]:
    """Rows of the fleet's workers: seconds per log on the clock, the start left out."""
    from benchmarks.fleet import make_fleet, measure

    with TemporaryDirectory(prefix="jaxswarm-scaling-") as folder:
        logs = Path(folder) / "logs"
        make_fleet(logs, 4, 2, 12.0)
        for count in counts:
            done = measure(logs, Path(folder) / f"out{count}", count)
            cost = 60.0 / done["logs_per_minute"]
            yield {"quantity": "workers", "what": "8 logs", "size": count, "cost": cost}


def exponent(sizes: list[float], costs: list[float]) -> float:
    """Slope of the logarithms over the larger half of the sizes, at least two of them.

    >>> round(exponent([1.0, 10.0, 100.0, 1000.0], [5.0, 5.0, 10.0, 100.0]), 3)
    1.0
    """
    count = max(2, (len(sizes) + 1) // 2)
    return float(np.polyfit(np.log(sizes[-count:]), np.log(costs[-count:]), 1)[0])


def picture(rows: list[dict]) -> Any:
    """One panel a quantity: cost over size on logarithmic axes, the exponent in its title."""
    from jaxswarm import plots

    names = list(dict.fromkeys(row["quantity"] for row in rows))
    across = min(3, len(names))
    down = -(-len(names) // across)
    figure, axes = plots.panels(down, across, 3.4 * across, 2.7 * down)
    for axis in axes[len(names) :]:
        axis.remove()
    for axis, name in zip(axes, names, strict=False):
        own = [row for row in rows if row["quantity"] == name]
        sizes, costs = [row["size"] for row in own], [row["cost"] for row in own]
        axis.loglog(sizes, costs, "o-", color=plots.RESIDUAL)
        axis.set_xlabel(f"{name} ({own[0]['what']})")
        axis.set_ylabel("seconds")
        axis.set_title(f"exponent {own[0]['exponent']:.2f}", fontsize=10)
    return figure


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", default=",".join([*CURVES, "workers"]), help="with commas")
    parser.add_argument("--workers", default="1,2", help="numbers of workers, with commas")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    from jaxswarm.runtime import start

    start()
    from benchmarks.timing import RESULTS, machine, write_lines
    from jaxswarm import plots

    rows = []
    for name in options.only.split(","):
        if name == "workers":
            own = list(of_workers(tuple(map(int, options.workers.split(",")))))
        else:
            own = list(measured(name, CURVES[name], options.rounds))
        slope = exponent([row["size"] for row in own], [row["cost"] for row in own])
        rows += [{**row, "exponent": slope} for row in own]
        costs = ", ".join(f"{row['size']}: {row['cost']:.3g} s" for row in own)
        print(f"{name}: exponent {slope:.2f}   ({own[0]['what']}; {costs})", flush=True)
    print("written to", write_lines("scaling.jsonl", [{**row, **machine()} for row in rows]))
    (RESULTS / "scaling.png").write_bytes(plots.png_bytes(picture(rows)))
    print("written to", RESULTS / "scaling.png")


if __name__ == "__main__":
    main()
