"""Spoiled logs as files of every format; what a format cannot hold is left as it was."""

from pathlib import Path

import numpy as np

from benchmarks.trust.good import JOINTS, STATE, columns, write_csv
from benchmarks.trust.mutate_bytes import spoil_bytes
from benchmarks.trust.mutate_log import Table, spoil_kinds, spoil_table
from benchmarks.trust.mutate_numbers import number, word

# Share of files whose bytes are spoiled as well.
_BYTES = 0.15
_SEPARATORS = (",", ",", ",", ";", "\t", " ", "|")
_ENCODINGS = ("utf-8", "utf-8", "utf-8", "utf-8-sig", "utf-16", "latin-1")


def spoiled_csv(rng: np.random.Generator, folder: Path) -> Path:
    """Text with another separator, encoding, ends of lines, comments or quotes."""
    path = write_csv(folder / "log.csv", spoil_table(rng, columns()), str(rng.choice(_SEPARATORS)))
    text = path.read_bytes().decode("utf-8", "surrogatepass")
    lines = text.split("\n")
    change = rng.integers(14)
    if change == 0:
        lines.insert(int(rng.integers(len(lines))), f"# {word(rng)}")
    elif change == 1:
        lines = lines[1:]
    elif change == 2:
        lines.insert(int(rng.integers(len(lines))), lines[0])
    elif change == 3:
        lines[int(rng.integers(len(lines)))] += "," + word(rng)
    elif change == 4:
        lines = [line.replace(".", ",") for line in lines]
    elif change == 5:
        lines[0] = ",".join(f'"{name}"' for name in lines[0].split(","))
    text = str(rng.choice(["\n", "\n", "\r\n", "\r"])).join(lines)
    path.write_bytes(text.encode(str(rng.choice(_ENCODINGS)), "replace"))
    return spoil_some(rng, path)


def arrays(rng: np.random.Generator) -> Table:
    """The log as arrays (T, n), or as columns; sometimes of other kinds."""
    table = spoil_table(rng, columns())
    if rng.random() < 0.5:
        stacked = {}
        for name in ("q", "dq", "tau", "temperature"):
            parts = [table[f"{name}_{j}"] for j in JOINTS if f"{name}_{j}" in table]
            if len({len(p) for p in parts}) == 1 and all(p.dtype.kind == "f" for p in parts):
                stacked[name] = np.stack(parts, axis=1)
        table = {**({"t": table["t"]} if "t" in table else {}), **stacked}
        if rng.random() < 0.5:
            names = (
                list(JOINTS) if rng.random() < 0.5 else [word(rng) for _ in range(rng.integers(4))]
            )
            table["joints"] = np.array([n.encode("utf-8", "replace").decode() for n in names])
    if table and rng.random() < 0.5:
        table = spoil_kinds(rng, table)
    return table


def spoiled_npz(rng: np.random.Generator, folder: Path) -> Path:
    """An archive, compressed or not."""
    path = folder / "log.npz"
    save = np.savez_compressed if rng.random() < 0.7 else np.savez
    named = {_safe(k): storable(v, allow=True) for k, v in arrays(rng).items()}
    save(
        path,
        **{k: v for k, v in named.items() if k not in ("file", "args", "kwds", "allow_pickle")},
    )
    return spoil_some(rng, path)


def spoiled_mat(rng: np.random.Generator, folder: Path) -> Path:
    """A MAT file of version 5, compressed or not."""
    from scipy import io as matlab

    path = folder / "log.mat"
    named = {_safe(k)[:31]: storable(v) for k, v in arrays(rng).items()}
    kept = {k: v for k, v in named.items() if k and k[0].isalpha() and k.isascii()}
    kept = {k: v for k, v in kept.items() if v.dtype.kind in "fiubcUS" and v.dtype != np.float16}
    matlab.savemat(path, kept, do_compression=bool(rng.integers(2)))
    return spoil_some(rng, path)


