"""A log as columns or arrays, and writers of files as people have them."""

import csv
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from jaxswarm.logs import Log

Columns = dict[str, np.ndarray]


def columns(log: Log, name: str = "{quantity}_{joint}") -> Columns:
    """The log as columns; ``{k}`` in the name is the number of the joint."""
    found = {"t": log.t - log.t[0]}
    for quantity, values in (("q", log.q), ("tau", log.tau)):
        for k, joint in enumerate(log.joints):
            label = name.format(quantity=quantity, joint=joint, k=k + 1)
            found[label] = np.asarray(values)[:, k]
    return found


def arrays(log: Log) -> Columns:
    """The log as arrays."""
    return {"t": log.t - log.t[0], "q": log.q, "tau": np.asarray(log.tau)}


def text(path: Path, table: Columns, mark: str = ",", decimal: str = ".", head: str = "") -> Path:
    """Columns as text."""
    with path.open("w", newline="", encoding="utf-8") as file:
        file.write(head)
        writer = csv.writer(file, delimiter=mark, quoting=csv.QUOTE_NONE, escapechar="\\")
        writer.writerow(table)
        for row in zip(*table.values(), strict=True):
            writer.writerow([f"{x:.9g}".replace(".", decimal) for x in row])
    return path


def scaled(table: Columns, quantity: str, factor: float) -> Columns:
    """Columns of one quantity in another unit."""
    return {n: x * factor if n.split("_")[0] == quantity else x for n, x in table.items()}


def renamed(table: Columns, names: Callable[[str], str]) -> Columns:
    """Columns by other names."""
    return {names(name): values for name, values in table.items()}


def parquet(path: Path, table: dict) -> Path:
    """Columns or arrays as Parquet."""
    import pyarrow as arrow
    from pyarrow import parquet as file

    rows = {n: x.tolist() if getattr(x, "ndim", 1) == 2 else x for n, x in table.items()}
    file.write_table(arrow.table(rows), path)
    return path


def mat(path: Path, content: dict) -> Path:
    """Variables as a MAT file of version 5."""
    from scipy import io

    io.savemat(path, content)
    return path


def hdf5(path: Path, content: Columns, prefix: str = "") -> Path:
    """Arrays as HDF5."""
    import h5py

    with h5py.File(path, "w") as file:
        for name, values in content.items():
            file[prefix + name] = values
    return path


def lerobot(folder: Path, log: Log) -> Path:
    """A data set of one episode."""
    (folder / "meta").mkdir(parents=True)
    info = {"features": {"observation.state": {"names": list(log.joints)}}}
    (folder / "meta" / "info.json").write_text(json.dumps(info), encoding="utf-8")
    (folder / "data" / "chunk-000").mkdir(parents=True)
    table = arrays(log)
    parquet(
        folder / "data" / "chunk-000" / "file-000.parquet",
        {
            "timestamp": table["t"],
            "observation.state": table["q"],
            "observation.effort": table["tau"],
            "episode_index": np.zeros(len(log.t), dtype=int),
        },
    )
    return folder
