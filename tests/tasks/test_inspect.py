"""What a log holds, told before anything is fitted; known numbers are found in made logs."""

import numpy as np
import pytest

from jaxswarm import Log, inspect, log_from_arrays
from jaxswarm.errors import InputError
from jaxswarm.identify.physical.physical_model import random_columns
from jaxswarm.robot import load_robot
from jaxswarm.tasks.identifiable import identifiable
from jaxswarm.tasks.inputs import as_robot


def periodic(length=4000, noise=1e-4, still=False):
    t = np.arange(length) * 0.005
    rng = np.random.default_rng(0)
    w = 2 * np.pi / 5.0
    q = np.column_stack(
        [
            np.sin(w * t) + 0.3 * np.sin(3 * w * t + 1),
            0.5 * np.cos(2 * w * t),
            np.zeros(length) if still else 0.7 * np.sin(w * t + 2) + 0.2 * np.cos(4 * w * t),
        ]
    )
    tau = 3.0 * q + rng.normal(size=q.shape) * 0.2
    return log_from_arrays(t, q + noise * rng.normal(size=q.shape), tau)


def test_noise_period_and_coverage_of_a_made_log():
    entry = inspect(periodic())["logs"][0]
    assert entry["period"] == pytest.approx(5.0, abs=0.02)
    assert entry["periods"] == pytest.approx(4.0, abs=0.02)
    assert entry["sampling"]["rate"] == pytest.approx(200)
    for joint in entry["joints"]:
        assert joint["position_noise"] == pytest.approx(1e-4, rel=0.1)
        assert joint["torque_noise"] == pytest.approx(0.2, rel=0.1)
        assert joint["both_directions"] == pytest.approx(0.5, abs=0.1)


def test_a_motion_that_never_returns_has_no_period():
    t = np.arange(2000) * 0.01
    assert inspect(log_from_arrays(t, np.sin(0.05 * t**2), t))["logs"][0]["period"] is None


def test_a_joint_at_rest_hides_its_parameters():
    moving = inspect(periodic(), "rx60")
    resting = inspect(periodic(noise=0.0, still=True), "rx60")
    assert "joint3: nothing: it never moves; if it cannot, hold it: --lock joint3=" in repr(resting)
    names = {row["name"] for row in moving["identifiable"]["base_parameters"]}
    hidden = names - {row["name"] for row in resting["identifiable"]["base_parameters"]}
    assert {"b_joint3", "fc_joint3"} <= hidden
    assert not moving["identifiable"]["never_seen"]


def test_an_arm_of_which_one_joint_moves_is_known_in_part():
    t = np.arange(2000) * 0.01
    still = np.zeros(2000)
    q = np.column_stack([np.sin(t) + 0.2 * np.sin(3 * t), still, still])
    found = inspect(log_from_arrays(t, q, q), "rx60")["identifiable"]
    # At rest of joint 2 the axes 2 and 3 see one and the same gravity: the inertia Izz2 is not in it.
    assert any(text.startswith("Izz2") for text in found["never_seen"])
    assert len(found["base_parameters"]) < 15


def test_magnification_is_the_variance_inflation_of_regression():
    """Against the definition: 1 / sqrt(1 - R^2) of each column regressed on the others."""
    from jaxswarm.logs.motion import prepare

    robot = as_robot("emps")
    t = np.arange(2000) * 0.01
    log = log_from_arrays(t, 0.2 * np.sin(t) + 0.1 * np.sin(3 * t), t, joints=("slide",))
    motion = prepare(log)
    rows = {r["name"]: r["magnification"] for r in identifiable(robot, [motion])["base_parameters"]}
    kept = motion.decimator.kept(len(motion.t))
    dq, ddq = motion.dq[kept, 0], motion.ddq[kept, 0]
    columns = np.column_stack([ddq, dq, np.tanh(dq / 0.01)])
    for k, name in enumerate(("m1", "b_slide", "fc_slide")):
        others = np.delete(columns, k, axis=1)
        rest = columns[:, k] - others @ np.linalg.lstsq(others, columns[:, k], rcond=None)[0]
        expected = np.linalg.norm(columns[:, k]) / np.linalg.norm(rest)
        assert rows[name] == pytest.approx(expected, rel=1e-6)


