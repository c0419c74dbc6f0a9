"""Compiled programs that another process finds ready."""

import functools
import importlib
import itertools
import json
import os
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm import program_files, program_names
from jaxswarm.effects import REGISTRY, get_law
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.sample import Sample
from jaxswarm.identify.forward import columns, direction
from jaxswarm.programs import Program

programs = importlib.import_module("jaxswarm.programs")
LAW = get_law("stribeck_friction")
VALUES = {"vs": np.float64(0.1), "delta": np.float64(2.0)}
# A process of its own: how many programs it traced, and what came out.
SCRIPT = """
import json, sys
import jax, numpy as np
jax.config.update("jax_enable_x64", True)
from jaxswarm.effects import get_law
from jaxswarm.effects.sample import Sample
from jaxswarm.identify.forward.columns import _law
traced = []
def note(name, seconds, **more):
    if name.endswith("jaxpr_trace_duration"):
        traced.append(name)
jax.monitoring.register_event_duration_secs_listener(note)
fields = len(Sample._fields)
moved = Sample(*np.linspace(-1.0, 1.0, fields * 8).reshape(fields, 8))
values = {"vs": np.float64(0.1), "delta": np.float64(2.0)}
found = np.asarray(_law(get_law("stribeck_friction"), values, moved))
print(json.dumps([len(traced), found.tolist()]))
"""


def series(count: int = 8) -> Sample:
    fields = len(Sample._fields)
    return Sample(*np.linspace(-1.0, 1.0, fields * count).reshape(fields, count))


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """A folder for programs, whatever JAX keeps elsewhere."""
    monkeypatch.setattr(programs, "_folder", lambda: tmp_path)
    return tmp_path


def fresh() -> Program:
    """The program of laws as a new process has it."""
    return Program(columns._law.__wrapped__, ("law",))


def plain(law, moved) -> np.ndarray:
    return np.asarray(jax.jit(columns._law.__wrapped__, static_argnums=0)(law, VALUES, moved))


def test_another_process_traces_nothing(tmp_path):
    environment = {**os.environ, "JAX_COMPILATION_CACHE_DIR": str(tmp_path)}
    told = []
    for _ in range(2):
        words = [sys.executable, "-c", SCRIPT]
        done = subprocess.run(words, env=environment, check=True, capture_output=True, text=True)
        told.append(json.loads(done.stdout))
    (first, one), (second, two) = told
    assert first > 0 and second == 0
    assert one == two == plain(LAW, series()).tolist()


def test_what_was_kept_is_read_and_not_made(kept, monkeypatch):
    one = np.asarray(fresh()(LAW, VALUES, series()))
    monkeypatch.setattr(Program, "_compiled", lambda self, args: pytest.fail("made again"))
    assert (np.asarray(fresh()(LAW, VALUES, series())) == one).all()
    assert (one == plain(LAW, series())).all()


def test_other_shapes_other_laws_and_other_precision_are_other_programs(kept):
    fresh()(LAW, VALUES, series())
    fresh()(LAW, VALUES, series(16))
    fresh()(get_law("viscous_friction"), {}, series())
    with jax.enable_x64(False):
        low = fresh()(LAW, VALUES, series())
    assert low.dtype == np.float32
    assert len(list(kept.iterdir())) == 4


