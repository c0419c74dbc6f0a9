"""Exciting trajectories: limits kept at all times, rest at both ends, better than chance, clear refusals."""

import contextlib
import io
import json
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.cli import main
from jaxswarm.effects.term import parse_terms
from jaxswarm.errors import InputError
from jaxswarm.identify.excitation.columns import planned_columns
from jaxswarm.identify.excitation.fourier import Fourier, num_coordinates, within_limits
from jaxswarm.identify.excitation.limits import Limits, parse_limits, read_limits
from jaxswarm.identify.excitation.search import excite
from jaxswarm.identify.excite_plan import schedule
from jaxswarm.robot import rx60
from jaxswarm.robot.logged import rigid_columns

LIMITS = Limits(
    lower=np.array([-2.0, -1.0, 0.2]),
    upper=np.array([2.0, 2.0, 0.6]),
    velocity=np.array([1.5, 1.5, 2.5]),
    acceleration=np.array([4.0, 40.0, 8.0]),
)
SLIDE = """
harmonics = 3
rate = 100

[slide]
position = [0.0, 0.3]
velocity = 0.4
acceleration = 2
"""


def inside(trajectory, limits):
    """Peaks as shares of the limits on samples far denser than any the library looks at."""
    t = np.linspace(0.0, 1.0 / trajectory.fundamental, 20_011)
    q, dq, ddq = trajectory.motion(t)
    assert (q >= limits.lower).all() and (q <= limits.upper).all()
    return np.abs(dq).max(axis=0) / limits.velocity, np.abs(ddq).max(axis=0) / limits.acceleration


@pytest.fixture(scope="module")
def planned():
    """One search for the RX60 with friction on every joint."""
    robot = rx60()
    terms = parse_terms("viscous_friction,coulomb_friction", robot.joints)
    return excite(robot, terms, LIMITS, 0.1, runs=1, num_steps=120)


@pytest.mark.parametrize("samples", [100, 1000])
def test_every_shape_is_scaled_into_the_limits(samples):
    size = num_coordinates(LIMITS)
    build = jax.jit(lambda x: within_limits(x, LIMITS, 0.1, samples))
    for x in np.random.default_rng(0).uniform(-1, 1, (20, size)):
        trajectory = Fourier(*map(np.asarray, build(x)), 0.1)
        speed, push = inside(trajectory, LIMITS)
        t = np.linspace(0.0, 10.0, 5000)
        reach = np.ptp(trajectory.motion(t)[0], axis=0) / (LIMITS.upper - LIMITS.lower)
        most = np.max([reach, speed, push], axis=0)
        assert (most <= 1.0).all() and (most > 0.97).all()


def test_a_place_of_one_touches_the_upper_limit():
    x = np.random.default_rng(1).uniform(-1, 1, (3, 11))
    x[:, -1] = 1.0
    trajectory = Fourier(*map(np.asarray, within_limits(x.ravel(), LIMITS, 0.1, 500)), 0.1)
    top = trajectory.motion(np.linspace(0.0, 10.0, 5000))[0].max(axis=0)
    np.testing.assert_allclose(top, LIMITS.upper, atol=3e-3)


def test_velocity_and_acceleration_are_the_derivatives():
    rng = np.random.default_rng(2)
    trajectory = Fourier(rng.normal(size=2), *rng.normal(size=(2, 2, 4)), 0.2)
    t, h = np.linspace(0, 5, 50), 1e-5
    before, here, after = (trajectory.motion(t + d) for d in (-h, 0.0, h))
    for k in range(2):
        np.testing.assert_allclose((after[k] - before[k]) / (2 * h), here[k + 1], atol=1e-6)


def test_the_motion_found_keeps_its_limits_and_rests_at_both_ends(planned):
    speed, push = inside(planned.trajectory, LIMITS)
    assert (speed <= 1.0).all() and (push <= 1.0).all()
    assert (planned.used <= 1.0).all() and (planned.used.max(axis=1) > 0.99).all()
    q, dq, ddq = planned.trajectory.motion(np.array([0.0, 10.0]))
    np.testing.assert_allclose(q[0], q[1], atol=1e-12)
    assert np.abs(dq).max() < 1e-12 and np.abs(ddq).max() < 1e-10


