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
    elitist_learning,
    ipop_cma_es,
    islands,
    minimize,
    pso,
    restart,
    sepso,
    textbook_ga,
)

STEPS, DIMS = 10_000, 2
CENTER = 1.3
# Lowest values that exist; in half of the space there is none, and the center lies there.
LOWEST = {
    "sphere": 0.0,
    "constant": 7.0,
    "half NaN": CENTER**2,
    "half infinite": CENTER**2,
    "flat at zero": 0.0,
    "no value anywhere": np.inf,
}
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
MAY_BE_INFINITE = (
    *("best_value", "memory_value", "member_value", "parent_value", "reference"),
    *("recent_value", "median_value", "pool_value", "life.limit"),
)


def problems(x, which):
    sphere = jnp.sum((x - CENTER) ** 2)
    absent = x[0] > 0.0
    values = [
        sphere,
        jnp.full_like(sphere, 7.0),
        jnp.where(absent, jnp.nan, sphere),
        jnp.where(absent, jnp.inf, sphere),
        jnp.sum(jnp.maximum(jnp.abs(x) - 1.0, 0.0)),
        jnp.full_like(sphere, jnp.nan),
    ]
    return jnp.stack(values)[which]


def kept(state, info):
    inside = jnp.all((state.position >= 0.0) & (state.position <= 1.0))
    broken = [jnp.any(jnp.isnan(leaf)) for leaf in jax.tree.leaves(info.hyper)]
    return info.value_best, inside, jnp.any(jnp.stack([*broken, jnp.isnan(info.diversity)]))


# The variants in float32 only, whose range and digits end first.
@pytest.mark.parametrize(
    "name, dtype",
    [(name, "float32") for name in BUILD] + [(name, "float64") for name in NAMED],
)
def test_ten_thousand_steps(name, dtype):
    space = Space.vector(np.full(DIMS, -5.0, dtype), np.full(DIMS, 5.0, dtype))
    optimizer = BUILD[name](8)

    def search(which):
        key = jax.random.key(0)
        return minimize(problems, optimizer, space, key, which, num_steps=STEPS, record=kept)

    result = jax.jit(jax.vmap(search))(jnp.arange(len(LOWEST)))
    best, inside, broken = map(np.asarray, result.history)
    assert inside.all() and not broken.any()
    assert (best[:, 1:] <= best[:, :-1]).all()
    lowest = np.array(list(LOWEST.values()))
    assert (best[:, -1] >= lowest * (1.0 - 1e-6)).all()
    # Eight particles may settle beside the lowest value; that they search at all is seen.
    np.testing.assert_allclose(best[:, -1], lowest, atol=0.2)
    for path, leaf in jax.tree_util.tree_flatten_with_path(result.state)[0]:
        if not jnp.issubdtype(leaf.dtype, jnp.inexact):
            continue
        where = jax.tree_util.keystr(path)
        assert not np.isnan(leaf).any(), where
        assert where.endswith(MAY_BE_INFINITE) or np.isfinite(leaf).all(), where
        assert leaf.dtype == dtype, where
