"""Small logs that the tests write, damage and read back."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet
from scipy import io

from jaxswarm.logs import Log, read_log, write_log

JOINTS = ("joint1", "joint2")


def make_log(samples: int = 60, joints: tuple[str, ...] = JOINTS, seed: int = 0) -> Log:
    """A smooth motion with noisy torque at 100 Hz, and one channel of each kind."""
    rng = np.random.default_rng(seed)
    t = np.arange(samples) * 0.01
    phase = np.arange(len(joints))
    q = np.sin(8.0 * t[:, None] + phase)
    return Log(
        source="made",
        joints=joints,
        t=t,
        q=q,
        dq=8.0 * np.cos(8.0 * t[:, None] + phase),
        ddq=-64.0 * q,
        tau=3.0 * q + rng.normal(size=q.shape),
        channels={"temperature": 20.0 + rng.random(q.shape), "ambient": rng.random(samples)},
    )


def table_of(log: Log) -> dict[str, np.ndarray]:
    """Columns as in a CSV file."""
    table = {"t": log.t}
    for name, values in arrays_of(log).items():
        if values.ndim == 1:
            table[name] = values
        else:
            table |= {f"{name}_{joint}": values[:, k] for k, joint in enumerate(log.joints)}
    return table


def arrays_of(log: Log) -> dict[str, np.ndarray]:
    """Arrays as in an NPZ file, without t and joints."""
    arrays = {"q": log.q, "dq": log.dq, "ddq": log.ddq, "tau": log.tau, **log.channels}
    return {name: values for name, values in arrays.items() if values is not None}


def write_table(path: Path, table: dict[str, np.ndarray]) -> Path:
    """Write columns in the order of the dictionary, by the ending of the path."""
    if path.suffix == ".csv":
        rows = zip(*table.values(), strict=True)
        text = "\n".join(",".join(repr(float(cell)) for cell in row) for row in rows)
        path.write_text(",".join(table) + "\n" + text + "\n")
    elif path.suffix == ".parquet":
        parquet.write_table(pa.table(table), path)
    elif path.suffix == ".mat":
        io.savemat(path, table)
    else:
        np.savez(path, **table)
    return path


def write_text(folder: Path, header: str, rows: list[str]) -> Path:
    """Write a CSV from its lines."""
    path = folder / "log.csv"
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def damaged(folder: Path, row: int, text: str) -> Path:
    """A good CSV log of two joints whose row (from 1) is replaced."""
    log = make_log(30)
    path = folder / "log.csv"
    write_log(Log("made", JOINTS, log.t, log.q, tau=log.tau), path)
    lines = path.read_text().splitlines()
    lines[row] = text
    path.write_text("\n".join(lines) + "\n")
    return path


def assert_same(one: Log, other: Log) -> None:
    """Every number of two logs is the same."""
    assert one.joints == other.joints
    assert np.array_equal(one.t, other.t)
    for name in ("q", "dq", "ddq", "tau"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name
    assert set(one.channels) == set(other.channels)
    for name, values in one.channels.items():
        assert np.array_equal(values, other.channels[name], equal_nan=True), name


def read(path: Path, **options) -> Log:
    """Read with the joints of :func:`make_log`."""
    return read_log(path, JOINTS, **options)
