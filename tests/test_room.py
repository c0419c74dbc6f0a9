"""Programs are let go of before a process has no memory maps left, and nothing else is."""

import importlib
import threading
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxswarm
from jaxswarm.identify.synthetic import demo_case, synthetic_log
from jaxswarm.programs import Program
from jaxswarm.robot import rx60
from jaxswarm.room import Room, count_maps, most_maps
from jaxswarm.swarm import Driver, Space, minimize, minimize_resumable, polish, pso

room = importlib.import_module("jaxswarm.room")
SPACE = Space.vector([-1.0] * 2, [1.0] * 2)


def sphere(x, _):
    return (x**2).sum()


class Process:
    """Maps of a process that lets go of its programs, and a clock."""

    def __init__(self, monkeypatch, most=1000):
        self.programs, self.others, self.seconds, self.cleared = 0, 0, 0.0, 0
        monkeypatch.setattr(room.jax, "clear_caches", self._clear)
        self.room = Room(lambda: self.programs + self.others, lambda: most, lambda: self.seconds)

    def _clear(self):
        self.programs, self.cleared = 0, self.cleared + 1

    def make(self):
        self.seconds += 10.0
        return self.room.make()


def test_programs_are_let_go_of_at_half_of_what_there_is(monkeypatch):
    process = Process(monkeypatch)
    process.programs = 499
    assert not process.make() and process.cleared == 0
    process.programs = 500
    assert process.make() and process.cleared == 1
    assert not process.make()


def test_what_others_take_is_not_asked_for_again_and_again(monkeypatch):
    process = Process(monkeypatch)
    process.others = 800
    assert process.make()
    assert not process.make()  # nothing was won by it
    process.programs = 99
    assert not process.make()
    process.programs = 100
    assert process.make() and process.cleared == 2


def test_maps_are_counted_once_a_second_at_most(monkeypatch):
    process = Process(monkeypatch)
    assert not process.make()
    process.programs = 900
    process.seconds += 0.9
    assert not process.room.make()
    process.seconds += 0.2
    assert process.room.make()


def test_a_system_that_does_not_tell_is_left_alone(monkeypatch):
    monkeypatch.setattr(room.jax, "clear_caches", lambda: pytest.fail("let go"))
    assert not Room(lambda: None, lambda: 10).make()
    assert not Room(lambda: 10**6, lambda: None).make()
    nowhere = Path("no such folder") / "maps"
    monkeypatch.setattr(room, "_MAPS", nowhere)
    monkeypatch.setattr(room, "_MOST", nowhere)
    assert count_maps() is None and most_maps() is None


def test_programs_kept_beside_those_of_jax_are_let_go_of(tmp_path, monkeypatch):
    monkeypatch.setattr(importlib.import_module("jaxswarm.programs"), "_folder", lambda: tmp_path)
    double = Program(lambda x: 2.0 * x)
    first = double(np.arange(3.0))
    assert double.made
    assert Room(lambda: 900, lambda: 1000).make()
    assert double.made == 0
    assert np.array_equal(first, [0.0, 2.0, 4.0]) and np.array_equal(double(np.arange(3.0)), first)


def test_what_a_user_holds_goes_on(monkeypatch):
    """Functions, arrays, a search in its midst, and a trace under way."""
    always = Room(lambda: 900, lambda: 1000, iter(range(0, 1000, 2)).__next__)
    cube = jax.jit(lambda x: x**3)
    array = cube(jnp.arange(3.0))
    driver = Driver(pso(4), SPACE, jax.random.key(0), num_steps=4)

    def told():
        driver.tell([float((x**2).sum()) for x in driver.ask()])

    told()
    assert always.make()
    told()
    np.testing.assert_array_equal(cube(array), [0.0, 1.0, 512.0])

    @jax.jit
    def within(x):
        y = jnp.sin(x)
        always._others = 0
        assert always.make()
        return 2.0 * y

    assert np.isclose(within(1.0), 2.0 * np.sin(1.0))


def test_two_threads_let_go_of_what_the_other_calls():
    """A program that is called is held by its caller."""
    double, ended, wrong = Program(lambda x: 2.0 * x), threading.Event(), []

    def call():
        while not ended.is_set():
            for size in range(1, 9):
                if double(np.ones(size)).sum() != 2.0 * size:
                    wrong.append(size)

    thread = threading.Thread(target=call)
    thread.start()
    for _ in range(20):
        Room(lambda: 900, lambda: 1000).make()
    ended.set()
    thread.join()
    assert not wrong


@pytest.mark.parametrize("begin", ["task", "minimize", "driver", "polish"])
def test_every_task_and_search_makes_room(begin, monkeypatch):
    asked = []
    for place in ("tasks.inputs", "swarm.search", "swarm.driver", "swarm.polish"):
        module = importlib.import_module(f"jaxswarm.{place}")
        monkeypatch.setattr(module, "room_for_programs", lambda place=place: asked.append(place))
    key = jax.random.key(0)
    if begin == "task":
        arm, declared, _ = demo_case(rx60(), 1)
        jaxswarm.inspect(synthetic_log(arm, declared, 1, duration=8.0), "rx60")
    if begin == "minimize":
        minimize(sphere, pso(4), SPACE, key, num_steps=2)
    if begin == "driver":
        Driver(pso(4), SPACE, key, num_steps=2)
    if begin == "polish":
        polish(sphere, SPACE, jnp.zeros(2), num_steps=2)
    assert asked


@pytest.mark.skipif(count_maps() is None, reason="the system tells of no memory maps")
def test_more_searches_than_there_are_maps_for(monkeypatch):
    """Each is compiled into some eighty maps: so many do not fit, and the earlier ones are let go of."""
    others, most = count_maps(), count_maps() + 600
    seconds = iter(range(0, 1000, 2))
    small = Room(most=lambda: most, clock=lambda: next(seconds))
    small._others = others
    monkeypatch.setattr("jaxswarm.swarm.search.room_for_programs", small.make)
    key = jax.random.key(0)
    for k in range(12):
        minimize(lambda x, _, k=k: ((x - k) ** 2).sum(), pso(4), SPACE, key, num_steps=2)
        assert count_maps() < most


def test_a_search_with_many_checkpoints_needs_no_program_for_each(tmp_path, caplog):
    """Histories of growing length were joined by a program each: 2.7 maps and a tenth of a second."""

    def compiled(count):
        path = tmp_path / str(count)
        caplog.clear()
        with jax.log_compiles():
            options = dict(num_steps=2 * count, every=2, path=path)
            found = minimize_resumable(sphere, pso(4), SPACE, jax.random.key(0), **options)
        assert isinstance(found.history, jax.Array) and found.history.shape == (2 * count,)
        return sum("Finished XLA compilation" in record.message for record in caplog.records)

    compiled(3)
    # One or two more may be made anew where programs were let go of in between; not one for each of 26 more.
    assert compiled(30) < compiled(4) + 5
