"""Small files that unpack to gigabytes: what is not needed is not unpacked, what is too much is refused."""

import io
import resource
import zipfile

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
from log_samples import JOINTS, arrays_of, make_log
from scipy import io as scipy_io

from jaxswarm.errors import InputError
from jaxswarm.logs import read_log

HUGE = 6 * 10**9


@pytest.fixture
def little_memory():
    """At most 1.5 GB beyond what the process has already; an unpacked file would not fit."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    now = next(
        int(line.split()[1]) * 1024
        for line in open("/proc/self/status", encoding="utf-8")
        if line.startswith("VmSize")
    )
    resource.setrlimit(resource.RLIMIT_AS, (now + 3 * 2**29, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)


def header(shape, kind="|u1"):
    """The first bytes of an NPY file of this shape."""
    buffer = io.BytesIO()
    description = {"descr": kind, "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(buffer, description)
    return buffer.getvalue()


def npz_with(path, name, shape):
    """An NPZ log with one more array of zeros, written in blocks; returns its size in bytes."""
    log = make_log()
    np.savez_compressed(path, t=log.t, joints=np.array(JOINTS), **arrays_of(log))
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
            file.write(header(shape))
            block = bytes(2**24)
            for start in range(0, 2**30, len(block)):
                file.write(block[: 2**30 - start])
    return path.stat().st_size


def test_an_unused_array_of_an_npz_is_not_unpacked(tmp_path, little_memory):
    assert npz_with(tmp_path / "log.npz", "camera", (2**30,)) < 2**23
    log = read_log(tmp_path / "log.npz", JOINTS)
    assert np.array_equal(log.q, make_log().q)
    assert any(note.startswith("camera was left out: shape (1073741824,)") for note in log.notes)


def test_positions_that_would_not_fit_are_refused(tmp_path, little_memory):
    log = make_log()
    with zipfile.ZipFile(tmp_path / "log.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        for name, values in {"t": log.t, "tau": log.tau}.items():
            buffer = io.BytesIO()
            np.save(buffer, values)
            archive.writestr(f"{name}.npy", buffer.getvalue())
        archive.writestr("q.npy", header((HUGE, 2)) + bytes(1000))
    with pytest.raises(InputError, match=r"89\.4 GiB of numbers, at most 2 GiB"):
        read_log(tmp_path / "log.npz", JOINTS)


@pytest.mark.parametrize("name", ["camera", "q_x"])
def test_a_mat_file_is_unpacked_within_bounds(tmp_path, little_memory, monkeypatch, name):
    monkeypatch.setattr("jaxswarm.logs.bounds.LARGEST_LOG", 2**29)
    log = make_log()
    arrays = {"t": log.t[:, None], "joints": np.array(JOINTS, dtype=object), **arrays_of(log)}
    arrays[name] = np.zeros((2**27, 1), dtype=np.uint8)
    scipy_io.savemat(tmp_path / "log.mat", arrays, do_compression=True)
    del arrays
    assert (tmp_path / "log.mat").stat().st_size < 2**21
    if name == "camera":
        read = read_log(tmp_path / "log.mat", JOINTS)
        assert any(note.startswith("camera was left out") for note in read.notes)
    else:
        with pytest.raises(InputError, match="1.0 GiB of numbers, at most 0.5 GiB"):
            read_log(tmp_path / "log.mat", JOINTS)


def test_a_parquet_column_that_repeats_itself_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("jaxswarm.logs.bounds.LARGEST_LOG", 2**26)
    index = pa.array(np.zeros(10**6, dtype=np.int8))
    column = pa.DictionaryArray.from_arrays(index, pa.array([1.0]))
    table = pa.table({"t": column})
    with parquet.ParquetWriter(tmp_path / "log.parquet", table.schema) as writer:
        for _ in range(20):
            writer.write_table(table)
    assert (tmp_path / "log.parquet").stat().st_size < 2**21
    with pytest.raises(InputError, match="0.1 GiB of numbers"):
        read_log(tmp_path / "log.parquet", JOINTS)


def test_text_columns_of_a_parquet_file_are_not_read(tmp_path, monkeypatch):
    log = make_log()
    columns = {"t": log.t, "text": ["x"] * len(log.t)}
    columns |= {
        f"{n}_{j}": getattr(log, n)[:, k] for n in ("q", "tau") for k, j in enumerate(JOINTS)
    }
    parquet.write_table(pa.table(columns), tmp_path / "log.parquet")
    asked = []
    read = parquet.ParquetFile.read
    monkeypatch.setattr(
        parquet.ParquetFile,
        "read",
        lambda self, columns: asked.append(columns) or read(self, columns=columns),
    )
    found = read_log(tmp_path / "log.parquet", JOINTS)
    assert "text" not in asked[0] and any(note.startswith("text was left") for note in found.notes)


def test_pipes_and_devices_are_no_logs(tmp_path):
    import os

    os.mkfifo(tmp_path / "log.csv")
    (tmp_path / "zero.csv").symlink_to("/dev/zero")
    for name in ("log.csv", "zero.csv"):
        with pytest.raises(InputError, match="device or a pipe"):
            read_log(tmp_path / name, JOINTS)
