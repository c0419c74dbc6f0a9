"""One log through every format, in any order of columns, reads as the same numbers."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from log_samples import JOINTS, arrays_of, assert_same, make_log, read, table_of, write_table

from jaxswarm.errors import InputError
from jaxswarm.logs import Log, read_log, take, write_log

RELAXED = settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@given(
    order=st.permutations(list(table_of(make_log()))),
    suffix=st.sampled_from([".csv", ".parquet", ".mat", ".npz"]),
    seed=st.integers(0, 100),
)
@RELAXED
def test_columns_in_any_order(tmp_path, order, suffix, seed):
    log = make_log(seed=seed)
    table = table_of(log)
    path = write_table(tmp_path / f"log{suffix}", {name: table[name] for name in order})
    assert_same(read(path), log)


@given(
    order=st.permutations(range(3)),
    suffix=st.sampled_from([".npz", ".mat"]),
    single=st.booleans(),
)
@RELAXED
def test_arrays_with_joints_in_any_order(tmp_path, order, suffix, single):
    names = ("shoulder", "elbow", "wrist")
    log = make_log(joints=names)
    kind = np.float32 if single else np.float64
    arrays = {
        name: (values[:, list(order)] if values.ndim == 2 else values).astype(kind)
        for name, values in arrays_of(log).items()
    }
    arrays |= {"t": log.t, "joints": np.array([names[k] for k in order])}
    found = read_log(write_table(tmp_path / f"log{suffix}", arrays), names)
    for name in ("q", "dq", "tau"):
        expected = getattr(log, name).astype(kind)
        assert np.array_equal(getattr(found, name), expected)
        assert getattr(found, name).dtype == np.float64


@pytest.mark.parametrize("suffix", [".csv", ".npz"])
@pytest.mark.parametrize("joints", [("slide",), JOINTS])
def test_written_logs_read_back_bit_for_bit(tmp_path, suffix, joints):
    log = make_log(joints=joints)
    write_log(log, tmp_path / f"log{suffix}")
    assert_same(read_log(tmp_path / f"log{suffix}", joints), log)


def test_write_refuses_other_endings_and_places(tmp_path):
    with pytest.raises(InputError, match=r"\.csv or \.npz"):
        write_log(make_log(), tmp_path / "log.txt")
    with pytest.raises(InputError, match="cannot be written"):
        write_log(make_log(), tmp_path / "nowhere" / "log.csv")


@pytest.mark.parametrize("suffix", [".npz", ".mat"])
def test_one_joint_may_be_a_vector(tmp_path, suffix):
    log = make_log(joints=("slide",))
    arrays = {"t": log.t, "q": log.q[:, 0], "tau": log.tau[:, 0]}
    found = read_log(write_table(tmp_path / f"log{suffix}", arrays), ("slide",))
    assert np.array_equal(found.q, log.q) and np.array_equal(found.tau, log.tau)


def test_short_names_count_the_robots_joints(tmp_path):
    log = make_log(joints=("elbow", "arm"))
    table = {"t": log.t, "tau2": log.tau[:, 1], "q2": log.q[:, 1], "q1": log.q[:, 0]}
    table["tau1"] = log.tau[:, 0]
    found = read_log(write_table(tmp_path / "log.csv", table), ("elbow", "arm"))
    assert np.array_equal(found.q, log.q) and np.array_equal(found.tau, log.tau)


def test_longest_joint_name_wins(tmp_path):
    names = ("joint1", "link_joint1")
    log = make_log(joints=names)
    table = {"t": log.t, "q_joint1": log.q[:, 0], "q_link_joint1": log.q[:, 1]}
    found = read_log(write_table(tmp_path / "log.csv", table), names, require_torque=False)
    assert np.array_equal(found.q, log.q) and found.channels == {}


def test_take_keeps_every_array_in_step():
    log = make_log()
    part = take(log, slice(10, 20))
    assert part.t[0] == log.t[10] and len(part.t) == 10
    assert np.array_equal(part.channels["ambient"], log.channels["ambient"][10:20])
    assert part.ddq.shape == (10, 2)


def test_log_checks_its_shapes():
    with pytest.raises(ValueError, match="tau has shape"):
        Log("made", JOINTS, np.arange(3.0), np.zeros((3, 2)), tau=np.zeros((3, 1)))
    with pytest.raises(ValueError, match="channel heat has shape"):
        Log("made", JOINTS, np.arange(3.0), np.zeros((3, 2)), channels={"heat": np.zeros(4)})
