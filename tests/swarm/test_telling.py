"""What a progress function raises arrives as it was raised, and the search ends there."""

import traceback

import jax
import jax.numpy as jnp
import pytest

from jaxswarm.swarm import Space, minimize, minimize_runs, minimize_sharded, pso, stalled

SPACE = Space.vector([-5.0] * 2, [5.0] * 2)
KEYS = jax.random.split(jax.random.key(0), 2)
OPTIONS = dict(num_steps=1000, progress_every=2)


class Enough(Exception):
    """An exception of the user's."""


def sphere(x, _):
    return jnp.sum(x**2, axis=-1)


def one(progress):
    return minimize(sphere, pso(4), SPACE, KEYS[0], progress=progress, **OPTIONS)


def stopped(progress):
    return minimize(sphere, pso(4), SPACE, KEYS[0], progress=progress, stop=stalled(900), **OPTIONS)


def runs(progress):
    return minimize_runs(sphere, pso(4), SPACE, KEYS, progress=progress, **OPTIONS)


def spread(progress):
    here = jax.devices()[:1]
    return minimize_sharded(sphere, pso(4), SPACE, KEYS, progress=progress, devices=here, **OPTIONS)


@pytest.mark.parametrize("search", [one, stopped, runs, spread])
def test_an_exception_arrives_as_it_was_raised(search):
    seen = []

    def tell(count, value):
        seen.append(int(count))
        if len(seen) == 3:
            raise Enough("three") from LookupError("why")

    with pytest.raises(Enough, match="three") as raised:
        search(tell)
    assert seen == [2, 4, 6], "the search went on"
    assert isinstance(raised.value.__cause__, LookupError)
    assert "tell" in [frame.name for frame in traceback.extract_tb(raised.value.__traceback__)]


def test_an_interrupt_is_one_and_the_next_search_is_as_ever():
    told = []

    def tell(count, value):
        told.append(int(count))
        if len(told) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        one(tell)
    assert one(tell).status.message == "all steps done" and len(told) == 2 + 500


def test_other_errors_of_a_program_are_left_as_they_are():
    def broken(x, _):
        return jax.pure_callback(
            lambda _: 1 / 0, jax.ShapeDtypeStruct((), x.dtype), x.sum(), vmap_method="sequential"
        )

    with pytest.raises(jax.errors.JaxRuntimeError, match="ZeroDivisionError"):
        minimize(broken, pso(4), SPACE, KEYS[0], num_steps=2, progress=lambda count, value: None)
