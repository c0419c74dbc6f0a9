"""How the paper's numbers depend on what it does not print: swarm size, iterations, bounds, c1 = c2."""

import dataclasses
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.studies.rx60.data import bounds
from jaxswarm.studies.rx60.search import View, torque_fitness
from jaxswarm.swarm import Space, aelspso, gpso, minimize

STRETCH = (0.9, 1.0, 2.0, 4.0, 10.0)
ACCELERATION = (1.2, 1.3, 1.5, 1.7, 2.0)
LEVEL = 0.0161, 0.0657  # the paper's noise-free fbest of GPSO and AELSPSO


@partial(jax.jit, static_argnames=("name", "size", "num_steps"))
def _sweep(name, size, num_steps, problem, boxes, accelerations, keys):
    """Median best value after each step: (boxes, accelerations, steps), all runs one program."""
    swarm = {"gpso": gpso, "aelspso": aelspso}[name](size, num_steps)

    def one(box, c, key):
        space = Space.vector(np.zeros(13), np.ones(13))
        space = jax.tree.unflatten(jax.tree.structure(space), box)
        inner = swarm if name == "gpso" else swarm.inner
        inner = dataclasses.replace(inner, cognitive=c, social=c)
        chosen = inner if name == "gpso" else dataclasses.replace(swarm, inner=inner)
        options = {"num_steps": num_steps, "vectorized": True}
        return minimize(torque_fitness, chosen, space, key, problem, **options).history

    over_keys = jax.vmap(one, (None, None, 0))
    over_c = jax.vmap(over_keys, (None, 0, None))
    return jnp.median(jax.vmap(over_c, (0, None, None))(boxes, accelerations, keys), axis=2)


def sensitivity(at: View, key: jax.Array, *, runs: int, fast: bool) -> list[dict]:
    """Median noise-free fbest over swarm sizes, iterations, bounds and c, for both schemes.

    Each scheme and size is one program mapped over bounds, c and runs. The iterations are those of the
    schedule of the whole search, so each length is a search of its own.
    """
    settings = [(24, 200)] if fast else [(n, k) for n in (12, 24, 48) for k in (100, 200, 500)]
    settings += [] if fast else [(24, 2000)]
    stretches = STRETCH[1:3] if fast else STRETCH
    accelerations = ACCELERATION[1::3] if fast else ACCELERATION
    boxes = [np.stack(side) for side in zip(*(bounds(s) for s in stretches), strict=True)]
    keys = jax.random.split(key, runs)
    problem = jax.tree.map(jnp.asarray, (at.factor, at.target, at.rest))
    rows = []
    for name in ("gpso", "aelspso"):
        for size, steps in settings:
            medians = np.asarray(
                _sweep(name, size, steps, problem, boxes, jnp.asarray(accelerations), keys)
            )
            rows += [
                {
                    "scheme": name,
                    "particles": size,
                    "steps": steps,
                    "bounds": stretch,
                    "c": c,
                    "fbest_median": float(medians[i, j, -1]),
                }
                for i, stretch in enumerate(stretches)
                for j, c in enumerate(accelerations)
            ]
    return rows


def nearest_to_paper(rows: list[dict]) -> dict[str, dict]:
    """For each scheme the setting whose noise-free fbest is closest to the paper's, in ratio."""
    chosen = {}
    for name, level in zip(("gpso", "aelspso"), LEVEL, strict=True):
        own = [r for r in rows if r["scheme"] == name]
        best = min(own, key=lambda r: abs(np.log(max(r["fbest_median"], 1e-300) / level)))
        chosen[name] = best | {"paper": level}
    return chosen
