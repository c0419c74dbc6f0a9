"""CSV: dialects that are read, and files that are refused with the place of what is wrong."""

import numpy as np
import pytest
from log_samples import damaged, make_log, read, write_text

from jaxswarm.errors import InputError

HEADER = "t,q_joint1,q_joint2,tau_joint1,tau_joint2"
ROWS = ["0.00,0.1,0.2,1.5,2.5", "0.01,0.2,0.3,1.6,2.4", "0.02,0.4,0.5,1.7,2.2"]


def refuse(path, *parts, **options):
    with pytest.raises(InputError) as caught:
        read(path, **options)
    for part in (path.name, *parts):
        assert part in str(caught.value)


def test_numbers_by_hand(tmp_path):
    log = read(write_text(tmp_path, HEADER, ROWS))
    assert log.t.tolist() == [0.0, 0.01, 0.02]
    assert log.q.tolist() == [[0.1, 0.2], [0.2, 0.3], [0.4, 0.5]]
    assert log.tau.tolist() == [[1.5, 2.5], [1.6, 2.4], [1.7, 2.2]]
    assert log.dq is None and log.ddq is None and log.channels == {}
    assert log.q.dtype == np.float64


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("\n", "\r"),
        lambda text: text.replace("\n", "\n\n"),
        lambda text: text.replace(",", ";"),
        lambda text: text.replace(",", "\t"),
        lambda text: text.replace(",", " , "),
        lambda text: "\ufeff" + text,
        lambda text: "# " + text,
        lambda text: "# recorded by hand\n# on a Monday\n" + text,
        lambda text: text.replace("q_joint1", '"q_joint1"'),
        lambda text: text.replace("0.01,0.2", '0.01,"0.2"'),
        lambda text: text.replace("q_joint1", "q1").replace("tau_joint2", "tau2"),
        lambda text: text.rstrip("\n"),
        lambda text: "\n".join(
            f"{i}," * (i > 0) + "," * (i == 0) + x for i, x in enumerate(text.split("\n")[:-1])
        ),
        lambda text: "\n".join(x + "," for x in text.split("\n")[:-1]),
    ],
)
def test_dialects_read_the_same(tmp_path, change):
    path = write_text(tmp_path, HEADER, ROWS)
    plain = read(path)
    path.write_bytes(change(path.read_text()).encode())
    other = read(path)
    assert np.array_equal(plain.q, other.q) and np.array_equal(plain.tau, other.tau)
    assert np.array_equal(plain.t, other.t)


@pytest.mark.parametrize(
    ("row", "text", "place"),
    [
        (4, "0.03,abc,1,2,3", "row 4 (line 5), column q_joint1 holds 'abc'"),
        (4, '0.03,"0,5",1,2,3', "Use a decimal point"),
        (4, "0.03,1_0,1,2,3", "row 4 (line 5), column q_joint1 holds '1_0'"),
        (4, "0.03,,1,2,3", "row 4 (line 5), column q_joint1 holds no number"),
        (7, "0.06,1,NaN,2,3", "row 7 (line 8), column q_joint2 holds no number"),
        (7, "0.06,1,2,-inf,3", "row 7 (line 8), column tau_joint1 holds -inf"),
        (7, "0.06,1,2,1e300,3", "row 7 (line 8), column tau_joint1 holds 1e+300"),
        (7, "nan,1,2,3,3", "row 7 (line 8), column t holds no number"),
        (5, "0.04,1,2,3", "row 5 (line 6) has 4 cells, the header has 5"),
        (5, "0.04,1,2,3,4,5", "row 5 (line 6) has 6 cells, the header has 5"),
        (30, "0.29,1", "delete this last line"),
        (5, "0.01,1,2,3,4", "row 5 (line 6), column t: time runs backwards, from 0.03 to 0.01 s"),
        (5, "0.03,1,2,3,4", "row 5 (line 6), column t: time 0.03 s is given twice"),
    ],
)
def test_bad_cell_is_named_by_row_line_and_column(tmp_path, row, text, place):
    refuse(damaged(tmp_path, row, text), place)


def test_line_counts_blank_lines(tmp_path):
    path = write_text(tmp_path, HEADER, [ROWS[0], "", "", "0.01,nan,1,1,1", ROWS[2]])
    refuse(path, "row 2 (line 5), column q_joint1")


