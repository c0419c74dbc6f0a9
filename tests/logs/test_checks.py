"""Time, repeated rows and torque: what is refused, what is mended and told."""

import numpy as np
import pytest
from log_samples import make_log, read, write_table

from jaxswarm.errors import InputError

LOG = make_log()
COLUMNS = {"t": LOG.t, "q": LOG.q, "tau": LOG.tau}


def write(tmp_path, **change):
    arrays = {name: values for name, values in (COLUMNS | change).items() if values is not None}
    return write_table(tmp_path / "log.npz", arrays)


def jump(time, after, by):
    return time + by * (np.arange(len(time)) > after)


@pytest.mark.parametrize(
    ("time", "what"),
    [
        (LOG.t[::-1], "row 2, column t: time runs backwards, from 0.59 to 0.58 s"),
        (jump(LOG.t, 20, -0.1), "row 22, column t: time runs backwards, from 0.2 to 0.11 s"),
        (
            jump(LOG.t, 20, -0.01),
            "row 22, column t: time 0.2 s is given twice with different values",
        ),
        (
            1e3 * LOG.t,
            "10 s between samples is too slow for a motion. t must be in seconds: is it in ms?",
        ),
        (1e6 * LOG.t, "is it in us?"),
        (1e9 * LOG.t, "is it in ns?"),
        (1e-6 * LOG.t, "faster than any robot's log"),
        (jump(LOG.t, 20, 1.7e9), "row 22, column t: time jumps from 0.2 to 1700000000 s"),
        (np.where(LOG.t == 0.1, np.inf, LOG.t), "row 11, column t holds inf"),
    ],
)
def test_refused_time(tmp_path, time, what):
    with pytest.raises(InputError) as caught:
        read(write(tmp_path, t=time))
    assert what in str(caught.value)


def test_epoch_time_is_kept(tmp_path):
    time = 1.7e9 + LOG.t
    assert np.array_equal(read(write(tmp_path, t=time)).t, time)


def test_too_short(tmp_path):
    for samples, what in ((0, "no samples"), (1, "1 sample, a motion needs many")):
        arrays = {name: values[:samples] for name, values in COLUMNS.items()}
        with pytest.raises(InputError, match=what):
            read(write(tmp_path, **arrays))


def test_exact_repeats_are_left_out_and_told(tmp_path):
    rows = np.sort(np.concatenate([np.arange(60), [5, 5, 30]]))
    log = read(write(tmp_path, **{name: values[rows] for name, values in COLUMNS.items()}))
    assert np.array_equal(log.t, LOG.t) and np.array_equal(log.tau, LOG.tau)
    assert log.notes[0] == (
        "Left out: 3 rows that repeat the one before, time included (first: row 7)."
    )


def test_rows_of_messages_count_repeats_that_were_left_out(tmp_path):
    arrays = {name: values[[0, 1, 1, 2, 3]] for name, values in COLUMNS.items()}
    arrays["t"] = np.array([0.0, 0.01, 0.01, 0.02, 0.015])
    with pytest.raises(InputError, match="row 5, column t: time runs backwards"):
        read(write(tmp_path, **arrays))


def test_repeat_with_another_channel_value_is_refused(tmp_path):
    rows = np.array([0, 1, 1, 2, 3])
    arrays = {name: values[rows] for name, values in COLUMNS.items()}
    with pytest.raises(InputError, match="row 3, column t: time 0.01 s is given twice"):
        read(write(tmp_path, **arrays, ambient=np.arange(5.0)))


class TestTorque:
    GAIN = np.array([2.0, -3.0])

    def test_current_times_gain(self, tmp_path):
        path = write(tmp_path, tau=None, current=LOG.tau)
        log = read(path, drive_gain=self.GAIN)
        assert np.array_equal(log.tau, LOG.tau * self.GAIN)
        assert np.array_equal(log.channels["current"], LOG.tau)
        assert "Torque is the motor current times the robot's drive gain." in log.notes

    @pytest.mark.parametrize(
        ("gain", "names"), [(None, "joint1, joint2"), (np.array([2.0, np.nan]), "joint2")]
    )
    def test_current_without_gain(self, tmp_path, gain, names):
        path = write(tmp_path, tau=None, current=LOG.tau)
        with pytest.raises(InputError, match=f"no drive gain for {names}. Give drive_gain"):
            read(path, drive_gain=gain)
        log = read(path, drive_gain=gain, require_torque=False)
        assert log.tau is None and any("Currents are not used" in note for note in log.notes)

    def test_torque_goes_before_current(self, tmp_path):
        log = read(write(tmp_path, current=LOG.tau + 1), drive_gain=self.GAIN)
        assert np.array_equal(log.tau, LOG.tau)
        assert "Both tau and current are given; tau is used." in log.notes

    def test_no_torque(self, tmp_path):
        path = write(tmp_path, tau=None)
        with pytest.raises(InputError, match="no torque. Expected columns tau_joint1"):
            read(path)
        assert read(path, require_torque=False).tau is None

    def test_bad_cells_are_refused_even_if_torque_is_not_required(self, tmp_path):
        tau = LOG.tau.copy()
        tau[3, 1] = np.nan
        with pytest.raises(InputError, match="row 4"):
            read(write(tmp_path, tau=tau), require_torque=False)
