"""Further ways in: SDF, HDF5, rosbags, data sets of episodes, lists of columns, what a search goes on from."""

import json
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.trust import good
from benchmarks.trust.mutate_bytes import spoil_bytes
from benchmarks.trust.mutate_numbers import word
from benchmarks.trust.mutate_tree import spoil_json, spoil_toml
from benchmarks.trust.write_logs import (
    arrays,
    spoil_some,
    spoiled_parquet,
    spoiled_states,
    storable,
)

# Share of sets of files in which the description is spoiled, besides the data.
_DESCRIBED = 0.5
# What a file may say of the right log, and what it may say besides.
_READING = """
[columns]
t = { unit = "s" }
q = { name = "q_{joint}", unit = "rad", scale = [1.0, -2.0] }
tau = { name = "tau_joint{k}", scale = 100 }
temperature_joint1 = "temperature_joint2"
"""
_BESIDE = ('topic = "/joint_states"', 'side = "link"', 'effort = "torque"')


def spoiled_hdf5(rng: np.random.Generator, folder: Path) -> Path:
    """Arrays in the file, in a group, or in several."""
    import h5py

    path = folder / "log.h5"
    with h5py.File(path, "w") as file:
        for part in ((), ("a",), ("a", "b"))[rng.integers(3)] or ("",):
            place = file.create_group(part) if part else file
            for name, values in arrays(rng).items():
                values = storable(values)
                values = np.char.encode(values, "utf-8") if values.dtype.kind == "U" else values
                kind = h5py.string_dtype() if values.dtype.kind == "S" and values.ndim else None
                if values.dtype.kind not in "Mm" and storable_name(name) not in place:
                    place.create_dataset(storable_name(name), data=values, dtype=kind)
    return spoil_some(rng, path)


def storable_name(name: str) -> str:
    """A name that is no path, and not the place itself."""
    clean = name.encode("utf-8", "replace").decode().replace("/", "_").replace("\x00", "_")
    return clean if clean.strip(".") else "_"


def spoiled_bag(rng: np.random.Generator, folder: Path) -> Path:
    """A folder of a recording in a data base, its description spoiled as well; or the data base alone."""
    path = spoiled_states(rng, folder / "bag", "SQLITE3", ".db3")
    described = path.parent / "metadata.yaml"
    if rng.random() < _DESCRIBED:
        described.write_bytes(spoil_bytes(rng, described.read_bytes()))
    return path.parent if rng.random() < _DESCRIBED else path


def spoiled_episodes(rng: np.random.Generator, folder: Path) -> Path:
    """A data set of episodes: its description, and columns of arrays."""
    import pyarrow as pa
    from pyarrow import parquet

    features = {"observation.state": {"names": list(good.JOINTS)}}
    (folder / "meta").mkdir()
    info = folder / "meta" / "info.json"
    info.write_text(spoil_json(rng, json.dumps({"codebase_version": "v2.1", "features": features})))
    if rng.random() < _DESCRIBED:
        return spoiled_parquet(rng, folder)
    table = good.columns()
    length = len(table["t"])
    names = ("timestamp", "observation.state", "observation.effort", "episode_index")
    state, effort = (np.stack([table[f"{k}_{j}"] for j in good.JOINTS], 1) for k in ("q", "tau"))
    rows = [table["t"].tolist(), state.tolist(), effort.tolist(), [0] * length]
    for values in rows:
        if rng.random() < 0.2:
            odd = ([], [0.0], None, [None, 1.0], [1e308, 2.0], 3.0)[rng.integers(6)]
            fits = isinstance(odd, list) == isinstance(values[0], list) or odd is None
            values[int(rng.integers(length))] = odd if fits else None
    path = folder / "data" / "chunk-000" / "episode_000000.parquet"
    path.parent.mkdir(parents=True)
    parquet.write_table(pa.table(dict(zip(names, map(pa.array, rows), strict=True))), path)
    return spoil_some(rng, path) if rng.random() < _DESCRIBED else folder


def columns(rng, folder):
    """What a file does not say about itself, as a list or as a file, and a right log read by it."""
    from jaxswarm.logs import parse_reading, read_log

    beside = [line for line in _BESIDE if rng.random() < 0.1]
    text = spoil_toml(rng, "\n".join([*beside, _READING]))
    path = folder / "columns.toml"
    data = text.encode("utf-8", "replace")
    path.write_bytes(spoil_bytes(rng, data) if rng.random() < 0.2 else data)
    entries = ["t:s", "q=q_{joint}:rad", "tau=tau_joint{k}"]
    parts = ["t", "q", "tau", "q_joint1", "ms", "deg", "100 Hz", "q_{k}", "x[0:2]", word(rng)]
    for _ in range(rng.integers(1, 3)):
        cut = [parts[rng.integers(len(parts))] for _ in range(rng.integers(1, 4))]
        entries[rng.integers(len(entries))] = str(rng.choice(["=", ":"])).join(cut)
    listed = ",".join(entries)
    given = str(path) if rng.random() < _DESCRIBED else listed
    log = good.write_csv(folder / "log.csv", good.columns())
    topic, side = (word(rng) if rng.random() < 0.1 else None for _ in range(2))
    return lambda: read_log(log, good.JOINTS, reading=parse_reading(given, topic, side))


def kept(rng, folder):
    """What an interrupted diagnosis left: whatever it holds, it is read or counts as nothing."""
    from jaxswarm.diagnose.candidates.journal import FILE, Journal
    from jaxswarm.effects.term import Term

    term = Term("stribeck_friction", 0)
    Journal(folder, "of today").keep(0, {term: [{"vs": 0.1, "delta": 2.0}] * 3})
    path = folder / FILE
    text = spoil_json(rng, path.read_text())
    data = text.encode("utf-8", "replace")
    path.write_bytes(spoil_bytes(rng, data) if rng.random() < 0.3 else data)

    def call():
        found = Journal(folder, "of today").recall(0, term)
        if found not in (None, [{"vs": 0.1, "delta": 2.0}] * 3):
            raise ValueError("went on from what it had not written")

    return call


@cache
def _searched():
    """A search to go on from, and the bytes of its checkpoint."""
    import tempfile

    import jax

    from jaxswarm.swarm import Space, gpso, minimize_resumable

    def search(path: Path):
        return minimize_resumable(
            lambda x, args: (x**2).sum(), gpso(8), Space.vector([-1.0] * 2, [1.0] * 2),
            jax.random.key(0), num_steps=4, path=path, every=2,
        )  # fmt: skip

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "search.ckpt"
        found = search(path)
        return search, path.read_bytes(), np.asarray(found.params)


def checkpoint(rng, folder):
    """The file of a search, its bytes spoiled: refused, or the search it was."""
    search, content, params = _searched()
    path = folder / "search.ckpt"
    path.write_bytes(spoil_bytes(rng, content))

    def call():
        if not np.array_equal(np.asarray(search(path).params), params):
            raise ValueError("went on from what it had not written")

    return call
