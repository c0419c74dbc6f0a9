"""``diagnose --discover`` and ``--effects-from``: the law in every file, its own file read only when named."""

import json
import os

import numpy as np
import pytest
from slide import EFFECTS, assert_refused, identify, run

from jaxswarm.effects import REGISTRY

NAME = "discovered_slide"


def write_log(path, seed: int) -> None:
    """A slide of 20 kg with friction that rides over a magnet at q = 0.05 m."""
    rng = np.random.default_rng(seed)
    t = np.arange(1600) * 0.01
    w = 2 * np.pi * np.array([0.1, 0.4, 1.1])[:, None]
    size = np.array([[0.1], [0.15], [0.04]]) * rng.uniform(0.8, 1.2, (3, 1))
    q, dq = (size * np.sin(w * t)).sum(axis=0), (size * w * np.cos(w * t)).sum(axis=0)
    ddq = -(size * w**2 * np.sin(w * t)).sum(axis=0)
    tau = 20 * ddq + 30 * dq + 5 * np.tanh(dq / 0.01) + 0.1 * rng.normal(size=len(t))
    tau += 9.0 * np.exp(-(((q - 0.05) / 0.04) ** 2)) * q / 0.1
    np.savetxt(path, np.column_stack([t, q, tau]), delimiter=",", header="t,q_slide,tau_slide",
               comments="")  # fmt: skip


@pytest.fixture(autouse=True)
def forget():
    """Laws of files are not known to other tests."""
    yield
    REGISTRY.pop(NAME, None)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """Two logs of the slide and the diagnosis of one, scored on the other."""
    path = tmp_path_factory.mktemp("discover")
    with pytest.MonkeyPatch.context() as patch:
        if "JAX_COMPILATION_CACHE_DIR" not in os.environ:
            patch.setenv("JAX_COMPILATION_CACHE_DIR", str(path / "compiled"))
        for k in range(2):
            write_log(path / f"{k}.csv", k)
        code, out, err = run(
            "diagnose", path / "0.csv", "--robot", "emps", "--declare", EFFECTS, "--discover",
            "--validation", path / "1.csv", "--out", path / "out",
        )  # fmt: skip
        assert code == 0, err
        yield path, out


def test_report_and_files_tell_the_law(found):
    path, out = found
    result = json.loads((path / "out" / "diagnosis.json").read_text())
    (entry,) = result["discovered"]
    assert entry["joint"] == "slide" and "q_slide" in entry["formula"]
    assert {row["unit"] for row in entry["parameters"].values()} <= {"N", "N/m", "m", "1", "N/m^2"}
    assert entry["range"][0]["unit"] == "m"
    assert result["error"]["after"]["rms"][0] < 0.3 * result["error"]["before"]["rms"][0]
    page = (path / "out" / "report.html").read_text()
    assert "A law of its own on slide" in page and "LaTeX" in page
    assert "a law of its own on slide" in out
    terms = json.loads((path / "out" / "model.json").read_text())["terms"]
    assert terms[-1]["formula"]["terms"] and "lambda" not in json.dumps(terms)
    assert {entry["file"], entry["picture"]} <= {p.name for p in (path / "out").iterdir()}


def torque_of(path, model, out, *more):
    code, _, err = run("predict", model, path / "1.csv", "--out", out, *more)
    assert code == 0, err
    return np.loadtxt(out, delimiter=",", skiprows=1)[:, 1]


def test_the_written_file_is_the_same_law(found, tmp_path):
    path, _ = found
    law = path / "out" / f"{NAME}.py"
    effects = f"{EFFECTS},{NAME}"
    code, _, err = identify(
        path / "0.csv", tmp_path / "own", "--effects-from", law, effects=effects
    )
    assert code == 0, err
    first = torque_of(path, path / "out" / "model.json", tmp_path / "a.csv")
    REGISTRY.pop(NAME)
    own = tmp_path / "own" / "model.json"
    again = torque_of(path, own, tmp_path / "b.csv", "--effects-from", law)
    assert np.abs(first - again).max() < 0.02 * np.abs(first).max()
    REGISTRY.pop(NAME)
    refused = run("predict", own, path / "1.csv", "--out", tmp_path / "c.csv")
    assert_refused(refused, NAME, "--effects-from")
    code, _, err = run("simulate", own, "--reference", path / "1.csv", "--out", tmp_path / "s.csv",
                       "--effects-from", law)  # fmt: skip
    assert code == 0, err


def test_a_file_may_be_edited_and_read_again(found, tmp_path):
    text = (found[0] / "out" / f"{NAME}.py").read_text()
    law = tmp_path / "law.py"
    for summary in ("first", "second"):
        law.write_text(
            text + f"\nfrom dataclasses import replace\nlaw = replace(law, summary='{summary}')\n"
        )
        from jaxswarm.effects import register_from

        assert register_from(law) == (NAME,)
        assert REGISTRY[NAME].summary == summary


BAD = {
    "no_such.py": (None, "no Python file"),
    "law.txt": ("", "no Python file"),
    "empty.py": ("x = 1\n", "holds no effect"),
    "broken.py": ("def f(:\n", "SyntaxError"),
    "raises.py": ("1 / 0\n", "ZeroDivisionError"),
    "ends.py": ("raise SystemExit(0)\n", "SystemExit"),
    "taken.py": (
        "from jaxswarm.effects import REGISTRY\nfrom dataclasses import replace\n"
        "law = replace(REGISTRY['viscous_friction'], summary='mine')\n",
        "registered already",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", sorted(BAD))
def test_files_that_cannot_be_used_are_refused(found, tmp_path, name):
    text, words = BAD[name]
    if text is not None:
        (tmp_path / name).write_text(text)
    out = tmp_path / "pred.csv"
    result = run("predict", found[0] / "out" / "model.json", found[0] / "1.csv", "--out", out,
                 "--effects-from", tmp_path / name)  # fmt: skip
    assert_refused(result, name, words)
    assert not out.exists()


def test_a_model_has_nothing_to_discover(found, tmp_path):
    path, _ = found
    result = run("diagnose", path / "1.csv", "--robot", "emps", "--model",
                 path / "out" / "model.json", "--discover", "--out", tmp_path / "x")  # fmt: skip
    assert_refused(result, "--discover")
