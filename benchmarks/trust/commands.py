"""Whole commands with odd options and spoiled files, each in a process of its own.

Most are copies of one process that has loaded everything, which takes a tenth of the time; every tenth one is
started anew.
"""

import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.trust.command_files import Files
from benchmarks.trust.forked import run_copy
from benchmarks.trust.mutate_numbers import INTEGERS, number, word
from benchmarks.trust.oracle import LONGEST
from benchmarks.trust.rows import FINDINGS, add_row, read_rows

# Time [s] a command may take, work included; address space [KiB] it may have.
SLOWEST, _SPACE = 300.0, 24 * 2**20
# Share of options whose value is odd.
_ODD = 0.25
_EFFECTS = (
    *(
        "none",
        "viscous_friction",
        "coulomb_friction,viscous_friction",
        "joint_spring@joint1",
        "payload",
    ),
    *(
        "contact,payload",
        "viscous_friction,viscous_friction",
        "hysteresis@joint2",
        "temperature_friction",
    ),
    *(
        "time_delay",
        "backlash@joint2",
        "transmission_coupling@joint1",
        "stribeck_friction",
        "base_tilt",
    ),
)


def _value(rng: np.random.Generator, *right) -> str:
    if rng.random() > _ODD:
        return str(right[rng.integers(len(right))])
    odd = (number(rng), INTEGERS[rng.integers(len(INTEGERS))], word(rng).replace("\x00", ""))
    return str(odd[rng.integers(3)])


def _options(rng: np.random.Generator, table: dict[str, tuple]) -> list[str]:
    """Some of the options of a command, a switch without a value."""
    given = []
    for name, right in table.items():
        if rng.random() < 0.25:
            given += [name, _value(rng, *right)] if right else [name]
    return given


_ARM = {
    "--joints": ("joint1", "joint1,joint2", "joint2"),
    "--lock": ("joint2", "joint1=0.3"),
    "--tool": ("1,0,0,0.1", "1,0,0,0.1,1,0,1,0,0,1"),
    "--gravity": ("0,0,-9.81", "0,0,0"),
}
_FIT = {
    **_ARM,
    "--seed": (0, 3),
    "--motion-cutoff": (8, 20),
    "--torque-cutoff": (5, 10),
    "--accept": ("no_relation", "spikes", "saturation"),
    "--json": (),
    "--plain": (),
    "--quiet": (),
}


def _identify(rng, files, out):
    more = {
        **_FIT,
        "--optimizer": ("least_squares", "gpso"),
        "--runs": (1, 2),
        "--steps": (5,),
        "--estimator": ("least_squares", "instrumental", "output_error"),
        "--physical": (),
        "--free-base": (),
        "--raw": (),
        "--prior": (files.robot(),),
        "--prior-weight": (0.03, 1),
        "--validation": (files.log(),),
    }
    effects = _value(rng, *_EFFECTS)
    return [
        files.log(),
        "--robot",
        files.robot(),
        "--effects",
        effects,
        "--out",
        out,
        *_options(rng, more),
    ]


def _diagnose(rng, files, out):
    more = {**_FIT, "--validation": (files.log(),), "--budget": (1, 20)}
    base = (
        ["--model", files.model()] if rng.random() < 0.5 else ["--declare", _value(rng, *_EFFECTS)]
    )
    return [files.log(), "--robot", files.robot(), *base, "--out", out, *_options(rng, more)]


def _predict(rng, files, out):
    return [files.model(), files.log(), "--out", f"{out}.csv", *_options(rng, {"--json": ()})]


def _simulate(rng, files, out):
    more = {"--kp": (100, "100,50"), "--kd": (10,), "--feedforward": ("rigid", "none"), "--rate": (50, 200),
            "--playback": ()}  # fmt: skip
    return [files.model(), "--reference", files.log(), "--out", f"{out}.csv", *_options(rng, more)]


def _export(rng, files, out):
    kind = _value(rng, "urdf", "mjcf", "yaml", "c")
    more = {"--log": (files.log(),), "--prior": (files.robot(),), "--prior-weight": (0.03,)}
    return [files.model(), "--format", kind, "--out", f"{out}.txt", *_options(rng, more)]