def test_files_without_a_robot_name_their_own_joints(tmp_path):
    log = periodic(400)
    short = tmp_path / "short.csv"
    head = "t,q1,q2,q3,tau1,tau2,tau3"
    np.savetxt(
        short, np.column_stack([log.t, log.q, log.tau]), delimiter=",", header=head, comments=""
    )
    assert [j["name"] for j in inspect(short)["logs"][0]["joints"]] == [
        "joint1",
        "joint2",
        "joint3",
    ]
    named = tmp_path / "named.csv"
    head = "t,q_base,q_arm,q_link_arm,tau_base,tau_arm"
    np.savetxt(named, np.column_stack([log.t, log.q, log.tau[:, :2]]), delimiter=",", header=head,
               comments="")  # fmt: skip
    entry = inspect(named)["logs"][0]
    assert [j["name"] for j in entry["joints"]] == ["base", "arm"]
    assert "q_link" in entry["channels"]
    (tmp_path / "none.csv").write_text("t,x\n0,1\n1,2\n")
    with pytest.raises(InputError, match="no positions found"):
        inspect(tmp_path / "none.csv")


def test_pictures_and_random_columns():
    found = inspect(periodic(400))
    assert set(found.plots()) == {"signals.png", "coverage.png"}
    assert np.linalg.matrix_rank(random_columns(load_robot("rx60")).reshape(-1, 30)) == 15


def test_a_reversed_torque_is_told_before_anything_is_fitted():
    robot = load_robot("emps")
    t = np.arange(2000) * 0.01
    q = 0.3 * np.sin(2 * t) + 0.1 * np.sin(5.1 * t)
    dq, ddq = np.gradient(q, t), np.gradient(np.gradient(q, t), t)
    tau = 90.0 * ddq + 200.0 * dq + 20.0 * np.tanh(dq / 0.003)
    tau += np.random.default_rng(0).normal(size=len(t))
    right, wrong = (
        inspect(Log("made", robot.joints, t, q[:, None], tau=sign * tau[:, None]), robot)
        for sign in (1.0, -1.0)
    )
    assert not any("torque_sign" in text for text in right["logs"][0]["findings"])
    assert any(text.startswith("torque_sign: ") for text in wrong["logs"][0]["findings"])


def test_the_sentence_names_what_could_not_be_identified():
    told = inspect(periodic(), "rx60")
    rows = told["identifiable"]["base_parameters"]
    weak = [row["name"] for row in rows if row["verdict"] == "weak"]
    assert len(rows) == 21 and weak == ["my2", "Izz2"]
    assert told.lines[-1].startswith(
        "rx60: 19 of 21 base parameters of rigid body and friction could be determined; weak: my2, Izz2. "
    )
    assert "even stamps, no gap, repeats after 5 s" in told.lines[0]
    assert "motion (rad, s)" in repr(told) and "signals (rad, N m)" in repr(told)


def test_pictures_and_tables_of_turning_and_sliding_joints_say_their_units():
    t = np.arange(1000) * 0.01
    log = log_from_arrays(t, 0.2 * np.sin(t) + 0.1 * np.sin(3 * t), t, joints=("slide",))
    found = inspect(log, "emps")
    assert "motion (m, s)" in repr(found) and "signals (m, N)" in repr(found)
    signals, covered = found.plots()["signals.png"], found.plots()["coverage.png"]
    assert [a.get_ylabel() for a in signals.axes] == ["slide\nposition [m]", "slide\ntorque [N]"]
    assert covered.axes[0].get_xlabel() == "velocity of slide [m/s]"
    unknown = inspect(log)
    assert "motion (rad or m, s)" in repr(unknown)
    assert (
        unknown.plots()["coverage.png"].axes[0].get_xlabel() == "velocity of slide [rad/s or m/s]"
    )
