"""Contacts: several and short ones are found in their logs, with torques, and spoil nothing else."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, DECLARED, blank, log_with, small_arm

from jaxswarm.diagnose import diagnose
from jaxswarm.diagnose.report.result import to_result
from jaxswarm.diagnose.selection.outcome import outcome_of
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate, load_model, model_torque, save_model
from jaxswarm.identify.estimation.events import edge_error
from jaxswarm.identify.forward.event_rows import event_rows
from jaxswarm.identify.report.summary import linear_units
from jaxswarm.logs.motion import Filtering, prepare

CONTACTS = [(2.5, 2.8, 6.0, -4.0), (6.0, 6.7, 0.0, 5.0), (9.2, 9.6, -7.0, 0.0)]


def pushed(log, contacts=CONTACTS):
    tau = log.tau.copy()
    for start, end, *torque in contacts:
        tau[(log.t >= start) & (log.t <= end)] += torque
    return replace(log, tau=tau)


def contact(start, end, log=0.0):
    return Term("contact", values={"start": start, "end": end, "log": log})


@pytest.fixture(scope="module")
def found():
    return diagnose(small_arm(), blank(), [prepare(pushed(log_with()), BAND)])


def test_several_short_contacts_are_found_with_their_torques_and_nothing_else(found):
    terms = sorted((s.added for s in found.kept), key=lambda t: t.values["start"])
    assert [t.effect for t in terms] == ["contact"] * 3
    result = to_result(outcome_of(found))
    entries = sorted(result["effects"], key=lambda e: e["parameters"]["start"]["value"])
    for entry, (start, end, *torque) in zip(entries, CONTACTS, strict=True):
        told = entry["parameters"]
        assert told["start"]["value"] == pytest.approx(start, abs=0.15)
        assert told["end"]["value"] == pytest.approx(end, abs=0.15)
        assert 0.0 < told["start"]["std_error"] < 0.05
        for joint, true in zip(("joint1", "joint2"), torque, strict=True):
            row = told[f"tau_{joint}"]
            assert row["unit"] == "N m" and row["interval_95"][0] < row["value"]
            # Begin and end are known to a decimated sample, which is a share of a short contact.
            assert abs(row["value"] - true) < 3.0 * row["std_error"]
            assert row["std_error"] < 0.06 * abs(true) + 0.3


@pytest.mark.parametrize("duration", [11.0, 20.0])
@pytest.mark.parametrize("size", [1.0, 3.0])
def test_a_push_is_told_in_slow_motion(duration, size):
    """Its own torque is no memory of the noise that it is told against."""
    log = pushed(log_with(duration=duration), [(2.5, 2.8, size, -0.6 * size)])
    told = diagnose(small_arm(), blank(), [prepare(log, Filtering(12.0, 6.0))])
    assert [s.added.effect for s in told.kept] == ["contact"]


def test_an_event_that_takes_most_of_a_log_is_not_told():
    log = pushed(log_with(duration=6.0), [(2.5, 2.8, 3.0, -1.8)])
    told = diagnose(small_arm(), blank(), [prepare(log, Filtering(6.0, 3.0))])
    assert not told.kept


def test_a_known_contact_leaves_the_parameters_as_they_are_without_it():
    """Its samples, and those its low-pass reaches, are not used: the rest is what it was."""
    plain, hit = prepare(log_with(), BAND), prepare(pushed(log_with(), CONTACTS[:1]), BAND)
    window = contact(*CONTACTS[0][:2])
    clean = estimate(small_arm(), (*blank(), window), [plain], width=0.01)
    found = estimate(small_arm(), (*blank(), window), [hit], width=0.01)
    np.testing.assert_allclose(found.fit.values, clean.fit.values, rtol=1e-4, atol=1e-4)
    torque = found.model.terms[-1].values
    errors = found.std_errors[-1]
    for joint, true in (("tau_joint1", 6.0), ("tau_joint2", -4.0)):
        assert abs(torque[joint] - true) < 4.0 * errors[joint] and errors[joint] < 0.5


def test_a_contact_belongs_to_its_log_alone(tmp_path):
    logs = [log_with(motion_seed=7), pushed(log_with(motion_seed=8), CONTACTS[1:2])]
    motions = [prepare(log, BAND) for log in logs]
    found = estimate(small_arm(), (*blank(), contact(6.0, 6.7, 1.0)), motions, width=0.01)
    rows = (~found.regression.used_rows).any(axis=1)
    assert set(found.regression.log[rows]) == {1}
    assert found.model.terms[-1].values["tau_joint2"] == pytest.approx(5.0, abs=0.4)
    save_model(found.model, tmp_path / "model.json")
    again = load_model(tmp_path / "model.json")
    assert not any(t.effect == "contact" for t in again.terms)
    np.testing.assert_allclose(
        model_torque(again, motions[0]), model_torque(found.model.during(0), motions[0])
    )


BODY = {"m": 1.5, "mcx": 0.3, "mcy": 0.0, "mcz": 0.0} | dict.fromkeys(
    ("Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"), 0.0
)


@pytest.mark.parametrize(
    ("effect", "joint", "values", "place"),
    [
        ("payload_change", None, {**BODY, "start": 5.0, "end": 8.0, "log": 0.0}, ("start", "end")),
        ("periodic_force", 0, {"sine": 2.0, "cosine": 1.0, "hertz": 1.7, "log": 0.0}, ("hertz",)),
    ],
)
def test_a_contact_is_told_beside_what_else_happened_in_its_log(effect, joint, values, place):
    """A body that was carried for a while, too, is no part of the contact's torque."""
    motion = prepare(pushed(log_with(Term(effect, joint, values=values)), CONTACTS[1:2]), BAND)
    beside = Term(effect, joint, values={name: values[name] for name in (*place, "log")})
    found = estimate(small_arm(), (*blank(), beside, contact(6.0, 6.7)), [motion], width=0.01)
    torque, errors = found.model.terms[-1].values, found.std_errors[-1]
    for name, true in (("tau_joint1", 0.0), ("tau_joint2", 5.0)):
        assert abs(torque[name] - true) < 4.0 * errors[name] and errors[name] < 0.5


