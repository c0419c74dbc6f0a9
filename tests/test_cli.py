"""The command line: every command, JSON that parses, and one message with exit code 2 for bad input."""

import json

import numpy as np
import pytest
import typer
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from slide import EFFECTS, assert_refused, identify, run, slide_log

import jaxswarm
from jaxswarm.cli import app, main


@pytest.fixture(scope="module", autouse=True)
def quiet_cache(tmp_path_factory):
    """Compiled programs of these commands stay out of the user's cache."""
    import jax

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("JAX_COMPILATION_CACHE_DIR", str(tmp_path_factory.mktemp("compiled")))
        before = jax.config.jax_persistent_cache_min_compile_time_secs
        yield
        jax.config.update("jax_persistent_cache_min_compile_time_secs", before)


def test_the_version_is_told():
    code, out, _ = run("--version")
    assert code == 0 and out.split() == ["jaxswarm", jaxswarm.__version__]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a log, a second log and the results of one identification."""
    path = tmp_path_factory.mktemp("cli")
    (path / "log.csv").write_text("\n".join(slide_log()) + "\n")
    (path / "other.csv").write_text("\n".join(slide_log(300, 1)) + "\n")
    code, out, err = run(
        "identify", path / "log.csv", "--robot", "emps", "--effects", EFFECTS, "--out", path / "out",
        "--validation", path / "other.csv", "--json",
    )  # fmt: skip
    assert code == 0, err
    (path / "stdout.json").write_text(out)
    return path


def test_identify_writes_what_it_promises(folder):
    report = json.loads((folder / "stdout.json").read_text())
    names = {path.name for path in (folder / "out").iterdir()}
    assert {"model.json", "identification.json", "torque.png", "residual.png"} <= names
    assert json.loads((folder / "out" / "identification.json").read_text()) == report
    values = {row["name"]: row["value"] for row in report["base_parameters"]}
    assert values["m1"] == pytest.approx(20, rel=0.01)
    assert values["b_slide"] == pytest.approx(30, rel=0.05)
    assert values["fc_slide"] == pytest.approx(5, rel=0.05)
    assert report["torque_units"] == ["N"]
    assert report["error"]["validation"]["relative_global"] < 0.05
    assert (folder / "out" / "torque.png").read_bytes().startswith(b"\x89PNG")


def test_free_base_fits_the_direction_of_gravity(folder, tmp_path):
    code, out, _ = identify(folder / "log.csv", tmp_path / "out", "--free-base", "--json")
    assert code == 0
    tilt = [t for t in json.loads(out)["effects"] if t["effect"] == "base_tilt"]
    # A slide along x that stands tilted feels its weight as a constant force; this one stands level.
    assert len(tilt) == 1 and abs(tilt[0]["parameters"]["gx"]["value"]) < 0.02


def test_identify_prints_tables_without_json(folder, tmp_path):
    search = ("--optimizer", "gpso", "--runs", 2, "--steps", 60)
    code, out, err = identify(folder / "log.csv", tmp_path / "out", *search)
    assert code == 0, err
    assert "fc_slide" in out and "above the least-squares optimum" in out
    assert (tmp_path / "out" / "convergence.png").exists()


def test_predict_keeps_the_time_stamps(folder, tmp_path):
    model, log = folder / "out" / "model.json", folder / "other.csv"
    code, out, err = run("predict", model, log, "--out", tmp_path / "new" / "pred.csv", "--json")
    assert code == 0, err
    result = json.loads(out)
    table = np.loadtxt(tmp_path / "new" / "pred.csv", delimiter=",", skiprows=1)
    given_ = np.loadtxt(log, delimiter=",", skiprows=1)
    assert (tmp_path / "new" / "pred.csv").read_text().splitlines()[0] == "t,tau_slide"
    np.testing.assert_allclose(table[:, 0], given_[:, 0], atol=1e-9)
    assert np.linalg.norm(table[:, 1] - given_[:, 2]) < 0.1 * np.linalg.norm(given_[:, 2])
    assert result["samples"] == 300


def test_predict_needs_no_torque(folder, tmp_path):
    lines = [line.rsplit(",", 1)[0] for line in slide_log(300, 1)]
    (tmp_path / "motion.csv").write_text("\n".join(lines))
    model, out = folder / "out" / "model.json", tmp_path / "pred.csv"
    assert run("predict", model, tmp_path / "motion.csv", "--out", out)[0] == 0
    assert len(out.read_text().splitlines()) == 301


@pytest.mark.parametrize("command", ["effects", "robots", "optimizers"])
def test_lists(command):
    code, out, _ = run(command, "--json")
    rows = json.loads(out)
    assert code == 0
    assert len(rows) >= 5
    names = [row[command.removesuffix("s")] for row in rows]
    code, out, _ = run(command)
    assert code == 0
    assert all(name in out for name in names)


def test_help_of_every_command():
    code, out, _ = run("--help")
    assert code == 0
    for command in ("identify", "predict", "effects", "robots", "optimizers"):
        assert command in out
        assert run(command, "--help")[0] == 0


def commands_of(group, words=()):
    """Every command with the words that call it."""
    for name, command in group.commands.items():
        yield (*words, name), command
        if hasattr(command, "commands"):
            yield from commands_of(command, (*words, name))


def test_help_stands_whole_at_80_columns_and_ends_with_an_example(monkeypatch):
    """No word of an option's help is cut, folded away or taken for markup."""
    monkeypatch.setattr("typer.rich_utils.MAX_WIDTH", 80)
    seen = []
    for words, command in commands_of(typer.main.get_command(app)):
        code, out, _ = run(*words, "--help")
        assert code == 0 and "\N{HORIZONTAL ELLIPSIS}" not in out, words
        assert max(map(len, out.splitlines())) <= 80
        assert f"Example: jaxswarm {' '.join(words)}" in " ".join(out.split()), words
        shown = "".join(c for c in out if not c.isspace() and c not in "│╭╮╰╯─")
        for option in command.params:
            for word in (getattr(option, "help", None) or "").split():
                assert word in shown, (words, option.name, word)
        seen.append(words)
    assert len(seen) > 15


