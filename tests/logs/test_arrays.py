"""NPZ, MAT and Parquet: shapes, names and contents that are read or refused."""

import builtins
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
from log_samples import JOINTS, arrays_of, make_log, read, write_table

from jaxswarm.errors import InputError
from jaxswarm.logs import read_log

LOG = make_log()
GOOD = {"t": LOG.t, "q": LOG.q, "tau": LOG.tau}


def refuse(path, *parts, joints=JOINTS):
    with pytest.raises(InputError) as caught:
        read_log(path, joints)
    for part in (path.name, *parts):
        assert part in str(caught.value)


@pytest.mark.parametrize("suffix", [".npz", ".mat"])
@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"q": LOG.q.T}, "q has shape (2, 60), expected (T, n) = (60, 2). Transpose it"),
        ({"q": np.ones((60, 3))}, "The log has 3 joints, the robot 2 (joint1, joint2)"),
        ({"q": LOG.q[:-1]}, "q has shape (59, 2)"),
        ({"tau": np.ones((60, 2, 1))}, "tau has shape (60, 2, 1)"),
        ({"t": np.ones((6, 10))}, "t has shape (6, 10)"),
        ({"tau": LOG.tau + 1j}, "tau holds complex"),
        (
            {"joints": np.array(["joint1", "joint3"])},
            "joints names joint3, which the robot does not",
        ),
        ({"joints": np.array(["joint1", "joint1"])}, "joints names joint1 twice"),
        ({"joints": np.array(["a", "b", "c"])}, "the log has 3 joints (a, b, c)"),
        ({"joints": np.array([1.0, 2.0])}, "joints holds float64"),
        ({"q_joint1": LOG.t}, "both give q of joint1"),
        ({"temperature_joint1": LOG.t[:-3]}, "temperature_joint1 has shape"),
        ({"t": None}, "missing column t"),
        ({"q": None}, "missing columns q_joint1, q_joint2"),
        (
            {"q": None, "position": LOG.q},
            "Did you mean position? Rename it to q, or pass --columns q=position.",
        ),
        ({"tau": None}, "no torque"),
        ({"tau": None, "torque": LOG.tau}, "Did you mean torque? Rename it to tau"),
    ],
)
def test_refused_arrays(tmp_path, suffix, change, what):
    arrays = {name: values for name, values in (GOOD | change).items() if values is not None}
    refuse(write_table(tmp_path / f"log{suffix}", arrays), what)


def test_nan_is_named_by_row_and_column_of_the_file(tmp_path):
    tau = LOG.tau.copy()
    tau[6, 0] = np.nan
    arrays = GOOD | {"tau": tau, "joints": np.array(["joint2", "joint1"])}
    refuse(
        write_table(tmp_path / "log.npz", arrays),
        "row 7, column tau[:, 0] (joint2) holds no number",
    )


def test_objects_are_never_unpickled(tmp_path):
    path = tmp_path / "log.npz"
    np.savez(path, **GOOD, extra=np.array([{"a": 1}], dtype=object))
    refuse(path, "key extra holds Python objects")
    np.savez(path, t=LOG.t, q=LOG.q.astype(object))
    refuse(path, "key q holds Python objects")


def test_npy_in_place_of_npz(tmp_path):
    path = tmp_path / "log.npz"
    with path.open("wb") as handle:
        np.save(handle, LOG.q)
    refuse(path, "a single array")


def test_further_arrays_are_channels_or_told(tmp_path):
    further = {
        "temperature": np.full((60, 2), 30.0),
        "ambient": np.arange(60),
        "valid": np.ones(60, dtype=bool),
        "fs": np.array(100.0),
        "robot": np.array("arm"),
        "wide": np.ones((60, 7)),
    }
    log = read(write_table(tmp_path / "log.npz", GOOD | further))
    assert set(log.channels) == {"temperature", "ambient", "valid"}
    assert log.channels["ambient"].shape == (60,) and log.channels["valid"].dtype == np.float64
    for name in ("fs", "robot", "wide"):
        assert any(note.startswith(f"{name} was left out") for note in log.notes)


def test_columns_of_matlab_vectors(tmp_path):
    for column in (LOG.t[:, None], LOG.t[None, :]):
        path = write_table(tmp_path / "log.mat", GOOD | {"t": column, "ambient": column})
        log = read(path)
        assert np.array_equal(log.t, LOG.t) and np.array_equal(log.channels["ambient"], LOG.t)


@pytest.mark.parametrize(
    "names", [np.array(["joint2", "joint1"], dtype=object), np.array(["joint2", "joint1"])]
)
def test_matlab_names_in_a_cell_or_a_char_matrix(tmp_path, names):
    path = write_table(tmp_path / "log.mat", GOOD | {"joints": names})
    assert np.array_equal(read(path).q, LOG.q[:, ::-1])


def test_a_damaged_file_of_the_new_version_is_refused(tmp_path):
    path = tmp_path / "log.mat"
    path.write_bytes(b"MATLAB 7.3 MAT-file, Platform: PCWIN64".ljust(512))
    refuse(path, "cannot be read as MAT")


def test_parquet_with_list_columns_nulls_and_text(tmp_path):
    path = tmp_path / "log.parquet"
    table = {"t": LOG.t, "q": LOG.q.tolist(), "tau": LOG.tau.tolist(), "mode": ["run"] * 60}
    parquet.write_table(pa.table(table), path)
    log = read(path)
    assert np.array_equal(log.q, LOG.q) and np.array_equal(log.tau, LOG.tau)
    assert any(note.startswith("mode was left out") for note in log.notes)
    columns = {"t": LOG.t, "q1": LOG.q[:, 0], "q2": [None, *LOG.q[1:, 1].tolist()]}
    parquet.write_table(pa.table(columns), path)
    refuse(path, "row 1, column q2 holds no number")
    parquet.write_table(pa.table(columns | {"q1": ["a"] * 60}), path)
    refuse(path, "q1 holds string")
    parquet.write_table(pa.Table.from_arrays([pa.array([1.0])] * 2, names=["t", "t"]), path)
    refuse(path, "column t appears twice")
    parquet.write_table(pa.table({"t": LOG.t, "q": [[1.0]] * 59 + [[1.0, 2.0]]}), path)
    refuse(path, "q holds list")


def test_missing_package_names_the_extra(tmp_path, monkeypatch):
    real = builtins.__import__

    def blocked(name, *rest, **options):
        if name.split(".")[0] in ("pyarrow", "rosbags", "h5py"):
            raise ImportError(name)
        return real(name, *rest, **options)

    for name in [
        name for name in sys.modules if name.split(".")[0] in ("pyarrow", "rosbags", "h5py")
    ]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(builtins, "__import__", blocked)
    for suffix in (".parquet", ".mcap", ".h5"):
        path = tmp_path / f"log{suffix}"
        path.write_bytes(b"anything")
        refuse(path, "pip install 'jaxswarm[formats]'")


def test_paths_that_lead_nowhere(tmp_path):
    write_table(tmp_path / "train.npz", arrays_of(LOG) | {"t": LOG.t})
    refuse(tmp_path / "trian.npz", "no such file. Did you mean train.npz?")
    refuse(tmp_path / "nowhere" / "train.npz", "no such file")
    refuse(tmp_path, "is a folder")
    for name in ("log.xlsx", "log"):
        (tmp_path / name).write_text("t,q1")
        refuse(
            tmp_path / name,
            "unknown log format",
            ".csv, .npz, .parquet, .mat, .h5, .hdf5, .hdf, .mcap",
        )
