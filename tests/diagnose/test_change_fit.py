"""Intervals of a change carry the earlier model's doubt and the drive gains'; payloads are bodies."""

from dataclasses import replace
from functools import cache

import jax.numpy as jnp
import numpy as np
import pytest
from planted import BAND, DECLARED, blank, small_arm
from scipy import stats

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.report.text import verdict_sentence
from jaxswarm.diagnose.run_against import conclude_comparison
from jaxswarm.diagnose.selection.change_apply import changes_of, doubt_of
from jaxswarm.diagnose.selection.change_fit import fit_changes
from jaxswarm.diagnose.selection.changes import compare
from jaxswarm.diagnose.selection.earlier_model import freeze
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.physical.consistency import body_violations
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.motion import prepare

BODY = np.array([1.2, 0.14, 0.036, 0.06, 0.012, -0.004, 0.03, -0.007, -0.002, 0.028])
MOMENTS = {"mcx": BODY[1], "mcy": BODY[2], "mcz": BODY[3]}


def carrying(arm, body=BODY):
    last = np.zeros((2, 10))
    last[-1] = body
    return arm.replace(parameters=arm.parameters + jnp.asarray(last))


def motion_of(arm, seed, noise, duration, motion_seed):
    log = synthetic_log(
        arm, DECLARED, seed, noise=Noise(2e-6, noise), duration=duration, rate=125.0,
        motion_seed=motion_seed,
    )  # fmt: skip
    return prepare(log, BAND)


@cache
def earlier(seed):
    """A model from a short and noisy log: its doubt is larger than the new log's."""
    return estimate(small_arm(), blank(), [motion_of(small_arm(), seed, 1.0, 6.0, 3)]).model


def payload(before):
    columns = before.regression.columns[:, :, 10:20]
    return Candidate(Term("payload"), (columns,) * 3, 10)


def found_payload(seed, model, motion):
    before = freeze(model, [motion])
    found = fit_changes(before, [payload(before)])
    names = [p.name for p in Term("payload").law.parameters]
    errors = np.sqrt(np.diag(found.covariance))
    return dict(zip(names, found.values, strict=True)), dict(zip(names, errors, strict=True))


def test_intervals_of_a_payload_hold_the_truth_although_the_earlier_model_was_poor():
    inside, blind = [], []
    for seed in range(10):
        model = earlier(100 + seed)
        motion = motion_of(carrying(small_arm()), seed, 0.1, 12.0, 11)
        values, errors = found_payload(seed, model, motion)
        _, own = found_payload(seed, replace(model, uncertainty=None), motion)
        for name, true in MOMENTS.items():
            if np.isfinite(errors[name]):
                inside.append(abs(values[name] - true) < 1.96 * errors[name])
                blind.append(abs(values[name] - true) < 1.96 * own[name])
        assert body_violations(np.array(list(values.values()))) == ()
    assert np.mean(inside) > stats.binom.ppf(0.001, len(inside), 0.95) / len(inside)
    assert np.mean(blind) < 0.75


def test_a_body_that_was_taken_off_is_one_with_all_signs_turned():
    motion = motion_of(carrying(small_arm(), -BODY), 1, 0.1, 12.0, 11)
    values, errors = found_payload(1, earlier(100), motion)
    told = [name for name in MOMENTS if np.isfinite(errors[name])]
    assert told
    for name in told:
        assert abs(values[name] + MOMENTS[name]) < 4.0 * errors[name]
    assert values["m"] < 0.0
    assert body_violations(-np.array(list(values.values()))) == ()


def test_a_payload_weighed_by_currents_carries_the_doubt_of_the_drive_gains():
    """Gains that are a tenth too large scale a payload by as much; its interval says so."""
    arm = small_arm().replace(drive_gain=jnp.array([10.0, 8.0]))
    model = replace(earlier(100), robot=earlier(100).robot.replace(drive_gain=arm.drive_gain))
    motion = motion_of(carrying(arm), 1, 0.02, 12.0, 11)
    _, torque = found_payload(1, model, motion)
    currents = replace(motion, channels={"current": motion.tau / np.array([10.0, 8.0])})
    values, errors = found_payload(1, model, currents)
    added = np.sqrt(errors["mcx"] ** 2 - torque["mcx"] ** 2)
    assert added == pytest.approx(0.1 * abs(values["mcx"]), rel=0.5)


