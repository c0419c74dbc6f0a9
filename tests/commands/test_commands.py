"""The commands on models, data and the installation: files in, files and JSON out, bad input told."""

import ast
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import typer
from slide import run

from jaxswarm.cli import app
from jaxswarm.logs import read_log

FRICTION = "viscous_friction,coulomb_friction"


@pytest.fixture(scope="module", autouse=True)
def quiet_cache(tmp_path_factory):
    """Compiled programs of these commands stay out of the user's cache."""
    import jax

    with pytest.MonkeyPatch.context() as patch:
        if "JAX_COMPILATION_CACHE_DIR" not in os.environ:
            patch.setenv("JAX_COMPILATION_CACHE_DIR", str(tmp_path_factory.mktemp("compiled")))
        before = jax.config.jax_persistent_cache_min_compile_time_secs
        yield
        jax.config.update("jax_persistent_cache_min_compile_time_secs", before)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A log of a slide and the model identified from it."""
    path = tmp_path_factory.mktemp("commands")
    t = np.arange(600) * 0.01
    w = 2 * np.pi * np.array([0.4, 1.1])[:, None]
    size = np.array([[0.2], [0.05]])
    q, dq = (size * np.sin(w * t)).sum(axis=0), (size * w * np.cos(w * t)).sum(axis=0)
    ddq = -(size * w**2 * np.sin(w * t)).sum(axis=0)
    noise = 0.1 * np.random.default_rng(0).normal(size=600)
    tau = 20 * ddq + 30 * dq + 5 * np.tanh(dq / 0.01) + noise
    np.savetxt(path / "log.csv", np.column_stack([t, q, tau]), delimiter=",",
               header="t,q_slide,tau_slide", comments="")  # fmt: skip
    code, _, err = run("identify", path / "log.csv", "--robot", "emps", "--effects", FRICTION,
                       "--out", path / "out")  # fmt: skip
    assert code == 0, err
    return path


def test_export_and_what_it_costs(folder, tmp_path):
    code, out, err = run("export", folder / "out" / "model.json", "--out", tmp_path / "slide.urdf",
                         "--json")  # fmt: skip
    assert code == 0, err
    # A mass without extent is no body: it is given some, which a slide does not feel.
    assert json.loads(out)["moved"]["rms"][0] < 0.01
    assert (tmp_path / "slide.urdf").exists() and (tmp_path / "slide.urdf.json").exists()
    code, out, _ = run("export", folder / "out" / "model.json", "--out", tmp_path / "slide.c")
    assert code == 0 and "emps_effects" in (tmp_path / "slide.c").read_text().lower()


def test_simulate_writes_a_log_that_reads_back(folder, tmp_path):
    code, out, err = run("simulate", folder / "out" / "model.json", "--reference", folder / "log.csv",
                         "--out", tmp_path / "motion.csv", "--kp", "4000", "--kd", "300", "--json")  # fmt: skip
    assert code == 0, err
    report = json.loads(out)
    assert report["gains"] == {"kp": [4000.0], "kd": [300.0]}
    log = read_log(tmp_path / "motion.csv", ("slide",))
    wanted = read_log(folder / "log.csv", ("slide",))
    error = np.abs(log.q - wanted.q).max()
    assert error == pytest.approx(report["tracking_error"]["largest"][0], rel=1e-3)


def test_compare_a_result_with_itself(folder):
    path = folder / "out" / "identification.json"
    code, out, err = run("compare", path, path, "--json")
    assert code == 0, err
    assert json.loads(out)["parameters"]
    assert not any(row["differs"] for row in json.loads(out)["parameters"])


def test_inspect_with_and_without_a_robot(folder, tmp_path):
    code, out, err = run(
        "inspect", folder / "log.csv", "--robot", "emps", "--out", tmp_path / "seen"
    )
    assert code == 0, err
    assert "condition number" in out and "reversals" in out
    report = json.loads((tmp_path / "seen" / "inspection.json").read_text())
    assert report["logs"][0]["samples"] == 600
    assert (tmp_path / "seen" / "signals.png").read_bytes().startswith(b"\x89PNG")
    code, out, _ = run("inspect", folder / "log.csv", "--json")
    assert code == 0 and json.loads(out)["logs"][0]["joints"][0]["name"] == "slide"


def test_the_doctor_finds_known_numbers():
    code, out, err = run("doctor", "--json")
    assert code == 0, err
    report = json.loads(out)
    assert report["healthy"] and report["double_precision"]
    assert report["versions"]["jax"] and report["devices"]
    assert report["check"]["m1"]["value"] == pytest.approx(20.0, rel=0.01)


BAD = {
    "no such file": ("export", "none.json", "--out", "x.urdf"),
    "names no format": ("export", "{model}", "--out", "x"),
    "Did you mean urdf": ("export", "{model}", "--out", "x.urdf", "--format", "urd"),
    "one number, or one a joint": (
        "simulate", "{model}", "--reference", "{log}", "--out", "x.csv", "--kp", "much",
    ),
    "ends in .csv": ("simulate", "{model}", "--reference", "{log}", "--out", "x.txt"),
    "two of the same kind": ("compare", "{model}", "{report}"),
    "unknown data": ("fetch", "nothing"),
}  # fmt: skip


@pytest.mark.parametrize("words", BAD)
def test_bad_input_is_one_message_and_writes_nothing(folder, tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    names = {
        "model": folder / "out" / "model.json",
        "log": folder / "log.csv",
        "report": folder / "out" / "identification.json",
    }
    code, out, err = run(*(part.format(**names) for part in BAD[words]))
    assert code == 2 and out == "", (code, out, err)
    assert words in err and "Traceback" not in err
    assert len([line for line in err.splitlines() if line.strip()]) == 1
    assert not list(tmp_path.iterdir())


def test_every_command_has_an_example_that_parses():
    commands = dict(typer.main.get_command(app).commands)
    inner = {f"robots {name}": one for name, one in commands["robots"].commands.items()}
    for name, command in {**commands, **inner}.items():
        found = re.search(rf"Example: jaxswarm ({name})(.*)", command.epilog or "")
        assert found, name
        options = {o for p in command.params for o in (*p.opts, *p.secondary_opts)}
        for word in found[2].split():
            assert not word.startswith("--") or word in options, (name, word)


def test_quiet_says_nothing_that_is_no_error(tmp_path):
    # The second joint follows the first: a note of the robot, which is told unless quiet is asked for.
    joints = "".join(
        f'<link name="l{k}"/><joint name="j{k}" type="revolute"><parent link="{parent}"/>'
        f'<child link="l{k}"/><axis xyz="0 0 1"/><limit effort="1" velocity="1"/>{mimic}</joint>'
        for k, parent, mimic in ((1, "base", ""), (2, "l1", '<mimic joint="j1"/>'))
    )
    path = tmp_path / "hand.urdf"
    path.write_text(f'<robot name="hand"><link name="base"/>{joints}</robot>')
    code, out, err = run("robots", "show", path)
    assert code == 0 and "hand: 1 moving joints" in out and "j2" in err
    assert run("--quiet", "robots", "show", path) == (0, "", "")


def test_help_imports_nothing_heavy():
    code = (
        "import sys; sys.argv = ['jaxswarm', '--help']\n"
        "import jaxswarm.cli, contextlib, io\n"
        "with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):\n"
        "    jaxswarm.cli.main()\n"
        "print([m for m in ('jax', 'numpy', 'scipy', 'matplotlib') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_commands_import_heavy_things_inside_functions_only():
    folder = Path(__file__).resolve().parents[2] / "jaxswarm" / "commands"
    light = {
        "jaxswarm.console",
        "jaxswarm.work",
        "jaxswarm.errors",
        "jaxswarm.runtime",
        "jaxswarm.commands",
        "jaxswarm.commands.logs",
        "jaxswarm.commands.options",
        "jaxswarm.commands.robots",
    }
    for path in folder.glob("*.py"):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.ImportFrom) and node.module.startswith("jaxswarm"):
                assert node.module in light or node.module == "jaxswarm", (path.name, node.module)


@pytest.mark.parametrize("place", [0, -1])
def test_quiet_prints_nothing_but_json(folder, place):
    words = ["compare", *[folder / "out" / "identification.json"] * 2]
    words.insert(place if place == 0 else len(words), "--quiet")
    assert run(*words) == (0, "", "")
    code, out, _ = run(*words, "--json")
    assert code == 0 and json.loads(out)


def test_plain_output_is_ascii_without_escapes(folder):
    path = folder / "out" / "identification.json"
    done = subprocess.run(
        [sys.executable, "-m", "jaxswarm", "compare", str(path), str(path), "--plain"],
        capture_output=True, check=True,
        env={**os.environ, "FORCE_COLOR": "1", "COLUMNS": "200"},
    )  # fmt: skip
    text = done.stdout.decode("ascii")
    assert "\x1b" not in text and "+-" in text and "viscous_friction" in text
