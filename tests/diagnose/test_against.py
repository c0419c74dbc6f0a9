"""A model identified before and a new log: what changed is named with its size, and nothing else is."""

from dataclasses import replace
from functools import cache

import jax.numpy as jnp
import numpy as np
import pytest
from planted import BAND, DECLARED, DURATION, NOISE, RATE, blank

from jaxswarm.diagnose.decision.remainder import remainders
from jaxswarm.diagnose.report.shown import evidence_shown
from jaxswarm.diagnose.run_against import conclude_comparison
from jaxswarm.diagnose.selection.changes import compare
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import robot_from_dh

MASS, CENTER = 1.2, np.array([0.12, 0.03, 0.05])


@cache
def upright_arm():
    """A vertical first axis that carries a horizontal one: gravity never loads the first joint."""
    bare = robot_from_dh(
        "upright", convention="modified", alpha=[0.0, np.pi / 2], a=[0.0, 0.2], d=[0.3, 0.0]
    )
    links = random_links(bare, np.random.default_rng(5), mass=6.0)
    return bare.replace(parameters=jnp.asarray(links))


def log_of(arm, terms, seed):
    return synthetic_log(
        arm, terms, seed, noise=NOISE, duration=DURATION, rate=RATE, motion_seed=seed
    )


def motion_of(arm, terms, seed):
    return prepare(log_of(arm, terms, seed), BAND)


@pytest.fixture(scope="module")
def model():
    return estimate(upright_arm(), blank(), [motion_of(upright_arm(), DECLARED, 3)]).model


def changes(model, arm=None, terms=DECLARED):
    motion = motion_of(upright_arm() if arm is None else arm, terms, 9)
    found = compare(model, [motion])
    named = [c.term.label(model.robot.joints) for c in found.changes]
    return named, found


def test_the_same_arm_has_not_changed(model):
    named, found = changes(model)
    assert named == []
    assert found.after.model is not None and found.after_each == ()


def test_clocks_of_the_new_log_are_no_change(model):
    log = log_of(upright_arm(), DECLARED, 9)
    early = np.stack([np.interp(log.t + 0.4 / RATE, log.t, tau) for tau in log.tau.T], axis=1)
    found = compare(model, [prepare(replace(log, tau=early), BAND)])
    assert found.changes == ()
    # Shrunk, and told to 0.29 of a sample: 0.25, 0.39 and nothing on the logs of three seeds.
    assert found.after.motions[0].skew * RATE == pytest.approx(-0.4, abs=0.2)


def test_what_an_earlier_model_did_not_know_is_no_change():
    """Of a motion of five seconds it knows little, and is wrong on a longer one by many times its noise."""
    short = synthetic_log(
        upright_arm(), DECLARED, 2, noise=Noise(1e-4, 6.0), duration=5.0, rate=RATE, motion_seed=4
    )
    named, found = changes(estimate(upright_arm(), blank(), [prepare(short, BAND)]).model)
    assert found.before.fit.sigma.max() > 5.0 * NOISE.torque
    assert named == []


def test_within_which_speeds_the_new_motion_reverses_is_no_change(model):
    """Fast motion told a wide sign of true stiction; on slow motion that was a bristle or Stribeck friction."""
    blurred = replace(model, width=tuple(12.0 * w for w in model.width))
    named, found = changes(blurred)
    assert named == []
    assert found.before.fit.sigma.max() < 2.0 * changes(model)[1].before.fit.sigma.max()
    assert max(np.divide(found.before.model.width, model.width)) < 3.0


def test_what_an_earlier_model_lacked_then_is_no_change():
    """Structure that it left of its own log as much as it does now."""

    def odd(seed):
        log = log_of(upright_arm(), DECLARED, seed)
        tau = np.array([0.0, 1.0]) * np.cos(5.0 * log.q[:, :1]) * np.sin(4.0 * log.q[:, 1:])
        return prepare(replace(log, tau=log.tau + tau), BAND)

    found = compare(estimate(upright_arm(), blank(), [odd(3)]).model, [odd(9)])
    assert found.changes == ()
    assert found.before.fit.sigma[1] > 4.0 * NOISE.torque
    assert max(r.over_noise for r in remainders(found.before)) < 2.0


def test_a_change_is_larger_than_what_the_earlier_model_left_of_its_own_log(model):
    rough = replace(model, sigma=(model.sigma[0], 1.0))
    worn = tuple(
        replace(t, values={k: v + 0.5 for k, v in t.values.items()})
        if (t.effect, t.joint) == ("coulomb_friction", 1)
        else t
        for t in DECLARED
    )
    assert changes(model, terms=worn)[0] == ["coulomb_friction@joint2"]
    named, found = changes(rough, terms=worn)
    assert named == []
    assert any("of its own log" in why for _, why in found.refused)


def test_a_payload_is_named_with_its_mass_and_moment(model):
    inertia = MASS * (CENTER @ CENTER * np.eye(3) - np.outer(CENTER, CENTER))
    carried = np.zeros((2, 10))
    carried[1] = [MASS, *(MASS * CENTER), *inertia[np.triu_indices(3)][[0, 1, 3, 2, 4, 5]]]
    arm = upright_arm().replace(parameters=upright_arm().parameters + jnp.asarray(carried))
    named, found = changes(model, arm)
    assert named == ["payload"]
    values, errors = found.changes[0].term.values, found.changes[0].std_errors
    # The mass of a link on a vertical axis is inseparable from its inertia; its moments are not.
    for name, true in (("mcx", carried[1, 1]), ("mcy", carried[1, 2])):
        assert abs(values[name] - true) < 4.0 * errors[name] + 0.02 * abs(true)
    assert found.after.fit.sigma.max() < 0.5 * found.before.fit.sigma.max()
    # It is in the last link, and no term of the model that is drawn.
    _, diagnosis, _ = conclude_comparison(found, [], 0)
    (step,) = diagnosis.kept
    line = evidence_shown(step, diagnosis.final.model, diagnosis.final.motions[0])[4]
    assert np.abs(line).max() > 0.5


