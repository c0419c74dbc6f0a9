"""One motion written in every way that people write logs; each is read the same, told of, or refused.

The worst outcome is a log that is read otherwise than it is meant without a word: "wrong and silent".
"""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.brought.files import Files
from benchmarks.brought.formats import (
    columns,
    hdf5,
    lerobot,
    mat,
    parquet,
    renamed,
    scaled,
)
from benchmarks.brought.recordings import BAGS, have_rosbags, written_bag
from jaxswarm.errors import InputError
from jaxswarm.identify.checks.check_log import checked
from jaxswarm.identify.synthetic import demo_case, synthetic_log
from jaxswarm.logs import Log, read_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot import Robot, rx60

SAME, TOLD, REFUSED, WRONG = "the same", "otherwise, and told", "refused", "wrong and silent"
_DEGREES = 180.0 / np.pi
Writers = dict[str, Callable[[], object]]
# Numbers that went through text of nine digits.
_CLOSE = 1e-6


class Outcome(NamedTuple):
    """How a variant ended."""

    name: str
    outcome: str
    said: str


def made() -> tuple[Robot, Log]:
    """A three-joint arm and its log; friction that is declared nowhere is no matter of formats."""
    arm, declared, _ = demo_case(rx60(), 1)
    return arm, synthetic_log(arm, declared, 1, rate=200.0)


def _short(name: str) -> str:
    return name.replace("_joint", "")


def _texts(f: Files) -> Writers:
    """Text files."""
    return {
        "commas": lambda: f.csv_of(f.plain),
        "short names q1, tau1": lambda: f.csv_of(renamed(f.plain, _short)),
        "semicolons": lambda: f.csv_of(f.plain, mark=";"),
        "tabs": lambda: f.csv_of(f.plain, mark="\t"),
        "semicolons and decimal commas": lambda: f.csv_of(f.plain, mark=";", decimal=","),
        "tabs and decimal commas": lambda: f.csv_of(f.plain, mark="\t", decimal=","),
        "header after numpy.savetxt": f.savetxt,
        "comment lines before the header": lambda: f.csv_of(f.plain, head="# arm 3\n# cell 7\n"),
        "byte-order mark": lambda: f.raw(lambda b: b"\xef\xbb\xbf" + b),
        "Windows line ends": lambda: f.raw(
            lambda b: b.replace(b"\r\n", b"\n").replace(b"\n", b"\r\n")
        ),
        "UTF-16": lambda: f.raw(lambda b: b.decode().encode("utf-16")),
        "no header": lambda: f.raw(lambda b: b.split(b"\n", 1)[1]),
        "last row cut": lambda: f.raw(lambda b: b[:-25]),
        "dates and hours as t": f.dated,
        "a column of text": lambda: f.raw(
            lambda b: (
                b.replace(b"\r\n", b"\n")
                .replace(b"\n", b",run\n")
                .replace(b",run\n", b",mode\n", 1)
            )
        ),
        "index column of pandas": lambda: f.csv_of({"": np.arange(len(f.log.t)), **f.plain}),
        "time named time": lambda: f.csv_of(renamed(f.plain, lambda n: "time" if n == "t" else n)),
        "names of another tool, --columns": lambda: f.said(
            f.csv_of(columns(f.log, "{quantity} A{k}")), "q=q A{k},tau=tau A{k}"
        ),
        "names of another tool, nothing said": lambda: f.csv_of(columns(f.log, "{quantity} A{k}")),
        "joints in another order": lambda: f.csv_of(dict(reversed(f.plain.items()))),
        "one joint missing": lambda: f.csv_of(
            {n: x for n, x in f.plain.items() if "joint3" not in n}
        ),
    }