@pytest.mark.parametrize("content", [b"", b"nonsense", b"0\n" + b"x" * 100])
def test_a_damaged_program_is_made_anew(kept, content):
    one = np.asarray(fresh()(LAW, VALUES, series()))
    (path,) = kept.iterdir()
    whole = path.read_bytes()
    path.write_bytes(content or whole[: len(whole) // 2])
    assert (np.asarray(fresh()(LAW, VALUES, series())) == one).all()
    assert len(path.read_bytes()) > len(whole) // 2


def test_a_folder_that_takes_nothing_is_no_error(tmp_path, monkeypatch):
    path = tmp_path / "file"
    path.write_text("")
    monkeypatch.setattr(programs, "_folder", lambda: path / "under")
    assert np.asarray(fresh()(LAW, VALUES, series())).shape == (8, 1)


def test_other_source_is_another_program(kept, monkeypatch):
    fresh()(LAW, VALUES, series())
    monkeypatch.setattr(program_names, "_surroundings", lambda: "another version")
    fresh()(LAW, VALUES, series())
    assert len(list(kept.iterdir())) == 2


def test_a_law_of_somebody_else_is_compiled_and_not_kept(kept):
    law = TorqueLaw(
        name="own_drag",
        scope="joint",
        parameters=(Parameter("c", "N m", 0.0, 1.0, True, 0.1, ""),),
        summary="c dq^3",
        reference="",
        torque=lambda p, s: p["c"] * s.dq**3,
    )
    found = np.asarray(fresh()(law, {}, series()))
    np.testing.assert_allclose(found[:, 0], series().dq ** 3)
    assert not list(kept.iterdir())


def test_within_another_program_it_is_a_part_of_it(kept):
    double = Program(lambda x: 2.0 * x)
    assert jax.jit(lambda x: double(x) + 1.0)(jnp.ones(2)).tolist() == [3.0, 3.0]
    assert jax.vmap(double)(jnp.ones((2, 1))).tolist() == [[2.0], [2.0]]
    assert not list(kept.iterdir())


def test_every_law_has_a_text_of_its_own_that_holds():
    told = {name: program_names.described(law) for name, law in REGISTRY.items()}
    assert len(set(told.values())) == len(told)
    assert not any(" at 0x" in text for text in told.values())
    again = {name: program_names.described(law) for name, law in REGISTRY.items()}
    assert again == told


def test_what_a_function_holds_is_told():
    one, two = (functools.partial(direction.direction, width=w) for w in (0.1, 0.2))
    assert program_names.described(one) != program_names.described(two)
    with pytest.raises(program_names.Unknown):
        program_names.described(lambda x: x)


def test_a_program_that_others_may_have_written_is_not_run(kept):
    fresh()(LAW, VALUES, series())
    (one,) = kept.iterdir()
    assert program_files.read(one) is not None
    one.chmod(0o666)
    assert program_files.read(one) is None


def test_the_oldest_programs_make_room(kept, monkeypatch):
    for count in (8, 9, 10):
        fresh()(LAW, VALUES, series(count))
    old, *rest = sorted(kept.iterdir(), key=lambda p: p.stat().st_mtime)
    monkeypatch.setattr(program_files, "MOST", sum(p.stat().st_size for p in rest))
    program_files.make_room(kept)
    assert sorted(kept.iterdir()) == sorted(rest)


def test_room_is_made_at_the_first_of_many_programs(kept, monkeypatch):
    monkeypatch.setattr(program_files, "_WRITTEN", itertools.count())
    monkeypatch.setattr(program_files, "MOST", 0)
    left = []
    for count in range(8, 8 + program_files._EVERY + 1):
        fresh()(LAW, VALUES, series(count))
        left.append(len([*kept.iterdir()]))
    assert left == [*range(program_files._EVERY), 0]


def test_a_program_under_the_name_of_another_is_not_run(kept):
    fresh()(LAW, VALUES, series(8))
    fresh()(LAW, VALUES, series(16))
    one, two = sorted(kept.iterdir())
    content = one.read_bytes()
    one.write_bytes(two.read_bytes())
    two.write_bytes(content)
    assert program_files.read(one) is None and program_files.read(two) is None
    assert fresh()(LAW, VALUES, series(16)).shape == (16, 1)


def test_what_others_put_among_the_programs_stays(kept, monkeypatch):
    fresh()(LAW, VALUES, series())
    (one,) = kept.iterdir()
    (kept / "thesis.tex").write_text("years of work")
    (kept / ("a" * 64)).symlink_to(kept / "thesis.tex")
    (kept / ("b" * 64)).mkdir()
    monkeypatch.setattr(program_files, "MOST", 0)
    program_files.make_room(kept)
    left = {p.name for p in kept.iterdir()}
    assert left == {"thesis.tex", "a" * 64, "b" * 64} and one.name not in left


def test_nothing_is_written_or_changed_where_a_link_leads(tmp_path, monkeypatch):
    goal = tmp_path / "goal"
    goal.mkdir()
    goal.chmod(0o775)
    (tmp_path / "link").symlink_to(goal)
    monkeypatch.setattr(programs, "_folder", lambda: tmp_path / "link")
    assert np.asarray(fresh()(LAW, VALUES, series())).shape == (8, 1)
    assert list(goal.iterdir()) == [] and goal.stat().st_mode & 0o777 == 0o775


def test_what_stands_where_programs_belong_is_no_error(tmp_path, monkeypatch):
    monkeypatch.setattr(programs, "_folder", lambda: tmp_path / "gone")
    (tmp_path / "gone").symlink_to(tmp_path / "nowhere")
    assert np.asarray(fresh()(LAW, VALUES, series())).shape == (8, 1)
    assert not (tmp_path / "nowhere").exists()


def test_many_processes_may_write_at_once(tmp_path):
    environment = {**os.environ, "JAX_COMPILATION_CACHE_DIR": str(tmp_path)}
    words = [sys.executable, "-c", SCRIPT]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    every = [subprocess.Popen(words, env=environment, **pipes) for _ in range(3)]
    told = [one.communicate() for one in every]
    assert [one.returncode for one in every] == [0, 0, 0], told
    assert all(json.loads(out)[1] == plain(LAW, series()).tolist() for out, _ in told)
    (kept,) = (tmp_path / "jaxswarm-programs").iterdir()
    assert program_files.read(kept) is not None


def test_a_program_is_the_same_wherever_it_runs():
    asked = jax.config.values["jax_cpu_enable_async_dispatch"]
    told = set()
    for queue in (True, False):
        jax.config.update("jax_cpu_enable_async_dispatch", queue)
        told.add(program_names.settings())
    jax.config.update("jax_cpu_enable_async_dispatch", asked)
    assert len(told) == 1


@pytest.mark.parametrize("keeps", [True, False])
def test_threads_make_a_program_once_and_run_it_at_the_same_time(keeps, tmp_path, monkeypatch):
    monkeypatch.setattr(programs, "_folder", lambda: tmp_path if keeps else None)
    traced, both = [], threading.Barrier(2)

    def function(x):
        traced.append(x)

        def met(x):
            both.wait(timeout=30.0)  # of two runs one after the other the first would wait in vain
            return x

        once = jax.ShapeDtypeStruct(x.shape, x.dtype)
        return jax.lax.cond(x[0] > 0, lambda x: jax.pure_callback(met, once, x), lambda x: x, x)

    one = Program(function)
    with ThreadPoolExecutor(2) as pool:
        alone = list(pool.map(one, [np.zeros(2)] * 2))
        together = list(pool.map(one, [np.ones(2)] * 2))
    assert len(traced) == 1
    assert [float(x[0]) for x in (*alone, *together)] == [0.0, 0.0, 1.0, 1.0]
