"""Logs in HDF5, MAT 7.3 among them, and in structures of MATLAB, written by h5py and scipy."""

import numpy as np
import pytest
from log_samples import JOINTS, make_log, read
from scipy import io

from jaxswarm.errors import InputError
from jaxswarm.logs import Reading

h5py = pytest.importorskip("h5py")
LOG = make_log()
GOOD = {"t": LOG.t, "q": LOG.q, "dq": LOG.dq, "tau": LOG.tau}


def same(log):
    assert np.array_equal(log.t, LOG.t) and np.array_equal(log.q, LOG.q)
    assert np.array_equal(log.tau, LOG.tau)


def write(path, content, names=None):
    with h5py.File(path, "w") as file:
        for name, values in content.items():
            file[name] = values
        if names is not None:
            file["joints"] = list(names)
    return path


def matlab(path, content, names=()):
    """A file as MATLAB's ``save -v7.3`` writes it: transposed, with its classes, names by reference."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in content.items():
            data = file.create_dataset(name, data=np.atleast_2d(values).T)
            data.attrs["MATLAB_class"] = np.bytes_("double")
            group = name.rpartition("/")[0]
            if group:
                file[group].attrs["MATLAB_class"] = np.bytes_("struct")
        cells = []
        for k, name in enumerate(names):
            cell = file.create_dataset(f"#refs#/{k}", data=np.array([[ord(c)] for c in name], "u2"))
            cells.append(cell.ref)
        if cells:
            data = file.create_dataset("joints", data=np.array([cells], dtype=h5py.ref_dtype))
            data.attrs["MATLAB_class"] = np.bytes_("cell")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512))
    return path


def test_arrays_of_a_file_or_of_one_group(tmp_path):
    same(read(write(tmp_path / "a.h5", GOOD)))
    same(read(write(tmp_path / "b.hdf5", {f"run/arm/{name}": x for name, x in GOOD.items()})))
    swapped = write(tmp_path / "c.h5", GOOD, names=JOINTS[::-1])
    assert np.array_equal(read(swapped).q, LOG.q[:, ::-1])


def test_episodes_of_a_demonstration(tmp_path):
    content = {}
    for k in range(2):
        content[f"data/demo_{k}/obs/qpos"] = LOG.q + k
        content[f"data/demo_{k}/obs/qvel"] = LOG.dq
        content[f"data/demo_{k}/effort"] = LOG.tau
        content[f"data/demo_{k}/time"] = LOG.t
    path = write(tmp_path / "demos.hdf5", content)
    with pytest.raises(InputError, match="several logs, in data/demo_0, data/demo_1"):
        read(path)
    log = read(path, reading=Reading(topic="data/demo_1"))
    assert np.array_equal(log.q, LOG.q + 1) and np.array_equal(log.tau, LOG.tau)
    with pytest.raises(InputError, match="no group"):
        read(path, reading=Reading(topic="data/demo_7"))


@pytest.mark.parametrize("inside", ["", "run/"])
def test_matlab_of_version_7_3(tmp_path, inside):
    path = matlab(tmp_path / "log.mat", {inside + name: x for name, x in GOOD.items()})
    same(read(path))


def test_matlab_names_by_reference(tmp_path):
    path = matlab(tmp_path / "log.mat", GOOD, names=JOINTS[::-1])
    assert np.array_equal(read(path).q, LOG.q[:, ::-1])


def test_matlab_structures(tmp_path):
    path = tmp_path / "log.mat"
    io.savemat(path, {"run": GOOD, "kp": 3.0})
    log = read(path)
    same(log)
    assert "The log is the structure run." in log.notes
    io.savemat(path, {"first": GOOD, "other": {"log": {**GOOD, "q": LOG.q + 1.0}}})
    with pytest.raises(InputError, match="--topic first"):
        read(path)
    assert np.array_equal(read(path, reading=Reading(topic="other.log")).q, LOG.q + 1.0)


def test_names_and_texts_are_no_numbers(tmp_path):
    log = read(write(tmp_path / "a.h5", {**GOOD, "operator": "somebody"}))
    same(log)
    assert any(note.startswith("operator was left out") for note in log.notes)


def test_a_topic_of_a_file_with_one_log_is_refused(tmp_path):
    path = tmp_path / "log.npz"
    np.savez(path, **GOOD)
    with pytest.raises(InputError, match="holds one log"):
        read(path, reading=Reading(topic="run"))