@pytest.mark.parametrize(
    "arguments",
    [
        ("identfy",),
        ("identify",),
        ("identify", "log.csv", "--robot", "emps", "--effects", "none"),
        (
            "identify",
            "log.csv",
            "--robot",
            "emps",
            "--effects",
            "none",
            "--out",
            "o",
            "--runs",
            "0",
        ),
        (
            "identify",
            "log.csv",
            "--robot",
            "emps",
            "--effects",
            "none",
            "--out",
            "o",
            "--seed",
            "x",
        ),
        ("predict", "model.json"),
        ("effects", "--jason"),
    ],
)
def test_usage_errors_end_with_two(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(*arguments)
    assert code == 2
    assert out == ""
    assert "Traceback" not in err and "Error" in err
    assert list(tmp_path.iterdir()) == []


def replace_cell(row, column, text):
    lines = slide_log()
    cells = lines[row].split(",")
    cells[column] = text
    return [*lines[:row], ",".join(cells), *lines[row + 1 :]]


def rename(old, new):
    lines = slide_log()
    return [lines[0].replace(old, new), *lines[1:]]


def backwards():
    lines = slide_log()
    return [*lines[:50], lines[80], *lines[50:]]


def at_rest():
    return ["t,q_slide,tau_slide", *(f"{k / 100},0.25,{k % 7}" for k in range(600))]


BAD_LOGS = {
    "missing column": ([line.rsplit(",", 1)[0] for line in slide_log()], ["tau_slide"]),
    "misnamed column": (rename("q_slide", "position_slide"), ["q_slide", "position_slide"]),
    "joints of another robot": (
        ["t,q1,q2,tau1,tau2", *(f"{k / 100},{k},{k},1,1" for k in range(100))],
        ["q2"],
    ),
    "text in a cell": (replace_cell(17, 1, "abc"), ["17", "q_slide", "abc"]),
    "NaN in a cell": (replace_cell(23, 2, "nan"), ["23", "tau_slide"]),
    "time backwards": (backwards(), ["row 51", "backwards"]),
    "too few samples": (slide_log(12), ["12 samples"]),
    "joint that never moves": (at_rest(), ["slide", "never moves"]),
    "empty": ([""], ["empty"]),
    "header only": (slide_log()[:1], ["header"]),
}


@pytest.mark.parametrize("kind", BAD_LOGS)
def test_bad_logs_are_refused(kind, tmp_path):
    lines, words = BAD_LOGS[kind]
    (tmp_path / "bad.csv").write_text("\n".join(lines) + "\n")
    assert_refused(identify(tmp_path / "bad.csv", tmp_path / "out"), "bad.csv", *words)
    assert [path.name for path in tmp_path.iterdir()] == ["bad.csv"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"robot": "emp"}, ["emp", "emps"]),
        ({"robot": "missing.urdf"}, ["missing.urdf"]),
        ({"effects": "viscous"}, ["viscous_friction"]),
        ({"effects": "viscous_friction@joint3"}, ["joint3", "slide"]),
        ({"effects": "viscous_friction,viscous_friction"}, ["twice"]),
    ],
)
def test_unknown_names_are_refused_with_the_nearest(folder, tmp_path, change, words):
    assert_refused(identify(folder / "log.csv", tmp_path / "out", **change), *words)
    assert list(tmp_path.iterdir()) == []