@pytest.mark.parametrize(
    ("content", "what"),
    [
        (b"", "is empty"),
        (b"\n \n", "is empty"),
        (HEADER.encode(), "only a header"),
        ("\n".join(ROWS).encode(), "numbers where the header is expected"),
        (b"\xff\xfe" + HEADER.encode("utf-16-le"), "no text at byte 0"),
        (b"t,q1\x00,q2\n0,1,2\n", "binary data"),
        (b"t q1 q2 tau1 tau2\n0 1 2 3 4\n", "no commas"),
        (b"t,q1,q2,q2,tau1,tau2\n0,1,2,3,4,5\n", "column q2 appears twice in the header"),
        (b"t,q1,q2,q_joint2,tau1,tau2\n0,1,2,3,4,5\n", "q2 and q_joint2 both give q of joint2"),
    ],
)
def test_file_without_a_log_in_it(tmp_path, content, what):
    path = tmp_path / "log.csv"
    path.write_bytes(content)
    refuse(path, what)


@pytest.mark.parametrize(
    ("header", "offer"),
    [
        ("t,q_jont1,q_joint2,tau1,tau2", "missing column q_joint1. Did you mean q_jont1?"),
        ("t,q_1,q_2,tau1,tau2", "Did you mean q_1? Rename it to q_joint1"),
        ("t,Q_Joint1,q2,tau1,tau2", "Did you mean Q_Joint1? Rename it to q_joint1"),
        ("t,position_joint1,position_joint2,tau1,tau2", "Did you mean position_joint1?"),
        ("t,q_joint1 [inch],q2,tau1,tau2", "Did you mean q_joint1 [inch]?"),
        ("time,q1,q2,tau1,tau2", "missing column t, the time in seconds. Did you mean time?"),
        ("t [h],q1,q2,tau1,tau2", "Did you mean t [h]? Rename it to t"),
        ("t,q1,q2,torque_joint1,torque_joint2", "no torque"),
        (
            "t,q1,q2,torque_joint1,torque_joint2",
            "Did you mean torque_joint1? Rename it to tau_joint1",
        ),
        ("t,q1,q2,tau1,torque_2", "missing column tau_joint2. Did you mean torque_2?"),
        ("t,q1,q2,tau1,tau_jont2", "missing column tau_joint2. Did you mean tau_jont2?"),
        ("t,q1,q2,dq_joint2,tau1", "missing columns dq_joint1, tau_joint2"),
        ("x,a,b,c,d", "missing column t"),
    ],
)
def test_misnamed_column_is_offered(tmp_path, header, offer):
    refuse(write_text(tmp_path, header, ROWS), offer)


def test_other_number_of_joints(tmp_path):
    row = ["0,1,1,1,1,1,1", "0.01,2,2,2,2,2,2"]
    more = write_text(tmp_path, "t,q1,q2,q3,tau1,tau2,tau3", row)
    refuse(
        more,
        "q3, tau3 belong to no joint",
        "positions of 3 joints, the robot has 2 (joint1, joint2)",
    )
    fewer = write_text(tmp_path, "t,q_joint1,tau_joint1", ["0,1,1", "0.01,2,2"])
    refuse(fewer, "missing columns q_joint2, tau_joint2", "positions of 1 joint, the robot has 2")


def test_channels(tmp_path):
    header = HEADER + ",temperature_joint2,q_link_joint1,ambient,mode"
    rows = [f"{row},{k}.5,{k},{20 + k},AUTO" for k, row in enumerate(ROWS)]
    rows[1] = rows[1].replace(",21,", ",,")
    log = read(write_text(tmp_path, header, rows))
    assert np.array_equal(log.channels["temperature"][:, 1], [0.5, 1.5, 2.5])
    assert np.isnan(log.channels["temperature"][:, 0]).all()
    assert np.array_equal(log.channels["q_link"][:, 0], [0.0, 1.0, 2.0])
    assert np.array_equal(log.channels["ambient"], [20.0, np.nan, 22.0], equal_nan=True)
    assert "mode" not in log.channels
    assert any("mode was left out" in note and "'AUTO'" in note for note in log.notes)


def test_text_in_a_needed_column_is_not_left_out(tmp_path):
    refuse(
        write_text(tmp_path, HEADER, [row[:-3] + "n/a" for row in ROWS]),
        "row 1 (line 2), column tau_joint2",
    )


def test_made_log_is_long_enough_for_its_notes_to_be_silent(tmp_path):
    from jaxswarm.logs import write_log

    path = tmp_path / "log.csv"
    write_log(make_log(400), path)
    assert read(path).notes == ()
