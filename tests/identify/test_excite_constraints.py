"""Planned motions keep torque limits and the distance of the links, and say what they could not keep."""

import importlib
from functools import partial

import numpy as np
import pytest

import jaxswarm
from jaxswarm.effects.term import parse_terms
from jaxswarm.errors import InputError
from jaxswarm.identify.excitation.constraints import Constraints, excess_of, kept
from jaxswarm.identify.excitation.fourier import Fourier, num_coordinates, shares, within_limits
from jaxswarm.identify.excitation.limits import Limits, parse_limits
from jaxswarm.identify.excitation.search import excite
from jaxswarm.identify.excitation.separation import separate
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot import load_robot
from jaxswarm.robot.capsules import capsules_of, distances, pairs_of_links
from jaxswarm.robot.load import describe_robot

JOINT = {"position": [-2.6, 2.6], "velocity": 3.0, "acceleration": 12.0}
LEVEL = {**JOINT, "position": [1.4, 1.7]}  # never upright, so that gravity has to be held
LIMITS = {"a": JOINT, "b": JOINT, "c": JOINT, "harmonics": 2, "rate": 100, "fundamental": 0.25}


def link(name, shape):
    return (
        f'<link name="{name}"><inertial><origin xyz="0 0 0.2"/><mass value="3"/>'
        '<inertia ixx="0.04" iyy="0.04" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
        f'<collision><origin xyz="0 0 0.2"/><geometry>{shape}</geometry></collision></link>'
    )


def joint(name, parent, child, height, effort):
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0 0 {height}"/><axis xyz="0 1 0"/>'
        f'<limit lower="-3" upper="3" effort="{effort}" velocity="3"/></joint>'
    )


@pytest.fixture
def arm(tmp_path):
    """Three links in a vertical plane that can fold back onto each other, with torque limits."""
    rod = '<cylinder radius="0.03" length="0.4"/>'
    text = "".join(link(n, rod) for n in ("base", "one", "two", "three"))
    text += joint("a", "base", "one", 0.4, 60) + joint("b", "one", "two", 0.4, 14)
    text += joint("c", "two", "three", 0.4, 0)
    path = tmp_path / "arm.urdf"
    path.write_text(f'<robot name="arm">{text}</robot>')
    return str(path)


@pytest.fixture
def short(monkeypatch):
    """Searches of a few steps."""
    plan = importlib.import_module("jaxswarm.identify.excite_plan")
    monkeypatch.setattr(plan, "excite", partial(excite, runs=1, num_steps=20))
    monkeypatch.setattr(plan, "find_apart", partial(separate, runs=1, num_steps=10))


def test_torque_limits_of_the_file_are_kept_by_pinocchio_and_told(arm, short):
    pin = pytest.importorskip("pinocchio")
    found = jaxswarm.excite(arm, LIMITS, "none")
    model = pin.buildModelFromUrdf(arm)
    data, log = model.createData(), found.log
    tau = np.array(
        [
            pin.rnea(model, data, *map(np.asarray, x))
            for x in zip(log.q, log.dq, log.ddq, strict=True)
        ]
    )
    top = np.abs(tau).max(axis=0)
    assert (top[:2] <= [60.0, 14.0]).all() and top[1] > 6.0
    told = found["torque"]
    assert told["c"]["limit"] is None and told["b"]["limit"] == 14.0
    np.testing.assert_allclose([told[j]["largest"] for j in "abc"], top, rtol=1e-2)
    assert any("not limited on c" in note for note in found["notes"])


def test_links_stay_apart_on_samples_nobody_looked_at(arm, short):
    found = jaxswarm.excite(arm, {**LIMITS, "distance": 0.05}, "none")
    robot, shapes = load_robot(arm), capsules_of(describe_robot(arm))
    pairs = pairs_of_links(robot, shapes)
    assert len(pairs) == 3
    least = min(float(distances(robot, shapes, pairs, q).min()) for q in found.log.q[::3])
    told = found["self_distance"]
    assert told["asked"] == 0.05 and told["least"] >= 0.05
    assert least >= 0.05 and least == pytest.approx(told["least"], abs=5e-3)


def test_effects_of_a_model_count_as_torque():
    limits = parse_limits({"slide": {**JOINT, "effort": 9.0}}, ("slide",))
    robot = load_robot("emps")
    robot = robot.replace(parameters=np.eye(1, 10) * 2.0)
    (dry,) = parse_terms("coulomb_friction@slide", robot.joints)
    dry = type(dry)(dry.effect, dry.joint, values={"fc": 5.0})
    moves = Fourier(np.zeros(1), np.array([[0.0, 0.0]]), np.array([[0.3, 0.0]]), 0.5)
    amplitude = 0.3 * (2 * np.pi * 0.5) ** 2
    alone = excess_of(Constraints(robot, limits.effort), limits)
    rubbing = excess_of(Constraints(robot, limits.effort, (dry,)), limits)
    assert alone(moves) == pytest.approx(2.0 * amplitude / 9.0 - 1.0, rel=1e-3)
    # Friction has turned round long before acceleration has fallen off.
    assert 9.0 * (1.0 + rubbing(moves)) == pytest.approx(2.0 * amplitude + 5.0, rel=2e-2)


