"""Long after a population has collapsed: ten thousand steps of every optimizer, without a NaN.

All problems of an optimizer are lanes of one program. A value that never was finite stays +inf, so
infinity may stand in memories and best values, and as a limit of the velocity; nowhere else.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.swarm import (
    OPTIMIZERS,
    Space,
    aelspso,
    bipop_cma_es,
    cma_es,
    de,
    elitist_learning,
    freeze,
    ipop_cma_es,
    islands,
    lshade,
    minimize,
    nsga2,
    pso,
    reevaluate,
    restart,
    sepso,
    textbook_ga,
)
from jaxswarm.swarm.endurance import NUM_UPDATES, PROBLEMS, endure, faults

DIMS = 2
OTHERS = {
    "sepso R2": lambda n: sepso(n, variant="R2"),
    "sepso R3": lambda n: sepso(n, variant="R3"),
    "aelspso as APSO": lambda n: aelspso(n, adapt_coefficients=True, gate="convergence"),
    "islands of elitists": lambda n: islands(elitist_learning(pso(n)), 2),
    "restarts": lambda n: restart(pso(n)),
    "restarts of what ends by itself": lambda n: restart(cma_es(n)),
    "textbook_ga without elite": lambda n: textbook_ga(n, num_elites=0),
}
NAMED = {name: entry.factory for name, entry in OPTIMIZERS.items() if name != "auto"}
# Lanes take both sides of every branch: few doublings, few rows to sort. ``auto`` is one of the others.
NAMED |= {
    "ipop_cma_es": lambda n: ipop_cma_es(n, num_doublings=2),
    "bipop_cma_es": lambda n: bipop_cma_es(n, num_doublings=2),
}
BUILD = NAMED | OTHERS
FOR_MANY_DIMENSIONS = ("lm_ma_es",)
"""May settle early in two dimensions, as its head says; that it stays finite is seen here, too."""
MAY_BE_INFINITE = (
    *("best_value", "memory_value", "member_value", "parent_value", "reference"),
    *("recent_value", "median_value", "pool_value", "life.limit"),
)


# The variants in float32 only, whose range and digits end first.
@pytest.mark.parametrize(
    "name, dtype",
    [(name, "float32") for name in BUILD] + [(name, "float64") for name in NAMED],
)
def test_ten_thousand_steps(name, dtype):
    runs = endure(BUILD[name](8), DIMS, jax.random.key(0), dtype)
    assert not faults(runs)
    last, lowest = np.asarray(runs.best[:, -1]), np.array(list(PROBLEMS.values()))
    assert (last >= lowest * (1.0 - 1e-5)).all()
    # Eight particles may settle beside the lowest value; that they search at all is seen.
    if name not in FOR_MANY_DIMENSIONS:
        np.testing.assert_allclose(last, lowest, atol=2e-3)
    for path, leaf in jax.tree_util.tree_flatten_with_path(runs.state)[0]:
        if not jnp.issubdtype(leaf.dtype, jnp.inexact):
            continue
        where = jax.tree_util.keystr(path)
        assert where.endswith(MAY_BE_INFINITE) or np.isfinite(leaf).all(), where
        assert leaf.dtype == dtype, where


WRAPPED = {
    "elitist in place": lambda n: elitist_learning(lshade(n), extra=False),
    "islands of restarts": lambda n: islands(restart(cma_es(n), keep=True), 2, migrate_every=2),
    "frozen": lambda n: freeze(aelspso(n), [False, True], [0.0, 0.25]),
    "judged again": lambda n: reevaluate(de(n)),
}


@pytest.mark.parametrize("name", WRAPPED)
def test_wrappers_endure_it(name):
    assert not faults(endure(WRAPPED[name](8), DIMS, jax.random.key(1), "float32"))


def test_a_front_that_is_a_point_leaves_numbers():
    space = Space.vector(np.full(DIMS, -5.0, "float32"), np.full(DIMS, 5.0, "float32"))

    def two(x, which):
        sphere = jnp.sum(x**2)
        both = jnp.stack([sphere, sphere])  # the front is a point
        return jnp.stack([both, jnp.ones_like(both), both * jnp.nan])[which]

    def search(which):
        return minimize(two, nsga2(2, 8), space, jax.random.key(0), which, num_steps=NUM_UPDATES)

    state = jax.jit(jax.vmap(search))(jnp.arange(3)).state
    for path, leaf in jax.tree_util.tree_flatten_with_path(state)[0]:
        assert not np.isnan(leaf.astype(float)).any(), jax.tree_util.keystr(path)
    assert ((state.position >= 0.0) & (state.position <= 1.0)).all()
