"""The MAT parser against scipy's writer and reader, and against bytes written by hand."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import io, sparse

from jaxswarm.logs.matfile import Other, Structure, parse_mat

ARRAYS = {
    "double": np.random.default_rng(0).normal(size=(7, 3)),
    "row": np.arange(5.0)[None, :],
    "scalar": np.array([[2.5]]),
    "single": np.ones((2, 4), dtype=np.float32),
    "cube": np.arange(24.0).reshape(2, 3, 4),
    "empty": np.zeros((0, 3)),
    "flag": np.array([[True, False]]),
    **{kind: np.array([[1, 2], [3, 100]], dtype=kind) for kind in ("int8", "uint16", "int64")},
}


def written(tmp_path, content, **options) -> bytes:
    io.savemat(tmp_path / "a.mat", content, **options)
    return (tmp_path / "a.mat").read_bytes()


@pytest.mark.parametrize("compressed", [False, True])
def test_numbers_are_those_scipy_reads(tmp_path, compressed):
    found = parse_mat(written(tmp_path, ARRAYS, do_compression=compressed))
    expected = io.loadmat(tmp_path / "a.mat")
    assert list(found) == list(ARRAYS)
    for name, values in found.items():
        assert np.array_equal(values, expected[name]), name
        assert values.shape == ARRAYS[name].shape


def test_names_and_other_kinds(tmp_path):
    content = {
        "matrix": np.array(["joint1", "j2"]),
        "cell": np.array(["elbow", "wrist"], dtype=object),
        "mixed": np.array(["elbow", 1.0], dtype=object),
        "structure": np.array([(1.0,), (2.0,)], dtype=[("a", float)]),
        "complex": np.array([1j]),
        "sparse": sparse.eye(3).tocsc(),
        "word": "\u00e9t\u00e9",
    }
    found = parse_mat(written(tmp_path, content))
    assert found["matrix"].tolist() == ["joint1", "j2"]
    assert found["cell"].tolist() == ["elbow", "wrist"]
    assert found["word"].tolist() == ["\u00e9t\u00e9"]
    kinds = {name: found[name].kind for name in ("mixed", "structure", "complex", "sparse")}
    assert kinds == {
        "mixed": "a cell array of other things than names",
        "structure": "an array of structures",
        "complex": "complex numbers",
        "sparse": "a sparse matrix",
    }


def test_structures_within_structures(tmp_path):
    inner = {"t": np.arange(3.0), "note": "fast"}
    found = parse_mat(written(tmp_path, {"run": {"log": inner, "kp": 5.0}}))
    assert isinstance(found["run"], Structure) and found["run"].fields["kp"].item() == 5.0
    log = found["run"].fields["log"].fields
    assert log["t"].tolist() == [[0.0, 1.0, 2.0]] and log["note"].tolist() == ["fast"]


def by_hand(order: str) -> bytes:
    """``a = [1 2 300]`` as MATLAB stores it: doubles in 16 bits, sizes and name in long elements."""
    flags = struct.pack(f"{order}IIII", 6, 8, 6, 0)
    sizes = struct.pack(f"{order}IIii", 5, 8, 1, 3)
    # A short element: in the first word the length stands above the type.
    name = struct.pack(f"{order}I4s", 1 << 16 | 1, b"a")
    values = struct.pack(f"{order}IIhhhxx", 3, 6, 1, 2, 300)
    body = flags + sizes + name + values
    magic = b"IM" if order == "<" else b"MI"
    header = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack(f"{order}H", 0x0100) + magic
    return header + struct.pack(f"{order}II", 14, len(body)) + body


@pytest.mark.parametrize("order", ["<", ">"])
def test_bytes_by_hand_in_both_orders(order):
    found = parse_mat(by_hand(order))
    assert found["a"].tolist() == [[1, 2, 300]]


def test_unknown_kinds_are_named_not_guessed():
    content = by_hand("<")
    table = content.replace(struct.pack("<IIII", 6, 8, 6, 0), struct.pack("<IIII", 6, 8, 16, 0))
    assert parse_mat(table)["a"].kind == "a function"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (struct.pack("<IIii", 5, 8, 1, 3), struct.pack("<IIii", 5, 8, 1, 4)),
        (struct.pack("<IIii", 5, 8, 1, 3), struct.pack("<IIii", 5, 8, -1, -3)),
        (struct.pack("<IIii", 5, 8, 1, 3), struct.pack("<IIii", 5, 99, 1, 3)),
        (struct.pack("<II", 3, 6), struct.pack("<II", 14, 6)),
        (b"IM", b"XX"),
    ],
)
def test_contradictions_are_errors(old, new):
    content = by_hand("<")
    assert old in content
    with pytest.raises(ValueError):
        parse_mat(content.replace(old, new))


@given(at=st.integers(0, 183), value=st.integers(0, 255), length=st.integers(0, 184))
@settings(max_examples=200, deadline=None)
def test_damage_is_an_error_or_a_value(at, value, length):
    content = bytearray(by_hand("<"))
    content[at] = value
    try:
        found = parse_mat(bytes(content[:length]))
    except (ValueError, IndexError, struct.error):
        return
    assert all(isinstance(entry, np.ndarray | Other) for entry in found.values())
