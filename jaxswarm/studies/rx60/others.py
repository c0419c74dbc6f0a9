"""Every other optimizer on the noisy RX60 problem, at equal evaluations, in all three coordinates."""

import time

import jax
import numpy as np

from jaxswarm.studies.rx60.search import COORDINATES, PARTICLES, View, search
from jaxswarm.swarm import OPTIMIZERS

EVALUATIONS = 48_000
FAST_NAMES = ("cma_es", "random_search")
WITHIN = 0.01  # of the least-squares cost f^2
WIDE, WIDE_NAMES = "raw, bounds x 4", ("gpso", "pso", "de", "cma_es")


def table(views: dict[str, View], key: jax.Array, *, fast: bool) -> list[dict]:
    """Excess of the cost over least squares, and evaluations and seconds to within 1 % of it.

    Args:
        views: Of the noisy problem by coordinates; :data:`WIDE`, a box with sides four times as long, too.
        key: Key of the searches.
        fast: Two optimizers, raw coordinates and few evaluations only.

    Seconds are those of the whole program for ten runs, compiled beforehand.
    """
    names = FAST_NAMES if fast else tuple(OPTIMIZERS)
    evaluations = 4_800 if fast else EVALUATIONS
    rows = []
    for name in names:
        wide = (WIDE,) if name in WIDE_NAMES else ()
        for coordinates in COORDINATES[:1] if fast else (*COORDINATES, *wide):
            at = views[coordinates]
            found, seconds = _run(name, at, key, evaluations, fast)
            near = found.evaluations_to(at.optimum * np.sqrt(1.0 + WITHIN))
            excess = (found.values / at.optimum) ** 2 - 1.0
            total = found.per_step * found.history.shape[1]
            rows.append(
                {
                    "optimizer": name,
                    "reconstruction": OPTIMIZERS[name].reconstruction,
                    "coordinates": coordinates,
                    "evaluations": total,
                    "excess_median": float(np.median(excess)),
                    "excess_max": float(excess.max()),
                    "evaluations_to_one_percent": near,
                    "seconds_ten_runs": seconds,
                    "seconds_to_one_percent": None
                    if near is None or seconds is None
                    else seconds / len(found.values) * near / total,
                }
            )
    return rows


def _run(name, at, key, evaluations, fast):
    entry = OPTIMIZERS[name]
    rows = PARTICLES + (name == "aelspso")
    steps = evaluations // rows
    scheduled = {"num_steps": steps} if entry.scheduled else {}
    optimizer = entry.factory(PARTICLES, **scheduled)
    found = search(at, optimizer, key, runs=10, num_steps=steps)
    if fast:
        return found, None
    start = time.perf_counter()
    search(at, optimizer, key, runs=10, num_steps=steps)
    return found, time.perf_counter() - start
