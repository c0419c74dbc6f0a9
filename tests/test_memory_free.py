"""What asks for more memory than there is says how much it needs, before it begins."""

import jax
import pytest

import jaxswarm.memory
from jaxswarm.errors import InputError
from jaxswarm.fleet.schedule import Cluster, connected
from jaxswarm.identify.synthetic import demo_case, synthetic_log
from jaxswarm.robot import rx60
from jaxswarm.swarm import (
    Driver,
    Space,
    minimize,
    minimize_resumable,
    minimize_runs,
    minimize_sharded,
    pso,
)
from jaxswarm.swarm.needed import refuse_too_many
from jaxswarm.tasks.simulation import resampled

SPACE = Space.vector([-1.0] * 3, [1.0] * 3)


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr(jaxswarm.memory, "free", lambda: 0.25)


def test_more_runs_steps_or_particles_than_memory_holds(small):
    with pytest.raises(
        InputError, match=r"2147483647 times 500 steps, takes about .* GiB, and 0\.25"
    ):
        refuse_too_many(pso(20), SPACE, 500, runs=2**31 - 1)
    for particles, steps in ((20, 2**31 - 1), (10**9, 1)):
        with pytest.raises(InputError, match="fewer runs, particles or steps"):
            minimize(
                lambda x, _: (x**2).sum(), pso(particles), SPACE, jax.random.key(0), num_steps=steps
            )


def test_every_way_of_searching_says_what_it_needs(small, tmp_path):
    def told(fn, optimizer, steps):
        with pytest.raises(
            InputError, match=r"takes about .* GiB, and 0\.25 GiB are free; ask for fewer"
        ):
            fn(optimizer, steps)

    def sphere(x, _):
        return (x**2).sum()

    key, path = jax.random.key(0), tmp_path / "search"
    keys = jax.random.split(key, 4)

    def resumable(optimizer, steps, key=key):
        minimize_resumable(sphere, optimizer, SPACE, key, num_steps=steps, path=path)

    told(resumable, pso(20), 2**31 - 1)
    told(resumable, pso(10**9), 1)
    told(lambda *asked: resumable(*asked, keys), pso(20), 2**28)
    told(
        lambda optimizer, steps: minimize_sharded(sphere, optimizer, SPACE, keys, num_steps=steps),
        pso(20),
        2**28,
    )
    told(
        lambda optimizer, steps: Driver(optimizer, SPACE, key, num_steps=steps),
        pso(10**9),
        2**31 - 1,
    )
    assert not path.exists()


def test_a_driver_keeps_no_history_beforehand(small):
    """Its number of steps is an upper limit, of which a user may end at any."""
    assert Driver(pso(4), SPACE, jax.random.key(0), num_steps=2**31 - 1).size == 4


def test_a_search_that_fits_is_not_refused(small):
    keys = jax.random.split(jax.random.key(0), 2)
    found = minimize_runs(lambda x, _: (x**2).sum(axis=1), pso(20), SPACE, keys, num_steps=3)
    assert found.value.shape == (2,)


def test_more_samples_or_workers_than_memory_holds(small):
    arm, declared, _ = demo_case(rx60(), 1)
    log = synthetic_log(arm, declared, 1, duration=8.0)
    assert len(resampled(log, 100.0)[0]) > 700
    with pytest.raises(InputError, match=r"to simulate \d+ samples of 3 joints takes"):
        resampled(log, 999_999.0)
    with pytest.raises(InputError, match="900 workers take"), connected(Cluster(workers=900)):
        pass


def test_nothing_is_refused_where_the_system_does_not_tell(monkeypatch):
    monkeypatch.setattr(jaxswarm.memory, "free", lambda: None)
    jaxswarm.memory.refuse_beyond_free(1e9, "it takes", "wait")


@pytest.mark.parametrize("library", [OSError, TypeError, object])
def test_where_no_library_gives_memory_back_it_stays(monkeypatch, library):
    def found(name):
        if library is object:
            return library()  # one that knows nothing of it
        raise library

    monkeypatch.setattr(jaxswarm.memory.ctypes, "CDLL", found)
    jaxswarm.memory.give_back()