def _units(f: Files) -> Writers:
    """Other units and signs."""
    return {
        "t [ms]": lambda: f.csv_of(
            renamed(scaled(f.plain, "t", 1e3), lambda n: n.replace("t", "t [ms]", n == "t"))
        ),
        "q [deg] in the header": lambda: f.csv_of(
            renamed(scaled(f.plain, "q", _DEGREES), lambda n: f"{n} [deg]" if n[0] == "q" else n)
        ),
        "degrees, nothing said": lambda: f.csv_of(scaled(f.plain, "q", _DEGREES)),
        "degrees, --columns q:deg": lambda: f.said(
            f.csv_of(scaled(f.plain, "q", _DEGREES)), "q:deg"
        ),
        "milliseconds, nothing said": lambda: f.csv_of(scaled(f.plain, "t", 1e3)),
        "microseconds, nothing said": lambda: f.csv_of(scaled(f.plain, "t", 1e6)),
        "milliseconds, --columns t:ms": lambda: f.said(f.csv_of(scaled(f.plain, "t", 1e3)), "t:ms"),
        "N mm, nothing said": lambda: f.csv_of(scaled(f.plain, "tau", 1e3)),
        "kN m, nothing said": lambda: f.csv_of(scaled(f.plain, "tau", 1e-3)),
        "N mm, --columns tau:Nmm": lambda: f.said(f.csv_of(scaled(f.plain, "tau", 1e3)), "tau:Nmm"),
        "flipped sign of torque": lambda: f.csv_of(scaled(f.plain, "tau", -1.0)),
    }


def _binary(f: Files) -> Writers:
    """Files of other tools."""
    return {
        "NPZ": lambda: f.npz(f.whole),
        "NPZ, joints named in another order": lambda: f.npz(
            {"t": f.whole["t"], "q": f.log.q[:, ::-1], "tau": f.whole["tau"][:, ::-1],
             "joints": np.array(f.log.joints[::-1])}
        ),
        "NPZ, transposed": lambda: f.npz({"t": f.whole["t"], "q": f.log.q.T, "tau": f.whole["tau"].T}),
        "NPZ, MuJoCo names, --columns": lambda: f.said(
            f.npz({"time": f.whole["t"], "qpos": f.log.q, "ctrl": f.whole["tau"]}), "t=time,q=qpos,tau=ctrl"
        ),
        "NPZ without a clock, --columns t:200 Hz": lambda: f.said(
            f.npz({"q": f.log.q, "tau": f.whole["tau"]}), "t:200 Hz"
        ),
        "NPZ, both sides of a gear": lambda: f.npz(
            {"t": f.whole["t"], "q_motor": f.log.q + 0.3, "q_link": f.log.q, "tau": f.whole["tau"]}
        ),
        "NPZ, both sides, --side link": lambda: f.said(
            f.npz({"t": f.whole["t"], "q_motor": f.log.q + 0.3, "q_link": f.log.q, "tau": f.whole["tau"]}),
            None, None, "link",
        ),
        "Parquet": lambda: parquet(f.folder / "log.parquet", f.plain),
        "Parquet of lists": lambda: parquet(f.folder / "log.parquet", f.whole),
        "Parquet with time stamps": lambda: parquet(f.folder / "log.parquet", {**f.plain, "t": f.stamps}),
        "LeRobot data set": lambda: lerobot(f.folder / "set", f.log),
        "MAT": lambda: mat(f.folder / "log.mat", f.whole),
        "MAT, a structure": lambda: mat(f.folder / "log.mat", {"run": f.whole}),
        "MAT, two structures": lambda: mat(f.folder / "log.mat", {"a": f.whole, "b": f.whole}),
        "HDF5": lambda: hdf5(f.folder / "log.h5", f.whole),
        "HDF5 in a group": lambda: hdf5(f.folder / "log.h5", f.whole, "runs/arm/"),
    }  # fmt: skip


def variants(log: Log, folder: Path) -> Writers:
    """Name of a variant to what writes it and gives its path, with how to read it where that is said."""
    f = Files(log, folder)
    bags: Writers = {
        name: lambda kind=kind: written_bag(folder / "bag", log, kind)
        for name, kind in BAGS.items()
    }
    return {**_texts(f), **_units(f), **_binary(f), **(bags if have_rosbags() else {})}


def outcome(name: str, given: object, robot: Robot, log: Log) -> Outcome:
    """Read a variant and check it as ``identify`` would before it fits."""
    try:
        found = read_log(given, robot.joints, np.asarray(robot.drive_gain))  # type: ignore[arg-type]
        noted, _ = checked(found, robot, Filtering())
    except InputError as error:
        return Outcome(name, REFUSED, str(error).rpartition("log.")[2])
    pairs = ((found.t - found.t[0], log.t - log.t[0]), (found.q, log.q), (found.tau, log.tau))
    same = all(
        one is not None
        and one.shape == two.shape
        and np.abs(one - two).max() < _CLOSE * (1 + np.abs(two).max())
        for one, two in pairs
    )
    if same:
        return Outcome(name, SAME, "")
    notes = " ".join(noted.notes)
    return Outcome(name, TOLD if notes else WRONG, notes)