def _excite(rng, files, out):
    more = {**_ARM, "--effects": _EFFECTS, "--duration": (2, 10), "--seed": (1,)}
    return [
        "--robot",
        files.robot(),
        "--limits",
        files.limits(),
        "--out",
        out,
        *_options(rng, more),
    ]


def _inspect(rng, files, out):
    more = {"--robot": (files.robot(),), "--out": (out,), "--json": ()}
    return [files.log(), files.log(), *_options(rng, more)]


def _compare(rng, files, out):
    return [files.model(), files.model()]


def _show(rng, files, out):
    return ["show", files.robot(), *_options(rng, {**_ARM, "--out": (f"{out}.png",), "--json": ()})]


Maker = Callable[[np.random.Generator, Files, Path], list]
COMMANDS: dict[str, Maker] = {
    "identify": _identify,
    "diagnose": _diagnose,
    "predict": _predict,
    "simulate": _simulate,
    "export": _export,
    "excite": _excite,
    "inspect": _inspect,
    "compare": _compare,
    "robots": _show,
}


def run_commands(count: int) -> None:
    """Run commands up to a number; those of earlier runs are not run again."""
    done = {row["command"] for row in read_rows("fuzz") if row["kind"] == "command"}
    for k in range(count):
        if k not in done:
            add_row("fuzz", one_command(k))


def one_command(k: int) -> dict:
    """Make and run the command of a number, and say what was wrong with how it ended."""
    with tempfile.TemporaryDirectory(prefix="trust-") as place:
        folder = Path(place)
        rng = np.random.default_rng([k, 500])
        name = list(COMMANDS)[k % len(COMMANDS)]
        out = folder / "out"
        words = [name, *COMMANDS[name](rng, Files(rng, folder), out)]
        words = [str(w).replace("\x00", "") for w in words]
        words = [w.encode("utf-8", "replace").decode() for w in words]
        before = {p for p in folder.rglob("*")}
        start = time.perf_counter()
        code, text, told = _run(words, anew=k % 10 == 0)
        seconds = time.perf_counter() - start
        new = sorted(str(p.relative_to(folder)) for p in {*folder.rglob("*")} - before)
        finding = _wrong(code, text, told, new, seconds)
        if finding:
            shutil.copytree(folder, FINDINGS / f"command{k}", dirs_exist_ok=True)
    shown = [w.replace(place, ".") for w in words]
    row = {"kind": "command", "command": k, "name": name, "code": code, "seconds": seconds}
    return {**row, "finding": finding, "words": [w[:100] for w in shown]}


def _run(words: list[str], anew: bool) -> tuple[int, str, str]:
    place = Path(__file__).resolve().parents[2]
    if not anew:
        code, *texts = run_copy(words, place, SLOWEST, 1024 * _SPACE)
        return code, *(x.decode("utf-8", "replace") for x in texts)
    shell = f'ulimit -v {_SPACE} && exec "$0" -m jaxswarm "$@"'
    try:
        ended = subprocess.run(
            ["sh", "-c", shell, sys.executable, *words],
            capture_output=True,
            timeout=SLOWEST,
            check=False,
            cwd=place,
        )
    except subprocess.TimeoutExpired:
        return -1, "", "out of time"
    return ended.returncode, *(x.decode("utf-8", "replace") for x in (ended.stdout, ended.stderr))


def _wrong(code: int, text: str, told: str, new: list[str], seconds: float) -> str:
    if code not in (0, 2):
        return f"ended with {code}: {told[-LONGEST:]}"
    if "Traceback" in told:
        return f"traceback: {told[-LONGEST:]}"
    if any(not c.isprintable() and c != "\n" for c in told):
        return f"control characters: {told[:LONGEST]!r}"
    if code == 2 and (new or text):
        return f"refused, but wrote {new or text[:200]}"
    if code == 2 and not told.strip():
        return "refused without a word"
    return ""
