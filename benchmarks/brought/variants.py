"""One motion written in every way that people write logs; each is read the same, told of, or refused.

The worst outcome is a log that is read otherwise than it is meant without a word: "wrong and silent".
"""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.brought.formats import (
    Columns,
    arrays,
    columns,
    hdf5,
    lerobot,
    mat,
    parquet,
    renamed,
    scaled,
    text,
)
from benchmarks.brought.recordings import BAGS, have_rosbags, written_bag
from jaxswarm.errors import InputError
from jaxswarm.identify.checks.check_log import checked
from jaxswarm.identify.synthetic import demo_case, synthetic_log
from jaxswarm.logs import Log, LogChoice, parse_reading, read_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot import Robot, rx60

SAME, TOLD, REFUSED, WRONG = "the same", "otherwise, and told", "refused", "wrong and silent"
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


def variants(log: Log, folder: Path) -> dict[str, Callable[[], object]]:
    """Name of a variant to what writes it and gives its path, with how to read it where that is said."""
    plain, whole = columns(log), arrays(log)
    deg, start = 180.0 / np.pi, np.datetime64("2026-03-01T08:00:00", "ns")
    stamps = start + (whole["t"] * 1e9).round().astype("timedelta64[ns]")
    dates = [str(stamp).replace("T", " ") for stamp in stamps]

    def said(path: Path, *words: str | None) -> LogChoice:
        return LogChoice(path, parse_reading(*words))

    def csv_of(table: Columns, **how: str) -> Path:
        return text(folder / "log.csv", table, **how)

    def dated() -> Path:
        path = csv_of(plain)
        lines = path.read_text().splitlines()
        cells = [
            ",".join([d, *line.split(",")[1:]]) for d, line in zip(dates, lines[1:], strict=True)
        ]
        path.write_text("\n".join([lines[0], *cells]))
        return path

    def savetxt() -> Path:
        table = np.column_stack(list(plain.values()))
        np.savetxt(folder / "log.csv", table, delimiter=",", header=",".join(plain))
        return folder / "log.csv"

    def raw(change: Callable[[bytes], bytes]) -> Path:
        path = csv_of(plain)
        path.write_bytes(change(path.read_bytes()))
        return path

    def npz(content: dict) -> Path:
        np.savez(folder / "log.npz", **content)
        return folder / "log.npz"

    def short(name: str) -> str:
        return name.replace("_joint", "")

    units = {
        "t [ms]": lambda: csv_of(
            renamed(scaled(plain, "t", 1e3), lambda n: n.replace("t", "t [ms]", n == "t"))
        ),
        "q [deg] in the header": lambda: csv_of(
            renamed(scaled(plain, "q", deg), lambda n: f"{n} [deg]" if n[0] == "q" else n)
        ),
        "degrees, nothing said": lambda: csv_of(scaled(plain, "q", deg)),
        "degrees, --columns q:deg": lambda: said(csv_of(scaled(plain, "q", deg)), "q:deg"),
        "milliseconds, nothing said": lambda: csv_of(scaled(plain, "t", 1e3)),
        "microseconds, nothing said": lambda: csv_of(scaled(plain, "t", 1e6)),
        "milliseconds, --columns t:ms": lambda: said(csv_of(scaled(plain, "t", 1e3)), "t:ms"),
        "N mm, nothing said": lambda: csv_of(scaled(plain, "tau", 1e3)),
        "kN m, nothing said": lambda: csv_of(scaled(plain, "tau", 1e-3)),
        "N mm, --columns tau:Nmm": lambda: said(csv_of(scaled(plain, "tau", 1e3)), "tau:Nmm"),
        "flipped sign of torque": lambda: csv_of(scaled(plain, "tau", -1.0)),
    }
    texts = {
        "commas": lambda: csv_of(plain),
        "short names q1, tau1": lambda: csv_of(renamed(plain, short)),
        "semicolons": lambda: csv_of(plain, mark=";"),
        "tabs": lambda: csv_of(plain, mark="\t"),
        "semicolons and decimal commas": lambda: csv_of(plain, mark=";", decimal=","),
        "tabs and decimal commas": lambda: csv_of(plain, mark="\t", decimal=","),
        "header after numpy.savetxt": savetxt,
        "comment lines before the header": lambda: csv_of(plain, head="# arm 3\n# cell 7\n"),
        "byte-order mark": lambda: raw(lambda b: b"\xef\xbb\xbf" + b),
        "Windows line ends": lambda: raw(
            lambda b: b.replace(b"\r\n", b"\n").replace(b"\n", b"\r\n")
        ),
        "UTF-16": lambda: raw(lambda b: b.decode().encode("utf-16")),
        "no header": lambda: raw(lambda b: b.split(b"\n", 1)[1]),
        "last row cut": lambda: raw(lambda b: b[:-25]),
        "dates and hours as t": dated,
        "a column of text": lambda: raw(
            lambda b: (
                b.replace(b"\r\n", b"\n")
                .replace(b"\n", b",run\n")
                .replace(b",run\n", b",mode\n", 1)
            )
        ),
        "index column of pandas": lambda: csv_of({"": np.arange(len(log.t)), **plain}),
        "time named time": lambda: csv_of(renamed(plain, lambda n: "time" if n == "t" else n)),
        "names of another tool, --columns": lambda: said(
            csv_of(columns(log, "{quantity} A{k}")), "q=q A{k},tau=tau A{k}"
        ),
        "names of another tool, nothing said": lambda: csv_of(columns(log, "{quantity} A{k}")),
        "joints in another order": lambda: csv_of(dict(reversed(plain.items()))),
        "one joint missing": lambda: csv_of({n: x for n, x in plain.items() if "joint3" not in n}),
    }
    binary = {
        "NPZ": lambda: npz(whole),
        "NPZ, joints named in another order": lambda: npz(
            {"t": whole["t"], "q": log.q[:, ::-1], "tau": whole["tau"][:, ::-1],
             "joints": np.array(log.joints[::-1])}
        ),
        "NPZ, transposed": lambda: npz({"t": whole["t"], "q": log.q.T, "tau": whole["tau"].T}),
        "NPZ, MuJoCo names, --columns": lambda: said(
            npz({"time": whole["t"], "qpos": log.q, "ctrl": whole["tau"]}), "t=time,q=qpos,tau=ctrl"
        ),
        "NPZ without a clock, --columns t:200 Hz": lambda: said(
            npz({"q": log.q, "tau": whole["tau"]}), "t:200 Hz"
        ),
        "NPZ, both sides of a gear": lambda: npz(
            {"t": whole["t"], "q_motor": log.q + 0.3, "q_link": log.q, "tau": whole["tau"]}
        ),
        "NPZ, both sides, --side link": lambda: said(
            npz({"t": whole["t"], "q_motor": log.q + 0.3, "q_link": log.q, "tau": whole["tau"]}),
            None, None, "link",
        ),
        "Parquet": lambda: parquet(folder / "log.parquet", plain),
        "Parquet of lists": lambda: parquet(folder / "log.parquet", whole),
        "Parquet with time stamps": lambda: parquet(folder / "log.parquet", {**plain, "t": stamps}),
        "LeRobot data set": lambda: lerobot(folder / "set", log),
        "MAT": lambda: mat(folder / "log.mat", whole),
        "MAT, a structure": lambda: mat(folder / "log.mat", {"run": whole}),
        "MAT, two structures": lambda: mat(folder / "log.mat", {"a": whole, "b": whole}),
        "HDF5": lambda: hdf5(folder / "log.h5", whole),
        "HDF5 in a group": lambda: hdf5(folder / "log.h5", whole, "runs/arm/"),
    }  # fmt: skip
    bags = {
        name: lambda kind=kind: written_bag(folder / "bag", log, kind)
        for name, kind in BAGS.items()
    }
    return {**texts, **units, **binary, **(bags if have_rosbags() else {})}


def outcome(name: str, given: object, robot: Robot, log: Log) -> Outcome:
    """Read a variant and judge it as ``identify`` would before it fits."""
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
