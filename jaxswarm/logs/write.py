"""Write a log as CSV or NPZ, in the very form that :func:`jaxswarm.logs.read_log` reads.

Numbers keep all their digits, so a log survives the round trip bit for bit.
"""

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np

from jaxswarm.errors import InputError, printable
from jaxswarm.logs.log import Log


def write_log(log: Log, path: str | Path) -> None:
    """Write ``t``, ``q``, ``dq``, ``ddq``, ``tau`` and the channels of a log.

    Args:
        log: The log; columns without any finite number are left out.
        path: File ending in ``.csv`` or ``.npz``; an existing one is replaced.

    Raises:
        InputError: If the ending is another one or the file cannot be written.
    """
    path = Path(path)
    writers = {".csv": _write_csv, ".npz": _write_npz}
    writer = writers.get(path.suffix.lower())
    if writer is None:
        raise InputError(
            f"{path}: logs are written as {' or '.join(writers)}, not "
            f"{path.suffix or 'without an ending'}."
        )
    try:
        writer(log, path)
    except OSError as error:
        raise InputError(
            f"{path}: cannot be written ({error.strerror}). Choose another place."
        ) from error


def _arrays(log: Log) -> dict[str, np.ndarray]:
    given = {"q": log.q, "dq": log.dq, "ddq": log.ddq, "tau": log.tau, **log.channels}
    return {name: values for name, values in given.items() if values is not None}


def _write_csv(log: Log, path: Path) -> None:
    names, columns = ["t"], [log.t]
    for name, values in _arrays(log).items():
        if values.ndim == 1:
            names.append(name)
            columns.append(values)
            continue
        for joint, column in zip(log.joints, values.T, strict=True):
            if np.isfinite(column).any():
                names.append(f"{name}_{joint}")
                columns.append(column)
    write_table(path, names, np.stack(columns, axis=1), "%.17g")


def write_table(path: Path, names: list[str], table: np.ndarray, form: str) -> None:
    """Write numbers as CSV in UTF-8 under a header that any reader, a spreadsheet too, takes as names.

    Args:
        path: File to write.
        names: Names of the k columns; quoted where they hold commas, control characters escaped.
        table: Shape (T, k).
        form: Format of a number, such as ``"%.10g"``.
    """
    header = io.StringIO()
    # A spreadsheet computes what begins so; none of our quantities does, channels of a user may.
    names = [f"'{name}" if name[:1] in "=+-@" else name for name in map(printable, names)]
    csv.writer(header, lineterminator="").writerow(names)
    np.savetxt(
        path,
        table,
        fmt=form,
        delimiter=",",
        header=header.getvalue(),
        comments="",
        encoding="utf-8",
    )


def _write_npz(log: Log, path: Path) -> None:
    with path.open("wb") as handle:
        arrays: dict[str, Any] = _arrays(log)
        np.savez_compressed(handle, t=log.t, joints=np.array(log.joints, dtype=str), **arrays)
