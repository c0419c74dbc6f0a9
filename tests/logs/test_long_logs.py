"""A long log is read and checked in pieces: the numbers of the whole, without copies of the whole."""

import gc
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.logs import Log, csv_numbers, read_log
from jaxswarm.logs.csv import read_csv
from jaxswarm.logs.filtering import white_noise
from jaxswarm.logs.frozen import without_saturated
from jaxswarm.logs.lost import lost_samples
from jaxswarm.logs.resampling import resample, thin

JOINTS = tuple(f"joint{k + 1}" for k in range(7))


@pytest.fixture(scope="module")
def log():
    rng = np.random.default_rng(0)
    t = np.arange(60_000) / 1000.0
    q = np.sin(t[:, None] * (1.0 + np.arange(7))) + 1e-5 * rng.normal(size=(len(t), 7))
    return Log("long", JOINTS, t, q, tau=np.cos(q) + 0.1 * rng.normal(size=q.shape))


def peak(work) -> float:
    """Bytes that a piece of work holds beyond what was there."""
    gc.collect()
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    work()
    most = tracemalloc.get_traced_memory()[1] - before
    tracemalloc.stop()
    return most


@pytest.mark.parametrize(
    ("work", "copies"),
    [
        (lambda log: without_saturated(log), 0.8),
        (lambda log: white_noise(log.tau), 0.9),
        (lambda log: thin(log.q, 1000.0, 10), 1.7),
        (lambda log: resample(log.t, log.q, log.t[:-1] + 4e-4, cubic=True), 4.0),
    ],
)
def test_nothing_is_made_of_all_joints_at_once(log, work, copies):
    work(log)
    assert peak(lambda: work(log)) < copies * log.q.nbytes


def test_what_is_lost_is_looked_for_in_the_memory_of_a_few_rows(log, monkeypatch):
    monkeypatch.setattr("jaxswarm.logs.lost._ROWS", 1000)
    assert peak(lambda: lost_samples(log)) < log.q.nbytes


def columns_of(log) -> dict[str, np.ndarray]:
    named = {"t": log.t}
    for k, joint in enumerate(log.joints):
        named |= {f"q_{joint}": log.q[:, k], f"tau_{joint}": log.tau[:, k]}
    return named


def write_csv(path, log, rows, comma=".", delimiter=",", end="\n"):
    named = columns_of(log)
    table = np.column_stack(list(named.values()))[:rows]
    lines = [delimiter.join(named)]
    lines += [delimiter.join(f"{x:.17g}".replace(".", comma) for x in row) for row in table]
    path.write_bytes((end.join(lines) + end).encode())


@pytest.mark.parametrize(
    "written", [{}, {"end": "\r\n"}, {"end": "\r"}, {"delimiter": ";", "comma": ","}]
)
def test_csv_in_pieces_is_the_log_that_was_written(tmp_path, log, monkeypatch, written):
    write_csv(tmp_path / "log.csv", log, 500, **written)
    monkeypatch.setattr(csv_numbers, "_LINES", 37)
    table = csv_numbers.of_numbers(tmp_path / "log.csv")
    assert table is not None and table.row(499) == "row 500 (line 501)"
    assert len(table.notes) == ("comma" in written)
    read = read_log(tmp_path / "log.csv", JOINTS)
    for name in ("t", "q", "tau"):
        np.testing.assert_array_equal(getattr(read, name), getattr(log, name)[:500])


def test_csv_of_numbers_is_read_in_the_memory_of_its_numbers(tmp_path, log, monkeypatch):
    write_csv(tmp_path / "log.csv", log, 6000)
    monkeypatch.setattr(csv_numbers, "_LINES", 100)
    monkeypatch.setattr(csv_numbers, "_PIECE", 2**12)
    assert peak(lambda: read_csv(tmp_path / "log.csv")) < 2.0 * 6000 * 15 * 8


def test_blank_lines_and_comments_count_where_a_late_row_is_wrong(tmp_path, log, monkeypatch):
    monkeypatch.setattr(csv_numbers, "_LINES", 10)
    write_csv(tmp_path / "log.csv", log, 40)
    lines = (tmp_path / "log.csv").read_text().split("\n")
    lines[0] = "# " + lines[0]
    lines.insert(5, "")
    (tmp_path / "log.csv").write_text("\n".join(lines))
    assert csv_numbers.of_numbers(tmp_path / "log.csv").lines[-1] == 42
    lines[30] = lines[30].replace(",", ",x", 1)
    (tmp_path / "log.csv").write_text("\n".join(lines))
    with pytest.raises(InputError, match=r"row 29 \(line 31\), column q_joint1 holds 'x"):
        read_log(tmp_path / "log.csv", JOINTS)


def test_more_numbers_than_fit_are_refused_before_they_are_read(tmp_path, log, monkeypatch):
    write_csv(tmp_path / "log.csv", log, 100)
    monkeypatch.setattr("jaxswarm.logs.bounds.LARGEST_LOG", 8 * 15 * 90)
    with pytest.raises(InputError, match="GiB of numbers, at most"):
        csv_numbers.of_numbers(tmp_path / "log.csv")


@pytest.mark.parametrize("kind", ["variable", "fixed", "single"])
def test_lists_of_parquet_are_the_log_that_was_written(tmp_path, log, kind):
    arrow = pytest.importorskip("pyarrow")
    import pyarrow.parquet as parquet

    part = replace(log, t=log.t[:900], q=log.q[:900], tau=log.tau[:900])
    number = arrow.float32() if kind == "single" else arrow.float64()
    lists = arrow.list_(number, 7) if kind == "fixed" else arrow.list_(number)
    columns = {"t": arrow.array(part.t)}
    columns |= {name: arrow.array(list(getattr(part, name)), lists) for name in ("q", "tau")}
    parquet.write_table(arrow.table(columns), tmp_path / "log.parquet", row_group_size=128)
    read = read_log(tmp_path / "log.parquet", JOINTS)
    stored = np.float32 if kind == "single" else np.float64
    np.testing.assert_array_equal(read.q, part.q.astype(stored))
    np.testing.assert_array_equal(read.tau, part.tau.astype(stored))


def test_parquet_is_decoded_column_by_column(tmp_path, log):
    arrow = pytest.importorskip("pyarrow")
    import pyarrow.parquet as parquet

    parquet.write_table(arrow.table(columns_of(log)), tmp_path / "log.parquet", row_group_size=1000)
    usual = arrow.default_memory_pool()
    counted = arrow.proxy_memory_pool(usual)
    arrow.set_memory_pool(counted)
    try:
        read_log(tmp_path / "log.parquet", JOINTS)
    finally:
        arrow.set_memory_pool(usual)
    # The columns themselves, and what one of them takes to be decoded.
    assert 0 < counted.max_memory() < 1.3 * 15 * log.t.nbytes
