"""The motion that tells two effects apart: what it measures, that it gains, and what it refuses."""

import importlib
from functools import partial

import jax.numpy as jnp
import numpy as np
import pytest
import yaml

import jaxswarm
from jaxswarm.diagnose.report.experiment import separating_command
from jaxswarm.effects.term import parse_terms
from jaxswarm.errors import InputError
from jaxswarm.identify.excitation.limits import parse_limits
from jaxswarm.identify.excitation.ros import write_ros
from jaxswarm.identify.excitation.search import excite
from jaxswarm.identify.excitation.separation import Question, separate, unexplained
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot import load_robot

SLIDE = {"slide": {"position": [0.0, 0.3], "velocity": 0.4, "acceleration": 2.0}, "harmonics": 3}
DRAG, POWER = "quadratic_drag@slide", "nonlinear_viscous_friction@slide"


@pytest.fixture
def short(monkeypatch):
    """Searches of a few steps."""
    plan = importlib.import_module("jaxswarm.identify.excite_plan")
    monkeypatch.setattr(plan, "excite", partial(excite, runs=1, num_steps=15))
    monkeypatch.setattr(plan, "find_apart", partial(separate, runs=1, num_steps=25))


def test_what_is_left_is_that_of_a_least_squares_fit():
    own, others = np.random.default_rng(0).normal(size=(2, 2, 30))
    fit = np.linalg.lstsq(others.T, own.T, rcond=None)[0]
    least = np.linalg.svd(own.T - others.T @ fit, compute_uv=False)[-1]
    left = unexplained(jnp.asarray(own), jnp.asarray(others), np.eye(2))
    assert float(left) == pytest.approx(least, rel=1e-6)


def test_the_motion_tells_rivals_further_apart_than_the_ordinary_one(short):
    found = jaxswarm.excite("emps", SLIDE, separate=f"{DRAG},{POWER}", duration=4.0)
    apart = found["separation"]
    assert apart["effects"] == [DRAG, POWER] and apart["left_out"] == []
    assert apart["ratio"] > 1.02
    assert apart["ratio"] == pytest.approx(apart["reached"] / apart["ordinary"])
    assert 0.0 < apart["ordinary"] <= 1.0
    log = found.log
    assert log.q.min() >= 0.0 and log.q.max() <= 0.3
    assert abs(log.dq).max() <= 0.4 and abs(log.ddq).max() <= 2.0


@pytest.mark.parametrize("true", [DRAG, POWER])
def test_on_the_planned_motion_the_loop_names_the_right_one_and_doubts_nothing(true, short):
    """Of two arms that differ in the rivals, both are found for what they are."""
    plan = jaxswarm.excite("emps", SLIDE, separate=f"{DRAG},{POWER}").log
    (q,), (dq,), (ddq,) = plan.q.T, plan.dq.T, plan.ddq.T
    speed = np.abs(dq)
    more = 150.0 * dq * speed if true == DRAG else 26.0 * np.sqrt(speed) * np.sign(dq)
    force = 95.0 * ddq + 200.0 * dq + 20.0 * np.tanh(dq / 0.002) + more
    turns, noise = 4, np.random.default_rng(0).normal(size=(4 * len(q), 2)) * [1e-6, 1.0]
    t = np.arange(len(noise)) * plan.t[1]
    found = jaxswarm.diagnose(
        jaxswarm.log_from_arrays(
            t,
            np.tile(q, turns) + noise[:, 0],
            np.tile(force, turns) + noise[:, 1],
            joints=("slide",),
        ),
        "emps",
        "viscous_friction,coulomb_friction",
    )
    assert [f"{e['effect']}@{e['joint']}" for e in found["effects"]] == [true]
    assert found["verdict"] == "explained" and found["undecided"] == []


def test_of_an_effect_that_contains_the_other_only_the_rest_counts(short):
    pair = "viscous_friction@slide,asymmetric_friction@slide"
    apart = jaxswarm.excite("emps", SLIDE, separate=pair, duration=4.0)["separation"]
    told = apart["reached_by_effect"]
    assert told["viscous_friction@slide"] is None
    assert told["asymmetric_friction@slide"] == apart["reached"] > 0.0


def test_a_model_says_what_is_taken_for_granted_and_gives_the_load(short):
    robot = load_robot("emps")
    robot = robot.replace(parameters=np.eye(1, 10) * 100.0)
    terms = parse_terms("viscous_friction,quadratic_drag,joint_elasticity", robot.joints)
    model = Model(robot, terms, (0.01,), Filtering(20.0, 10.0), (0.5,))
    pair = f"{DRAG},load_dependent_friction@slide"
    found = jaxswarm.excite("emps", SLIDE, separate=pair, given=model, duration=4.0)
    apart = found["separation"]
    assert apart["left_out"] == ["joint_elasticity@slide"]
    assert found["effects"] == ["viscous_friction@slide", *apart["effects"]]
    assert apart["ratio"] >= 1.0
    with pytest.raises(InputError, match="give one of them"):
        jaxswarm.excite("emps", SLIDE, "none", separate=pair, given=model)


def test_a_report_names_the_command_where_a_motion_can_be_planned():
    drag, power, soft = parse_terms(f"{DRAG},{POWER},joint_elasticity@slide", ("slide",))
    told = separating_command(drag, power, ("slide",))
    assert f"jaxswarm excite --robot ROBOT --limits LIMITS.toml --separate {DRAG},{POWER}" in told
    assert separating_command(drag, soft, ("slide",)) == ""


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"separate": DRAG}, "names 1 effects"),
        ({"separate": f"{DRAG},joint_elasticity@slide"}, "joint_elasticity@slide has no columns"),
        ({"separate": f"{DRAG},load_dependent_friction@slide"}, "--given"),
        ({"separate": f"{DRAG},quadratic_dragg@slide"}, "Did you mean quadratic_drag"),
        ({"given": "model.json"}, "model.json"),
    ],
)
def test_what_cannot_be_told_apart_is_refused(more, words):
    with pytest.raises(InputError, match=words):
        jaxswarm.excite("emps", SLIDE, **more)


def test_equal_effects_are_refused():
    robot = load_robot("emps")
    limits = parse_limits(SLIDE, robot.joints)
    ordinary = excite(robot, (), limits, 0.25, runs=1, num_steps=2)
    twice = parse_terms("rotor_inertia@slide", robot.joints) * 2
    with pytest.raises(InputError, match="no motion tells"):
        separate(robot, Question(twice), limits, ordinary, runs=1, num_steps=2)


def test_the_ros_message_is_the_motion(tmp_path):
    t = np.array([0.0, 0.004, 1.25])
    motion = tuple(np.random.default_rng(1).normal(size=(3, 3, 2)) * 1e-4)
    write_ros(tmp_path / "trajectory.yaml", ("base: yaw", "tip"), t, motion)
    message = yaml.safe_load((tmp_path / "trajectory.yaml").read_text())
    assert message["joint_names"] == ["base: yaw", "tip"]
    assert message["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
    points = message["points"]
    stamps = [(p["time_from_start"]["sec"], p["time_from_start"]["nanosec"]) for p in points]
    assert stamps == [(0, 0), (0, 4_000_000), (1, 250_000_000)]
    for name, values in zip(("positions", "velocities", "accelerations"), motion, strict=True):
        np.testing.assert_allclose([p[name] for p in points], values, atol=1e-9)