def test_a_motion_that_crosses_a_limit_is_made_smaller_by_no_more_than_needed():
    limits = parse_limits({"slide": {**JOINT, "effort": 3.0}}, ("slide",))
    robot = load_robot("emps").replace(parameters=np.eye(1, 10) * 2.0)
    constraints = Constraints(robot, limits.effort)
    moves = Fourier(np.zeros(1), np.zeros((1, 2)), np.array([[0.3, 0.0]]), 0.5)
    smaller = kept(moves, constraints, limits)
    top = 2.0 * float(smaller.cosine[0, 0]) * np.pi**2
    assert 2.98 < top <= 3.0


def test_a_motion_that_may_be_smaller_is_so_only_where_something_forces_it(arm, monkeypatch):
    plan = importlib.import_module("jaxswarm.identify.excite_plan")
    monkeypatch.setattr(plan, "excite", partial(excite, runs=2, num_steps=80))
    free = {j: {**JOINT, "effort": 5000.0} for j in "abc"}
    found = jaxswarm.excite(arm, {**LIMITS, **free}, "none")
    used = found["limits_used"]
    assert all(max(used[joint].values()) > 0.8 for joint in "abc"), used


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"a": {**LEVEL, "effort": 0.05}, "distance": -1.0}, ["torque limit of a", "needed to hold"]),
        ({"b": {**JOINT, "effort": -5.0}}, ["b", "effort", "-5"]),
        ({"b": {**JOINT, "efort": 5.0}}, ["efort", "effort"]),
        ({"distance": "far"}, ["distance", "far"]),
        ({"radius": 0}, ["radius", "0"]),
    ],
)  # fmt: skip
def test_what_cannot_be_kept_is_refused(arm, short, change, words):
    with pytest.raises(InputError) as told:
        jaxswarm.excite(arm, {**LIMITS, **change}, "none")
    for word in words:
        assert word in str(told.value)


def test_limits_that_nothing_is_known_of_are_refused_or_told():
    slide = {"position": [0.0, 0.3], "velocity": 0.4, "acceleration": 2.0}
    with pytest.raises(InputError, match="no masses"):
        jaxswarm.excite("emps", {"slide": {**slide, "effort": 9.0}}, "none")
    with pytest.raises(InputError, match="no shapes"):
        jaxswarm.excite("emps", {"slide": slide, "distance": 0.1}, "none")


def test_what_was_not_checked_is_told(short):
    slide = {"position": [0.0, 0.3], "velocity": 0.4, "acceleration": 2.0}
    found = jaxswarm.excite("emps", {"slide": slide, "harmonics": 2}, "none", duration=4.0)
    assert found["torque"] is None and found["self_distance"] is None
    assert any("masses" in note for note in found["notes"])
    assert any("radius" in note for note in found["notes"])


def test_a_model_gives_masses_and_the_effects_to_plan_for(short):
    robot = load_robot("emps").replace(parameters=np.eye(1, 10) * 90.0)
    dry, late = (
        type(t)(t.effect, t.joint, values={p.name: p.nominal for p in t.law.parameters})
        for t in parse_terms("coulomb_friction@slide,temperature_friction@slide", robot.joints)
    )
    model = Model(robot, (dry, late), (0.01,), Filtering(20.0, 20.0), (1.0,))
    slide = {"position": [0.0, 0.3], "velocity": 0.4, "acceleration": 2.0, "effort": 100.0}
    found = jaxswarm.excite("emps", {"slide": slide, "harmonics": 2}, given=model, duration=4.0)
    assert found["effects"] == ["coulomb_friction@slide"]
    assert 50.0 < found["torque"]["slide"]["largest"] <= 100.0
    assert sum("temperature_friction" in note for note in found["notes"]) == 2


def test_a_motion_that_separates_keeps_them_too(arm, short):
    pair = "quadratic_drag@b,nonlinear_viscous_friction@b"
    found = jaxswarm.excite(arm, {**LIMITS, "distance": 0.02}, "none", separate=pair)
    assert found["torque"]["b"]["largest"] <= 14.0 and found["torque"]["a"]["largest"] <= 60.0
    assert found["self_distance"]["least"] >= 0.02


def test_shapes_scaled_smaller_stay_within_the_limits():
    limits = Limits(*np.array([[-1.0], [1.0], [2.0], [3.0]]), harmonics=2, smaller=True)
    x = np.array([1.0, 0.3, 0.2, 0.0, 0.0, -0.5])
    assert num_coordinates(limits) == 6
    assert shares(x, limits) == pytest.approx([0.265])
    whole = within_limits(np.array([*x[:5], 1.0]), limits, 0.2, 64)
    part = within_limits(x, limits, 0.2, 64)
    np.testing.assert_allclose(part[1], 0.265 * whole[1], rtol=1e-6)