def test_the_filter_of_rows_outside_does_not_reach_into_the_window():
    motion = prepare(pushed(log_with(), CONTACTS[:1]), BAND)
    plain = prepare(log_with(), BAND)
    rows = event_rows([contact(*CONTACTS[0][:2])], motion, 0)
    apart = np.abs(motion.decimator.apply(motion.tau) - plain.decimator.apply(plain.tau))
    # The filter before the decimation is recursive: a trace of it is everywhere.
    assert apart[~rows].max() < 1e-4 * apart[rows].max()
    assert rows.mean() < 0.2


def test_two_contacts_are_two_terms_and_an_unplaced_one_is_neither():
    first, second = contact(1.0, 1.5), contact(4.0, 4.5)
    four = (first, second, contact(1.0, 1.5, 1.0), Term("contact"))
    assert len({term.identity for term in four}) == 4
    names = [*first.columns(("a", "b")), *second.columns(("a", "b"))]
    assert len(set(names)) == 4
    motion = prepare(pushed(log_with(), CONTACTS[:2]), BAND)
    terms = (*blank(), contact(2.5, 2.8), contact(6.0, 6.7))
    both = estimate(small_arm(), terms, [motion], width=0.01)
    assert both.model.terms[-2].values["tau_joint1"] == pytest.approx(6.0, abs=1.0)
    assert both.model.terms[-1].values["tau_joint2"] == pytest.approx(5.0, abs=1.0)
    assert linear_units(first, small_arm()) == ["N m", "N m"]
    assert DECLARED[0].identity == (DECLARED[0].effect, 0, None, None)


@pytest.mark.parametrize("size", [0.5, 1.0, 2.0])
def test_begin_of_a_step_in_noise_is_within_its_interval(size):
    """2000 steps of known size in white noise, their begin by least squares over all rows."""
    rng = np.random.default_rng(0)
    rows, begin = 400, 200
    step = size * (np.arange(rows) >= begin)
    seen = step + rng.normal(size=(2000, rows))
    # Rows k and later are in the step: squares fall by sum(2 size x - size^2) over them.
    gain = np.cumsum((2 * size * seen - size**2)[:, ::-1], axis=1)[:, ::-1]
    off = np.argmax(gain, axis=1) - begin
    error = np.hypot(1 / np.sqrt(12), edge_error(np.array([size]), np.ones(1), 1.0))
    assert 0.92 < np.mean(np.abs(off) <= 1.96 * error) < 0.995


def late(log, seconds):
    return replace(log, tau=np.array([np.interp(log.t - seconds, log.t, x) for x in log.tau.T]).T)


def test_a_contact_is_told_by_the_time_of_the_motion_where_the_clock_of_the_torque_lags():
    """Delay and push come one after the other, in either order; both are told as they were."""
    motion = prepare(late(pushed(log_with(), CONTACTS[1:2]), 0.05), Filtering(20.0, 10.0))
    delay = Term("time_delay", values={"seconds": 0.045})
    lagging = estimate(small_arm(), (*blank(), delay), [motion], width=0.01)
    both = refit(lagging, (*lagging.model.terms, contact(6.0, 6.7)))
    seen = estimate(small_arm(), (*blank(), contact(6.05, 6.75)), [motion], width=0.01)
    again = refit(seen, (*seen.model.terms, delay))
    for found in (both, again):
        told = {t.effect: t.values for t in found.model.terms}
        assert told["time_delay"]["seconds"] == pytest.approx(0.05, abs=0.003)
        assert told["contact"]["start"] == pytest.approx(6.0, abs=0.01)
        assert told["contact"]["tau_joint2"] == pytest.approx(5.0, abs=0.15)
    alone = refit(again, tuple(t for t in again.model.terms if t.effect != "time_delay"))
    assert alone.model.terms[-1].values["start"] == pytest.approx(6.05, abs=0.01)


def test_the_torque_of_a_contact_goes_by_the_scale_of_each_drive():
    log = pushed(log_with(), [(2.5, 2.8, 6.0, -4.0)])
    log = replace(log, tau=log.tau * [1.3, 1.0])
    gain = Term("drive_gain", 0, values={"gain": 1.3})
    found = estimate(
        small_arm(), (*blank(), gain, contact(2.5, 2.8)), [prepare(log, BAND)], width=0.01
    )
    torque, errors = found.model.terms[-1].values, found.std_errors[-1]
    for name, true in (("tau_joint1", 6.0), ("tau_joint2", -4.0)):
        assert abs(torque[name] - true) < 4.0 * errors[name] and errors[name] < 0.4
