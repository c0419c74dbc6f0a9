"""Damaged files of every format end in an InputError that names the file, or in a log."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from log_samples import JOINTS, arrays_of, make_log, read, table_of, write_table

from jaxswarm.errors import InputError
from jaxswarm.logs import Log, read_log

RELAXED = settings(
    max_examples=60,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
LOG = make_log(30)


def refused_or_read(path) -> str:
    """The message of the refusal, or an empty string for a file that is still a log."""
    try:
        log = read(path)
    except InputError as error:
        assert str(error).startswith(str(path)), error
        return str(error)
    assert isinstance(log, Log) and (np.diff(log.t) > 0).all()
    assert np.isfinite(log.q).all() and np.isfinite(log.tau).all()
    return ""


@pytest.fixture(scope="module")
def originals(tmp_path_factory) -> dict[str, bytes]:
    """Bytes of a good log in each format."""
    folder = tmp_path_factory.mktemp("good")
    arrays = {"t": LOG.t, "joints": np.array(JOINTS), **arrays_of(LOG)}
    written = {
        ".csv": table_of(LOG),
        ".parquet": table_of(LOG),
        ".npz": arrays,
        ".mat": arrays,
    }
    return {
        suffix: write_table(folder / f"log{suffix}", content).read_bytes()
        for suffix, content in written.items()
    }


@pytest.mark.parametrize("suffix", [".csv", ".npz", ".mat", ".parquet", ".mcap", ".db3", ".bag"])
@given(content=st.binary(max_size=400))
@RELAXED
def test_any_bytes(tmp_path, suffix, content):
    path = tmp_path / f"log{suffix}"
    path.write_bytes(content)
    assert refused_or_read(path)


@pytest.mark.parametrize("suffix", [".csv", ".npz", ".mat", ".parquet"])
@given(data=st.data())
@RELAXED
def test_changed_and_cut_bytes(tmp_path, originals, suffix, data):
    content = bytearray(originals[suffix])
    for _ in range(data.draw(st.integers(0, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    length = data.draw(st.one_of(st.just(len(content)), st.integers(0, len(content))))
    path = tmp_path / f"log{suffix}"
    path.write_bytes(bytes(content[:length]))
    refused_or_read(path)


@given(
    text=st.text(
        alphabet=st.sampled_from('tq12_,;\n\r\t #"0.e+-NaNinfjoint\x00\u00b0'), max_size=200
    ),
    header=st.booleans(),
)
@RELAXED
def test_any_text_as_csv(tmp_path, text, header):
    path = tmp_path / "log.csv"
    path.write_text("t,q1,q2,tau1,tau2\n" * header + text, encoding="utf-8", newline="")
    refused_or_read(path)


@given(
    row=st.integers(1, 30),
    column=st.integers(0, 4),
    cell=st.sampled_from(
        ["", "abc", "nan", "inf", "-inf", "1e999", "0x10", "1,5", "--1", "1_0", "1j"]
    ),
)
@RELAXED
def test_one_bad_cell_is_always_refused_with_its_row(tmp_path, row, column, cell):
    names = ["t", "q_joint1", "q_joint2", "tau_joint1", "tau_joint2"]
    table = table_of(LOG)
    lines = [",".join(names)]
    for k in range(30):
        cells = [repr(float(table[name][k])) for name in names]
        if k == row - 1:
            cells[column] = f'"{cell}"' if "," in cell else cell
        lines.append(",".join(cells))
    path = tmp_path / "log.csv"
    path.write_text("\n".join(lines))
    message = refused_or_read(path)
    assert f"row {row} (line {row + 1}), column {names[column]} holds" in message


@given(
    name=st.sampled_from(["t", "q", "dq", "ddq", "tau", "joints"]),
    values=st.one_of(
        st.sampled_from(
            [
                np.zeros(0),
                np.zeros((0, 2)),
                np.zeros((30, 0)),
                np.float64(1.0),
                np.full(30, np.nan),
                np.full((30, 2), np.inf),
                np.zeros((30, 2, 2)),
                np.array(["a"] * 30),
                np.array([b"\xff", b"a"]),
                np.zeros((30, 2), dtype=complex),
                np.zeros(30, dtype="datetime64[s]"),
                np.zeros(30, dtype=[("a", float)]),
                np.zeros((1, 30)),
            ]
        ),
        st.integers(-(2**62), 2**62).map(np.array),
    ),
)
@RELAXED
def test_arrays_of_any_kind_in_place_of_one(tmp_path, name, values):
    arrays = {"t": LOG.t, "joints": np.array(JOINTS), **arrays_of(LOG), name: values}
    path = write_table(tmp_path / "log.npz", arrays)
    assert refused_or_read(path)


NUMBERS = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True),
    st.floats(-1e9, 1e9),
    st.sampled_from([0.0, 1.0, -1.0, 1e-300, 2 * np.pi]),
)


@given(
    q=hnp.arrays(np.float64, (12, 2), elements=NUMBERS),
    tau=hnp.arrays(np.float64, (12, 2), elements=NUMBERS),
    periods=hnp.arrays(np.float64, 12, elements=st.one_of(NUMBERS, st.floats(1e-4, 0.1))),
    dq=st.none() | hnp.arrays(np.float64, (12, 2), elements=NUMBERS),
)
@RELAXED
def test_any_numbers(tmp_path, q, tau, periods, dq):
    with np.errstate(all="ignore"):
        arrays = {"t": np.cumsum(periods), "q": q, "tau": tau}
    refused_or_read(write_table(tmp_path / "log.npz", arrays | ({} if dq is None else {"dq": dq})))


@given(
    q=hnp.arrays(np.float64, (30, 2), elements=st.floats(-1e9, 1e9)),
    tau=hnp.arrays(np.float64, (30, 2), elements=st.floats(-1e9, 1e9)),
    periods=hnp.arrays(np.float64, 30, elements=st.floats(1e-3, 0.4)),
)
@RELAXED
def test_any_finite_numbers_on_an_increasing_clock_are_a_log(tmp_path, q, tau, periods):
    arrays = {"t": np.cumsum(periods), "q": q, "tau": tau, "dq": tau}
    assert refused_or_read(write_table(tmp_path / "log.npz", arrays)) == ""


@pytest.mark.parametrize(
    "content", [b"\x89PNG\r\n\x1a\n" + bytes(100), b"t,q,tau\n0,0,0\n", b"", b"PK\x03\x04"]
)
def test_what_is_no_archive_is_not_called_a_pickle(tmp_path, content):
    path = tmp_path / "log.npz"
    path.write_bytes(content)
    with pytest.raises(InputError, match="is no NPZ archive") as told:
        read_log(path, JOINTS)
    assert "pickle" not in str(told.value)
