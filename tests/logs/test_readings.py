"""Names, units, sides and kinds that a file does not tell, said by the user or asked for."""

import numpy as np
import pytest
from log_samples import JOINTS, make_log, read, write_table

from jaxswarm.errors import InputError
from jaxswarm.logs import LogChoice, parse_reading, read_log
from jaxswarm.logs.joints import joints_in

LOG = make_log()


def foreign():
    """The log in ms, degrees and N mm, by names of another tool; the second motor turns backwards."""
    columns = {"Time": 1e3 * LOG.t}
    for k in range(2):
        columns[f"Axis{k + 1} pos"] = np.rad2deg(LOG.q[:, k])
        columns[f"Axis{k + 1} trq"] = 1e3 * LOG.tau[:, k] / (50.0, -80.0)[k]
    return columns


def same(log):
    np.testing.assert_allclose(log.t, LOG.t, atol=1e-12)
    np.testing.assert_allclose(log.q, LOG.q, atol=1e-12)
    np.testing.assert_allclose(log.tau, LOG.tau, atol=1e-12)


TOML = """
[columns]
t = { name = "Time", unit = "ms" }
q = { name = "Axis{k} pos", unit = "deg" }
tau = { name = "Axis{k} trq", unit = "N mm", scale = [50, -80] }
"""


@pytest.mark.parametrize("suffix", [".csv", ".npz", ".parquet"])
def test_a_file_of_columns_says_names_units_and_gears(tmp_path, suffix):
    path = write_table(tmp_path / f"log{suffix}", foreign())
    (tmp_path / "columns.toml").write_text(TOML)
    reading = parse_reading(str(tmp_path / "columns.toml"))
    same(read(path, reading=reading))
    same(read_log(LogChoice(path, reading), JOINTS))
    assert joints_in(LogChoice(path, reading)) == JOINTS


def test_a_list_says_names_and_units(tmp_path):
    path = write_table(tmp_path / "log.csv", foreign())
    listed = "t=Time:ms,q=Axis{k} pos:deg,tau_joint1=Axis1 trq:Nmm,tau_joint2=Axis2 trq:Nmm"
    log = read(path, reading=parse_reading(listed))
    np.testing.assert_allclose(log.tau * (50.0, -80.0), LOG.tau, atol=1e-12)
    np.testing.assert_allclose(log.q, LOG.q, atol=1e-12)


def test_a_unit_alone_holds_for_every_column_of_a_quantity(tmp_path):
    columns = {"t": 1e3 * LOG.t, "q1": np.rad2deg(LOG.q[:, 0]), "q_joint2": np.rad2deg(LOG.q[:, 1])}
    columns["tau"] = LOG.tau
    path = write_table(tmp_path / "log.npz", columns)
    same(read(path, reading=parse_reading("t:ms,q:deg")))


def test_units_in_the_header_are_used_and_told(tmp_path):
    columns = {"t [ms]": 1e3 * LOG.t, "q_joint1 [deg]": np.rad2deg(LOG.q[:, 0])}
    columns |= {
        "q2 (rad)": LOG.q[:, 1],
        "tau1 [N m]": LOG.tau[:, 0],
        "tau2 [Nmm]": 1e3 * LOG.tau[:, 1],
    }
    log = read(write_table(tmp_path / "log.csv", columns))
    same(log)
    assert sum("converted to SI" in note for note in log.notes) == 3


def test_a_unit_behind_a_name_of_the_file_holds_for_ours(tmp_path):
    columns = {"t": LOG.t, "tau": LOG.tau, "Angle 1 [deg]": np.rad2deg(LOG.q[:, 0])}
    columns["Angle 2 [deg]"] = np.rad2deg(LOG.q[:, 1])
    same(
        read(write_table(tmp_path / "log.npz", columns), reading=parse_reading("q=Angle {k} [deg]"))
    )


def test_rows_at_a_rate_and_a_part_of_an_array(tmp_path):
    both = np.column_stack([np.zeros_like(LOG.q), LOG.q])
    path = write_table(tmp_path / "log.npz", {"state": both, "effort": LOG.tau})
    log = read(path, reading=parse_reading("t:100 Hz,q=state[2:4],tau=effort"))
    same(log)


