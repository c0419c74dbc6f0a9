"""The command as a process: streams that are narrow, full or closed, signals, no home, odd names."""

import errno
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from slide import EFFECTS, assert_refused, identify, run, slide_log

from jaxswarm import terminal, work

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("\n".join(slide_log()) + "\n")
    return path


def start(*arguments, **options):
    """The command as a process of its own."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **options.pop("env", {})}
    return subprocess.Popen(
        [sys.executable, "-m", "jaxswarm", *map(str, arguments)],
        env={name: value for name, value in environment.items() if value is not None},
        stderr=subprocess.PIPE,
        **{"stdout": subprocess.PIPE, **options},
    )


def finish(process):
    out, err = process.communicate(timeout=120)
    err = err.decode()
    assert "Traceback" not in err and "Exception ignored" not in err, err
    return process.returncode, (out or b"").decode("utf-8", "backslashreplace"), err


def test_a_terminal_without_greek_letters(tmp_path):
    log = tmp_path / "φ.csv"
    log.write_text("\n".join(slide_log()) + "\n")
    narrow = {"PYTHONIOENCODING": "ascii", "LANG": "C"}
    arguments = ("identify", log, "--robot", "emps", "--effects", EFFECTS, "--out", tmp_path / "ψ")
    code, out, err = finish(start(*arguments, env={**narrow, "COLUMNS": "200"}))
    assert code == 0, err
    assert "fc_slide" in out and "\\u03c8" in out
    narrow |= {"LC_ALL": "C", "PYTHONUTF8": "0"}  # then names of files are no text either
    code, out, err = finish(start(*arguments, "--json", env=narrow))
    assert code == 0, err
    assert os.fsencode(json.loads(out)["logs"][0]["source"]) == os.fsencode(log)
    code, _, err = finish(start("predict", "θ.json", log, "--out", "p.csv", env=narrow))
    assert code == 2 and err.startswith("error: ") and err.isascii()


def test_stdout_full_closed_or_unread():
    with open("/dev/full", "wb") as full:
        code, _, err = finish(start("effects", stdout=full))
    assert code == 2 and err.startswith("error: cannot print the result (No space left on device)")
    assert "--out" not in err  # there is none: the command only prints
    reader, writer = os.pipe()
    os.close(reader)
    code, _, err = finish(start("effects", "--json", stdout=writer))
    os.close(writer)
    assert (code, err) == (141, "")
    closed = start("effects", "--json", preexec_fn=lambda: os.close(1), stdout=None)
    assert finish(closed)[0] == 0


def test_a_full_stdout_names_the_files_that_are_complete(tmp_path, log):
    out = tmp_path / "seen"
    with open("/dev/full", "wb") as full:
        code, _, err = finish(start("inspect", log, "--out", out, stdout=full))
    assert code == 2 and "cannot print the result" in err and str(out) in err
    assert (out / "inspection.json").is_file()


def test_a_failing_file_is_named_and_not_taken_for_a_full_stdout(capsys):
    def command():
        raise OSError(errno.EIO, "Input/output error", "/mnt/arm.csv")

    with pytest.raises(SystemExit, match="2"):
        work.run(command)
    assert capsys.readouterr().err == "error: /mnt/arm.csv: Input/output error\n"


def test_a_user_without_name_and_home(tmp_path, log):
    anonymous = """
import pwd, runpy, sys
def unknown(uid):
    raise KeyError(uid)
pwd.getpwuid = unknown
sys.argv[0] = "jaxswarm"
runpy.run_module("jaxswarm", run_name="__main__")
"""
    lost = (
        "HOME",
        "XDG_CACHE_HOME",
        "XDG_CONFIG_HOME",
        "MPLCONFIGDIR",
        "JAX_COMPILATION_CACHE_DIR",
    )
    environment = {name: value for name, value in os.environ.items() if name not in lost}
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    arguments = ("identify", log, "--robot", "emps", "--effects", "none", "--out", tmp_path / "out")
    ended = subprocess.run(
        [sys.executable, "-c", anonymous, *map(str, arguments)],
        env={**environment, "PYTHONPATH": str(ROOT), "TMPDIR": str(temporary)},
        capture_output=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr.decode()
    assert (tmp_path / "out" / "torque.png").exists()
    assert not list(temporary.iterdir())


@pytest.mark.parametrize(
    ("number", "code", "word"),
    [(signal.SIGTERM, 143, "terminated"), (signal.SIGINT, 130, "interrupted")],
)
def test_signals_end_the_work_with_a_word(tmp_path, number, code, word):
    out = tmp_path / "out"
    process = start("study", "sepso", "--out", out)
    while not Path(f"/proc/{process.pid}/maps").read_text().count("jaxlib"):
        time.sleep(0.05)  # still importing: the handlers stand before that
    time.sleep(1.0)
    process.send_signal(number)
    ended, _, err = finish(process)
    assert ended == code, err
    assert err.splitlines()[-1] == word
    assert not out.exists()


def test_an_interrupt_within_code_made_from_text(tmp_path):
    """Where a dataclass is being made, say: CPython would end the process by the signal itself."""
    (tmp_path / "made_from_text.py").write_text("""