def test_it_is_better_than_random_motions(planned):
    assert planned.condition < 0.75 * np.median(planned.random)
    assert planned.condition < planned.random.min()


def test_the_condition_number_is_that_of_the_columns_identify_uses(planned):
    t = np.arange(500) / 50.0
    q, dq, ddq = planned.trajectory.motion(t)
    rigid = rigid_columns(rx60(), q, dq, ddq).reshape(1500, 30)
    viscous, dry = np.zeros((2, 500, 3, 3))
    for j in range(3):
        viscous[:, j, j] = dq[:, j]
        dry[:, j, j] = np.tanh(dq[:, j] / (0.01 * LIMITS.velocity[j]))
    friction = [x.reshape(1500, 3) for x in (viscous, dry)]
    columns = np.concatenate([rigid, *friction], axis=1)[:, planned.base.kept]
    scaled = columns / np.linalg.norm(columns, axis=0)
    values = np.linalg.svd(scaled, compute_uv=False)
    assert values[0] / values[-1] == pytest.approx(planned.condition, rel=1e-6)
    assert planned.base.size == np.linalg.matrix_rank(np.concatenate([rigid, *friction], axis=1))


def test_columns_of_a_spring_and_a_coupling():
    robot = rx60()
    terms = parse_terms("joint_spring@joint2,transmission_coupling@joint2:joint3", robot.joints)
    q, dq, ddq = np.random.default_rng(0).normal(size=(3, 3, 4))
    columns = planned_columns(robot, terms, LIMITS, *map(jnp.asarray, (q, dq, ddq)), 10.0)
    columns = np.asarray(columns).reshape(-1, 3, 4)[30:]
    names = [c for t in terms for c in t.columns(robot.joints)]
    assert len(columns) == len(names)
    np.testing.assert_allclose(columns[0, 1], q[1])
    np.testing.assert_allclose(
        columns[names.index("b_joint2_joint3:transmission_coupling"), 1], dq[2]
    )
    assert not columns[:, [0, 2]].any()


def run(*arguments):
    """Exit code, stdout and stderr of a command, in this process."""
    out, err = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["jaxswarm", *map(str, arguments)])
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                main()
                code = 0
            except SystemExit as end:
                code = end.code or 0
    return code, out.getvalue(), err.getvalue()