def test_unknown_optimizer(folder, tmp_path):
    result = identify(folder / "log.csv", tmp_path / "out", "--optimizer", "gspo")
    assert_refused(result, "gspo", "gpso")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("text", ["", "<robot", "<robot name='x'></robot>", "no xml at all"])
def test_urdf_that_does_not_parse(folder, tmp_path, text):
    (tmp_path / "arm.urdf").write_text(text)
    result = identify(folder / "log.csv", tmp_path / "out", robot=str(tmp_path / "arm.urdf"))
    assert_refused(result, "no moving joint" if "x" in text and "</robot>" in text else "arm.urdf")
    assert not (tmp_path / "out").exists()


def test_output_that_cannot_be_written(folder, tmp_path):
    (tmp_path / "file").write_text("in the way")
    for out in (tmp_path / "file", tmp_path / "file" / "deeper"):
        assert_refused(identify(folder / "log.csv", out), "--out")
    model, log = folder / "out" / "model.json", folder / "log.csv"
    assert_refused(run("predict", model, log, "--out", tmp_path), "is a folder")
    assert_refused(run("predict", model, log, "--out", tmp_path / "file" / "p.csv"), "--out")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_missing_logs_and_models(folder, tmp_path):
    assert_refused(identify(folder / "lg.csv", tmp_path / "out"), "lg.csv", "log.csv")
    none = tmp_path / "none.json"
    assert_refused(
        run("predict", none, folder / "log.csv", "--out", tmp_path / "p.csv"), "none.json"
    )
    (tmp_path / "m.json").write_text('{"format": 1}')
    assert_refused(
        run("predict", tmp_path / "m.json", folder / "log.csv", "--out", tmp_path / "p.csv"),
        "robot",
    )
    assert [path.name for path in tmp_path.iterdir()] == ["m.json"]


def test_cutoff_out_of_range(folder, tmp_path):
    result = identify(folder / "log.csv", tmp_path / "out", "--torque-cutoff", "80")
    assert_refused(result, "80", "50")


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_random_damage_never_gives_a_traceback(folder, tmp_path, data):
    lines = slide_log(40)
    row = data.draw(st.integers(0, 40))
    column = data.draw(st.integers(0, 2))
    text = data.draw(
        st.one_of(
            st.text(max_size=6),
            st.sampled_from(["nan", "inf", "-1e400", "1e308", "", "0x1", "1,2"]),
        )
    )
    cells = lines[row].split(",")
    cells[column] = text
    lines[row] = ",".join(cells)
    (tmp_path / "bad.csv").write_bytes("\n".join(lines).encode("utf-8", "surrogatepass"))
    model = folder / "out" / "model.json"
    code, out, err = run("predict", model, tmp_path / "bad.csv", "--out", tmp_path / "pred.csv")
    assert code in (0, 2), err
    assert "Traceback" not in err
    if code == 2:
        assert_refused((code, out, err), "bad.csv")
        assert not (tmp_path / "pred.csv").exists()
    else:
        assert np.isfinite(np.loadtxt(tmp_path / "pred.csv", delimiter=",", skiprows=1)).all()
        (tmp_path / "pred.csv").unlink()


def test_keyboard_interrupt_says_so(monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("jaxswarm.cli.app", interrupt)
    assert run("effects") == (130, "", "interrupted\n")


@pytest.mark.parametrize(
    "words", [["--out", ""], ["--out="], ["--robot", " "], ["--effects="], [""]]
)
def test_an_empty_word_is_refused_before_it_means_a_folder(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    given = ["identify", "log.csv", "--robot", "rx60", "--effects", "none", "--out", "out", *words]
    monkeypatch.setattr("sys.argv", ["jaxswarm", *given])
    with pytest.raises(SystemExit) as end:
        main()
    told = capsys.readouterr().err
    assert end.value.code == 2 and "an empty word" in told and words[0].partition("=")[0] in told
    assert not list(tmp_path.iterdir())