import os, signal, time
from jaxswarm import work
text = "os.kill(os.getpid(), signal.SIGINT); time.sleep(5.0)"
work.run(lambda: exec(text, {"os": os, "signal": signal, "time": time}))
""")
    process = subprocess.Popen(
        [sys.executable, "-m", "made_from_text"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    code, _, err = finish(process)
    assert (code, err) == (130, "interrupted\n")


def test_an_interrupt_while_a_compiled_module_loads(capsys):
    def load():
        try:
            raise terminal.Interrupted
        except KeyboardInterrupt as signal_in_between:
            raise ImportError("error while initializing the extension") from signal_in_between

    with pytest.raises(SystemExit) as ended:
        work.run(load)
    assert ended.value.code == 130 and capsys.readouterr().err == "interrupted\n"

    def miss():
        raise ImportError("no such module")

    with pytest.raises(ImportError, match="no such module"):
        work.run(miss)


def test_names_that_are_no_unicode_or_too_long(tmp_path):
    log = tmp_path / os.fsdecode(b"log\xff.csv")
    log.write_text("\n".join(slide_log()) + "\n")
    code, out, err = identify(log, tmp_path / "out", "--json")
    assert code == 0, err
    assert json.loads(out)["logs"][0]["source"] == str(log)
    assert json.loads((tmp_path / "out" / "identification.json").read_bytes()) == json.loads(out)
    out = tmp_path / os.fsdecode(b"out\xff")
    assert identify(log, out)[0] == 0
    assert_refused(identify(log, tmp_path / ("n" * 300)), "too long")
    assert_refused(
        run("predict", out / "model.json", log, "--out", tmp_path / f"{'n' * 300}.csv"), "long"
    )


@pytest.mark.parametrize(
    "more",
    [
        ("--seed", 2**63),
        ("--seed", -1),
        ("--seed", "9" * 400),
        ("--runs", 10**12),
        ("--steps", 10**30),
        ("--motion-cutoff", "nan"),
        ("--torque-cutoff", "inf"),
    ],
)
def test_numbers_out_of_range(log, tmp_path, more):
    code, out, err = identify(log, tmp_path / "out", "--optimizer", "spso", *more)
    assert (code, out) == (2, "") and more[0] in err
    assert not (tmp_path / "out").exists()


def test_the_largest_seed(log, tmp_path):
    search = ("--optimizer", "spso", "--runs", 2, "--steps", 5, "--seed", 2**63 - 1)
    assert identify(log, tmp_path / "out", *search)[0] == 0


def test_control_characters_of_columns_never_reach_the_terminal(log, tmp_path):
    lines = slide_log()
    lines[0] = lines[0].replace("q_slide", "q_sl\x1b[31mide")
    log.write_text("\n".join(lines))
    code, out, err = identify(log, tmp_path / "out")
    assert code == 2 and "\x1b" not in out + err and "\\x1b[31m" in err
    lines = [line + ",1" for line in slide_log()]
    lines[0] = lines[0][:-1] + "evil\x1b]0;title\x07[/b]"
    log.write_text("\n".join(lines))
    code, out, err = identify(log, tmp_path / "out")
    assert code == 0 and not {"\x1b", "\x07"} & set(out + err)


def test_a_message_that_quotes_a_huge_text_stays_short(tmp_path):
    code, out, err = run("robots", "show", "x" * 100_000)
    assert code == 2 and out == "" and len(err) < 2000
    assert "unknown robot" in err and err.rstrip().endswith("ur10e.")


@pytest.mark.parametrize("error", [terminal.Interrupted, terminal.Terminated, ValueError])
def test_a_signal_where_nothing_can_be_raised_prints_no_traceback(error, monkeypatch):
    """As while garbage is collected: the interpreter would print it and go on."""
    told = []
    monkeypatch.setattr(sys, "unraisablehook", told.append)

    class Collected:
        def __del__(self):
            raise error

    with terminal.catch_termination():
        Collected()
    assert [lost.exc_type for lost in told] == ([ValueError] if error is ValueError else [])


FINISHED = """
import atexit, builtins
from jaxswarm import cli
class Held:
    def __del__(self):
        print("taken down", flush=True)
builtins.held = Held()
atexit.register(print, "left for the end")
cli._command = lambda: print("done")
cli.command_line()
"""


def test_a_finished_command_ends_without_taking_down_what_it_holds():
    command = [sys.executable, "-c", FINISHED]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and done.stderr == ""
    assert done.stdout == "done\nleft for the end\n"