def spoiled_parquet(rng: np.random.Generator, folder: Path) -> Path:
    """Columns of equal length; other kinds where there is one for it."""
    import pyarrow as pa
    from pyarrow import parquet

    table = spoil_table(rng, columns())
    length = min((len(v) for v in table.values()), default=0)
    if table and rng.random() < 0.5:
        name = list(table)[rng.integers(len(table))]
        kind = str(rng.choice(["int32", "float32", "bool", "U8", "datetime64[s]"]))
        if table[name].dtype.kind == "f":
            with np.errstate(all="ignore"):
                table[name] = np.nan_to_num(table[name], posinf=9e9, neginf=-9e9).astype(kind)
    names = [_safe(k) for k in table]
    kept = [v[:length] for v in table.values()]
    kept = [v.astype(str) if v.dtype == object else v for v in kept]
    kept = [np.char.encode(v, "utf-8", "replace") if v.dtype.kind == "U" else v for v in kept]
    compression = str(rng.choice(["snappy", "zstd", "none"]))
    path = folder / "log.parquet"
    rows = pa.Table.from_arrays([pa.array(v) for v in kept], names=names)
    parquet.write_table(rows, path, compression=compression)
    return spoil_some(rng, path)


def spoiled_mcap(rng: np.random.Generator, folder: Path) -> Path:
    """A recording in one file."""
    return spoiled_states(rng, folder / "bag", "MCAP", ".mcap")


def spoiled_states(rng: np.random.Generator, bag: Path, storage: str, ending: str) -> Path:
    """A recording of joint states whose names, lengths and stamps may be wrong."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    table = columns()
    q, dq, tau = (np.stack([table[f"{k}_{j}"] for j in JOINTS], axis=1) for k in ("q", "dq", "tau"))
    with Writer(bag, version=9, storage_plugin=StoragePlugin[storage]) as writer:
        link = writer.add_connection("/joint_states", STATE, typestore=store)
        names, odd = list(JOINTS), rng.random(8) < 0.15
        for k in range(int(rng.choice([1, 3, 40, 120, 120]))):
            stamp = int(1e9 * (0.0 if odd[0] else table["t"][k])) + (
                0 if odd[1] else 1_700_000_000 * 10**9
            )
            rows = [np.array(x[k]) for x in (q, dq, tau)]
            if odd[2] and rng.random() < 0.1:
                rows[rng.integers(3)][rng.integers(2)] = number(rng)
            if odd[3] and rng.random() < 0.1:
                rows[rng.integers(3)] = np.zeros(rng.integers(4))
            if odd[4] and rng.random() < 0.1:
                names = [_safe(word(rng)) for _ in range(rng.integers(4))]
            if odd[5]:
                rows[int(rng.integers(3))] = np.zeros(0)
            if odd[6] and rng.random() < 0.1:
                stamp -= 10**9
            time = store.types["builtin_interfaces/msg/Time"](stamp // 10**9, stamp % 10**9)
            header = store.types["std_msgs/msg/Header"](time, "")
            raw = store.serialize_cdr(store.types[STATE](header, names, *rows), STATE)
            writer.write(link, 1_700_000_000 * 10**9 + k * 10**7, raw)
    (path,) = bag.glob(f"*{ending}")
    return spoil_some(rng, path)


def spoil_some(rng: np.random.Generator, path: Path) -> Path:
    if rng.random() < _BYTES:
        path.write_bytes(spoil_bytes(rng, path.read_bytes()))
    return path


def _safe(name: str) -> str:
    """A name that the writers take: no lone surrogates, no path."""
    return name.encode("utf-8", "replace").decode().replace("/", "_").replace("\x00", "_") or "_"


def storable(values: np.ndarray, allow: bool = False) -> np.ndarray:
    """Objects as text, except where pickles are to be tried."""
    values = np.asarray(values)
    if values.dtype == object and not allow:
        values = values.astype(str)
    if values.dtype.kind == "U":
        return np.char.decode(np.char.encode(values, "utf-8", "replace"), "utf-8")
    return values


LOGS = {
    "CSV": spoiled_csv,
    "NPZ": spoiled_npz,
    "MAT": spoiled_mat,
    "Parquet": spoiled_parquet,
    "MCAP": spoiled_mcap,
}