def test_a_change_beyond_the_bounds_of_its_parameters_is_refused_by_name():
    motion = motion_of(small_arm(), 1, 0.05, 12.0, 11)
    model = earlier(100)
    slack = tuple(
        replace(t, values={"fc": 3.0}) if t.effect == "coulomb_friction" and t.joint == 0 else t
        for t in DECLARED
    )
    # Three times more friction than was known is lost: what remains would drive the joint.
    driven = replace(motion, tau=motion.tau.copy())
    driven.tau[:, 0] -= 9.0 * np.tanh(motion.dq[:, 0] / 0.01)
    before = freeze(replace(model, terms=slack), [driven])
    column = before.regression.names.index("fc_joint1:coulomb_friction")
    term = next(t for t in slack if t.effect == "coulomb_friction" and t.joint == 0)
    columns = before.regression.columns[:, :, [column]]
    pick = Candidate(replace(term, values={}), (columns,) * 3, 1, signed=True)
    (change,) = changes_of(before, [(pick, None, ())])
    assert change.now["fc"] < -5.0
    told = doubt_of(change, ("revolute",) * 3)
    assert "fc would be -" in told and " N m, outside [0, 10000]" in told
    assert " N, outside [0, 10000]" in doubt_of(change, ("prismatic",) * 3)


def test_a_base_that_gives_way_without_swinging_is_doubted_by_what_it_has():
    """It has no frequencies: a change chosen beside others was refused with a traceback."""
    motion = motion_of(small_arm(), 1, 0.05, 12.0, 11)
    more = replace(motion, tau=motion.tau.copy())
    more.tau[:, 0] += 5.0 * np.tanh(motion.dq[:, 0] / 0.01)
    before = freeze(earlier(100), [more])
    names = ["fc_joint1:coulomb_friction", "fc_joint2:coulomb_friction"]
    columns = (
        1e3 * before.regression.columns[:, :, [before.regression.names.index(n) for n in names]]
    )
    firm = Candidate(Term("base_compliance", None), (columns,) * 3, 2, signed=True)
    (change,) = changes_of(before, [(firm, None, ())])
    assert change.term.values["cx"] == pytest.approx(5e-3, rel=0.2)
    assert doubt_of(change, ("revolute",)) is None
    told = doubt_of(replace(change, std_errors={"cx": 5e-3, "cy": 5e-3}), ("revolute",))
    assert "no larger than its doubt" in told


def test_what_changed_is_told_apart_from_what_is_new():
    """Friction that was known grew: its value now, before, and the change, and a picture of the change."""
    model = estimate(small_arm(), blank(), [motion_of(small_arm(), 2, 0.1, 12.0, 3)]).model
    worn = tuple(
        replace(t, values={"fc": 2.5}) if (t.effect, t.joint) == ("coulomb_friction", 1) else t
        for t in DECLARED
    )
    log = synthetic_log(
        small_arm(), worn, 5, noise=Noise(2e-6, 0.1), duration=12.0, rate=125.0, motion_seed=11
    )
    found = compare(model, [prepare(log, BAND)])
    result, diagnosis, _ = conclude_comparison(found, [], 0)
    assert result["effects"] == []
    assert [(e["effect"], e["joint"]) for e in result["changed"]] == [
        ("coulomb_friction", "joint2")
    ]
    row = result["changed"][0]["parameters"]["fc"]
    assert row["value"] == pytest.approx(2.5, abs=0.1)
    assert row["before"] == pytest.approx(1.5, abs=0.1)
    assert row["change"]["value"] == pytest.approx(row["value"] - row["before"])
    low, high = row["interval_95"]
    assert low < 2.5 < high
    # The picture shows the change: the final model against itself without it.
    kept = {t: t.values for t in diagnosis.kept[0].rest.terms}
    assert kept[Term("coulomb_friction", 1)]["fc"] == pytest.approx(row["before"])
    assert "Since the model was identified coulomb_friction on joint2 changed" in verdict_sentence(
        result
    )