def test_the_side_of_a_gear_is_asked_for(tmp_path):
    columns = {"t": LOG.t, "tau": LOG.tau, "q_motor": LOG.q + 1.0, "q_link": LOG.q}
    path = write_table(tmp_path / "log.npz", columns)
    with pytest.raises(InputError, match="--side motor or --side link"):
        read(path)
    same(read(path, reading=parse_reading(side="link")))
    motor = read(path, reading=parse_reading(side="motor"))
    np.testing.assert_array_equal(motor.q, LOG.q + 1.0)
    assert np.array_equal(motor.channels["q_link"], LOG.q)
    path = write_table(
        tmp_path / "both.npz", {"t": LOG.t, "tau": LOG.tau, "q": LOG.q + 1.0, "q_link": LOG.q}
    )
    same(read(path, reading=parse_reading(side="link")))


def test_the_kind_of_efforts_is_asked_for_where_it_matters(tmp_path):
    path = write_table(tmp_path / "log.npz", {"t": LOG.t, "q": LOG.q, "effort": LOG.tau})
    log = read(path)
    same(log)
    assert any("taken as torques" in note for note in log.notes)
    gain = np.array([2.0, 4.0])
    with pytest.raises(InputError, match="--effort torque or --effort current"):
        read(path, drive_gain=gain)
    current = read(path, drive_gain=gain, reading=parse_reading(effort="current"))
    np.testing.assert_allclose(current.tau, LOG.tau * gain)


@pytest.mark.parametrize(
    ("listed", "what"),
    [
        ("q=Axis{k} pso:deg", "no column 'Axis1 pso'. Did you mean Axis1 pos"),
        ("q=Axis{k} pos:dag", "unknown unit 'dag' of q. Did you mean deg"),
        ("q=Time[0:2]", "shape"),
        ("q", "no OURS=THEIRS"),
        ("q=a,q=b", "q stands twice"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(tmp_path, listed, what):
    path = write_table(tmp_path / "log.csv", foreign())
    with pytest.raises(InputError) as caught:
        read(path, reading=parse_reading(listed))
    assert what in str(caught.value)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("colums = 1", "Did you mean columns"),
        ("[columns]\nq = 3", "a name in quotes"),
        ("[columns]\nq = { nam = 'a' }", "Did you mean name"),
        ("[columns]\nq = { scale = 0 }", "no factor"),
        ("side = 'gear'", "use motor or link"),
        ("[columns", "not valid TOML"),
    ],
)
def test_a_bad_file_of_columns_is_refused(tmp_path, text, what):
    path = tmp_path / "columns.toml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        parse_reading(str(path))
    assert what in str(caught.value)


def test_decimal_commas_between_semicolons(tmp_path):
    table = np.column_stack([LOG.t, LOG.q, LOG.tau])
    lines = [";".join(f"{x:.9g}".replace(".", ",") for x in row) for row in table]
    path = tmp_path / "log.csv"
    path.write_text("\n".join(["t;q1;q2;tau1;tau2", *lines]))
    log = read(path)
    np.testing.assert_allclose(log.q, LOG.q, rtol=1e-8)
    assert any("decimal points" in note for note in log.notes)
    path.write_text("\n".join(["t;q1;q2;tau1;tau2", "0;1.234,5;0;0;0"]))
    with pytest.raises(InputError, match="a point and a comma"):
        read(path)


def test_dates_and_hours_as_time(tmp_path):
    start = np.datetime64("2026-03-01T12:00:00", "us")
    stamps = start + (LOG.t * 1e6).round().astype("timedelta64[us]")
    for zone in ("", "Z", "+02:00"):
        rows = [
            f"{str(at).replace('T', ' ')}{zone},{q[0]},{q[1]},{tau[0]},{tau[1]}"
            for at, q, tau in zip(stamps, LOG.q, LOG.tau, strict=True)
        ]
        path = tmp_path / "log.csv"
        path.write_text("\n".join(["t,q1,q2,tau1,tau2", *rows]))
        log = read(path)
        np.testing.assert_allclose(log.t, LOG.t, atol=1e-9)
        assert any("from the first stamp" in note for note in log.notes)


@pytest.mark.parametrize("kind", ["timestamp", "duration", "decimal"])
def test_parquet_stamps(tmp_path, kind):
    pa = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    ns = (LOG.t * 1e9).round().astype(np.int64)
    t = {
        "timestamp": lambda: pa.array(ns + 1_700_000_000_000_000_000, pa.timestamp("ns", tz="UTC")),
        "duration": lambda: pa.array(ns, pa.duration("ns")),
        "decimal": lambda: pa.array(np.round(LOG.t, 3)).cast(pa.decimal128(10, 3)),
    }[kind]()
    table = {"t": t, "q": LOG.q.tolist(), "tau": LOG.tau.tolist()}
    parquet.write_table(pa.table(table), tmp_path / "log.parquet")
    same(read(tmp_path / "log.parquet"))
