"""Islands of optimizers to which an objective returns several numbers."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.swarm import Space, constrained, front, islands, minimize, nsga2, pso, restart

KEY = jax.random.key(0)


def disc(p, _):
    return -(p["x"] + p["y"]), jnp.array([p["x"] ** 2 + p["y"] ** 2 - 1.0])


@pytest.mark.parametrize("wrap", [lambda o: islands(o, 3), lambda o: restart(islands(o, 2))])
def test_constraints_hold_on_islands(wrap):
    space = Space(x=(-2.0, 2.0), y=(-2.0, 2.0))
    found = minimize(disc, wrap(constrained(pso(12), 1)), space, KEY, num_steps=80)
    np.testing.assert_allclose(found.value, -np.sqrt(2.0), atol=1e-3)
    assert float(found.params["x"] ** 2 + found.params["y"] ** 2) <= 1.0 + 1e-9


def test_a_front_of_islands_is_that_of_all():
    space = Space(x=(-4.0, 4.0))
    two = lambda p, _: (p["x"] ** 2, (p["x"] - 1.0) ** 2)  # noqa: E731
    found = minimize(two, islands(nsga2(2, 12), 2, migrate_every=5), space, KEY, num_steps=40)
    values = front(found, space).values
    assert len(values) > 12, "more than one island holds"
    np.testing.assert_allclose(np.sqrt(values).sum(axis=1), 1.0, atol=2e-2)


def test_too_few_rows_are_told():
    optimizer = islands(nsga2(2, 4), 2)
    with pytest.raises(InputError, match=r"shape \(7, 2\) for 8 candidates"):
        optimizer.update(KEY, optimizer.init(KEY, 2), jnp.zeros((7, 2)))