@pytest.fixture(autouse=True, scope="module")
def quiet_cache(tmp_path_factory):
    """Compiled programs of these commands stay out of the user's cache."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("JAX_COMPILATION_CACHE_DIR", str(tmp_path_factory.mktemp("compiled")))
        before = jax.config.jax_persistent_cache_min_compile_time_secs
        yield
        jax.config.update("jax_persistent_cache_min_compile_time_secs", before)


def test_the_command_writes_a_trajectory_at_the_rate(tmp_path):
    (tmp_path / "limits.toml").write_text(SLIDE)
    code, out, err = run(
        "excite", "--robot", "emps", "--limits", tmp_path / "limits.toml", "--out",
        tmp_path / "out", "--effects", "coulomb_friction", "--duration", 24, "--json",
    )  # fmt: skip
    assert code == 0, err
    result = json.loads(out)
    assert result == json.loads((tmp_path / "out" / "excitation.json").read_text())
    assert {p.name for p in (tmp_path / "out").glob("[!.]*")} == {
        "trajectory.csv", "trajectory.yaml", "excitation.json", "trajectory.png",
    }  # fmt: skip
    text = (tmp_path / "out" / "trajectory.csv").read_text().splitlines()
    assert text[0] == "t,q_slide,dq_slide,ddq_slide"
    t, q, dq, ddq = np.loadtxt(text[1:], delimiter=",").T
    np.testing.assert_allclose(t, np.arange(2401) / 100.0)
    assert result["duration"] == pytest.approx(24.0) and result["periods"] == 2
    assert q.min() >= 0.0 and q.max() <= 0.3 and abs(dq).max() <= 0.4 and abs(ddq).max() <= 2.0
    assert max(abs(dq[[0, 1200, 2400]])) < 1e-9 and max(abs(ddq[[0, 1200, 2400]])) < 1e-9
    part = result["coefficients"]["slide"]
    angle = 2 * np.pi * result["fundamental"] * np.outer(t, [1, 2, 3])
    again = part["offset"] + np.sin(angle) @ part["sine"] + np.cos(angle) @ part["cosine"]
    np.testing.assert_allclose(q, again, atol=1e-8)
    numbers = result["condition_number"]
    assert 1.0 <= numbers["after"] < min(numbers["random_median"], numbers["before"])


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[slide]", "[slede]", ["slede", "slide"]),
        ("[0.0, 0.3]", "[0.3, 0.3]", ["slide", "lower"]),
        ("[0.0, 0.3]", "[0.3]", ["slide", "position"]),
        ("[0.0, 0.3]", "[nan, 0.3]", ["slide", "position"]),
        ("velocity = 0.4", "", ["slide", "velocity"]),
        ("velocity = 0.4", "velocity = -0.4", ["velocity", "-0.4"]),
        ("velocity = 0.4", "velocty = 0.4", ["velocty", "velocity"]),
        ("acceleration = 2", "acceleration = 'fast'", ["acceleration", "fast"]),
        ("harmonics = 3", "harmonics = 1", ["harmonics", "rest"]),
        ("harmonics = 3", "harmonics = 2.5", ["harmonics", "2.5"]),
        ("rate = 100", "rate = 1", ["samples", "rate"]),
        ("rate = 100", "fundamental = 1e-8", ["samples", "too many"]),
        ("[slide]", "[slide", ["TOML"]),
        (SLIDE, "", ["slide", "no limits"]),
    ],
)
def test_bad_limits_are_refused(tmp_path, old, new, words):
    assert old in SLIDE
    (tmp_path / "limits.toml").write_text(SLIDE.replace(old, new))
    refused(tmp_path, "limits.toml" if words[0] != "samples" else "", *words)


def refused(folder, *words, limits="limits.toml", more=()):
    before = sorted(folder.iterdir())
    code, out, err = run(
        "excite", "--robot", "emps", "--limits", folder / limits, "--out", folder / "out", *more
    )
    assert (code, out) == (2, "") and "Traceback" not in err
    assert err.startswith("error: ") and err.count("\n") == 1
    for word in words:
        assert word in err, (word, err)
    assert sorted(folder.iterdir()) == before


def test_other_bad_input_is_refused(tmp_path):
    refused(tmp_path, "none.toml", limits="none.toml")
    (tmp_path / "folder.toml").mkdir()
    refused(tmp_path, "folder.toml", limits="folder.toml")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    refused(tmp_path, "binary.toml", limits="binary.toml")
    (tmp_path / "limits.toml").write_text(SLIDE)
    refused(tmp_path, "joint_elasticity", more=("--effects", "joint_elasticity"))
    refused(tmp_path, "temperature_friction", more=("--effects", "temperature_friction"))
    refused(tmp_path, "time_delay", more=("--effects", "time_delay"))
    refused(tmp_path, "load_dependent", more=("--effects", "load_dependent_friction"))
    refused(tmp_path, "--duration", more=("--duration", "inf"))
    (tmp_path / "out").write_text("in the way")
    refused(tmp_path, "--out")


def test_limits_of_a_joint_that_is_missing(tmp_path):
    (tmp_path / "two.toml").write_text(SLIDE)
    with pytest.raises(InputError, match="two.toml: no limits for lift"):
        read_limits(tmp_path / "two.toml", ("slide", "lift"))
    with pytest.raises(InputError, match="unknown joint"):
        parse_limits({"x": {}}, ("slide",))


def test_the_period_is_a_whole_number_of_samples():
    limits = Limits(*np.ones((4, 1)), rate=100.0)
    assert schedule(limits, None) == (1, 1000)
    assert schedule(limits, 4.0) == (1, 400)
    assert schedule(limits, 31.0) == (3, 1033)
    fixed = Limits(*np.ones((4, 1)), fundamental=0.25, rate=100.0)
    assert schedule(fixed, None) == (1, 400)
    assert schedule(fixed, 13.0) == (3, 400)