@pytest.mark.parametrize("end", [8.1, 1e5], ids=["put down", "kept"])
def test_a_load_that_is_picked_up_in_the_new_log_is_named_with_its_times(model, end):
    """An earlier model says what is carried; the new log began without it, and the load was told of nowhere."""
    body = {"m": 1.5, "mcx": 0.15, "mcy": 0.0, "mcz": 0.05, "Ixy": 0.0, "Ixz": 0.0, "Iyz": 0.0}
    body |= {"Ixx": 0.01, "Iyy": 0.02, "Izz": 0.02}
    load = Term("payload_change", values={**body, "start": 4.3, "end": end, "log": 0.0})
    named, found = changes(model, terms=(*DECLARED, load))
    assert named == ["payload_change"]
    values, errors = found.changes[0].term.values, found.changes[0].std_errors
    for name in ("mcx", "mcy", "start", *(["end"] if end < DURATION else [])):
        assert abs(values[name] - load.values[name]) < 3.0 * errors[name], name
    assert 0.0 < errors["start"] < 0.1
    assert found.after.fit.sigma.max() < 0.4 * found.before.fit.sigma.max()
    # A model in which a load was carried for a while says nothing of another log.
    assert changes(found.after.model)[0] == []


def test_a_tilted_base_is_named_alone_although_it_loads_masses_never_felt(model):
    arm = upright_arm().replace(gravity=jnp.array([0.5, -0.3, -np.sqrt(9.81**2 - 0.34)]))
    named, found = changes(model, arm)
    assert named == ["base_tilt"]
    values, errors = found.changes[0].term.values, found.changes[0].std_errors
    for name, true in (("gx", 0.5), ("gy", -0.3)):
        assert abs(values[name] - true) < 4.0 * errors[name] + 0.02
    assert found.after.fit.sigma.max() < 1.5 * NOISE.torque * np.sqrt(10.0 / 62.5)


def test_friction_that_grew_is_named_as_a_change_of_what_was_known(model):
    worn = tuple(
        replace(t, values={k: 1.5 * v for k, v in t.values.items()})
        if (t.effect, t.joint) == ("coulomb_friction", 1)
        else t
        for t in DECLARED
    )
    named, found = changes(model, terms=worn)
    assert named == ["coulomb_friction@joint2"]
    assert found.changes[0].known
    assert found.changes[0].term.values["fc"] == pytest.approx(0.75, abs=0.05)


@pytest.mark.parametrize(
    ("effect", "name", "size"),
    [("torque_dead_band", "d", 1.5), ("torque_constant_saturation", "c", -0.02)],
)
def test_a_drive_that_distorts_now_is_told_with_its_size(model, effect, name, size):
    """A dead band came out larger by the size at which a simulation begins, half a newton meter."""
    named, found = changes(model, terms=(*DECLARED, Term(effect, 1, values={name: size})))
    assert named == [f"{effect}@joint2"]
    values = found.changes[0].term.values
    assert values[name] == pytest.approx(size, rel=0.1)
    assert set(values) == {p.name for p in found.changes[0].term.law.parameters}
    assert conclude_comparison(found, [], 0)[0]["verdict"] == "explained"


def test_a_share_of_the_other_torque_is_told_with_its_size(model):
    seen = Term("torque_crosstalk", 1, 0, values={"c": 0.1})
    named, found = changes(model, terms=(*DECLARED, seen))
    assert named == ["torque_crosstalk@joint2:joint1"]
    assert found.changes[0].term.values["c"] == pytest.approx(0.1, rel=0.05)


def test_what_no_law_explains_is_told_against_an_earlier_model_too(model):
    log = log_of(upright_arm(), DECLARED, 9)
    tau = log.tau.copy()
    tau[:, 1] += 2.0 * np.cos(5.0 * log.q[:, 0]) * np.sin(4.0 * log.q[:, 1])
    found = compare(model, [prepare(replace(log, tau=tau), BAND)])
    result, _, left = conclude_comparison(found, [], 0)
    assert result["verdict"] == "unexplained"
    assert {u.joint for u in left} == {1} and "q_joint2" in left[0].depends_on
    # The earlier model is not refitted: it takes up nothing of what the smooth term says.
    assert not left[0].change.any()
    assert left[0].change.shape == found.after.fit.theta.shape


def test_the_rows_of_a_contact_are_no_error_of_the_model_that_has_it(model):
    log = log_of(upright_arm(), DECLARED, 9)
    tau = log.tau + np.array([8.0, -12.0]) * ((log.t > 6.0) & (log.t < 6.7))[:, None]
    found = compare(model, [prepare(replace(log, tau=tau), BAND)])
    assert [c.term.effect for c in found.changes] == ["contact"]
    error = conclude_comparison(found, [], 0)[0]["error"]
    noise = np.array(error["noise_floor"]["rms"])
    assert (np.array(error["before"]["rms"]) > 10.0 * noise).all()
    assert (np.array(error["after"]["rms"]) < 1.5 * noise).all()
