"""A load picked up or put down in a log is named with its times and its mass, and is nothing of the robot's."""

from dataclasses import replace

import numpy as np
import pytest
from elbow import ask, elbow, elbow_log, fitted, passing
from planted import BAND

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.window import _explained, _look, _untold
from jaxswarm.diagnose.decision.carried import is_carried
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit, refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation.events import window_errors
from jaxswarm.identify.forward.model import load_model, model_torque, save_model
from jaxswarm.logs.motion import prepare

DOUBLES = ("contact", "friction_change", "torque_offset", "drive_gain", "encoder_offset")
BODY = {
    **{"m": 1.5, "mcx": 0.15, "mcy": 0.0, "mcz": 0.05},
    **{"Ixx": 0.01, "Ixy": 0.0, "Iyy": 0.02, "Ixz": 0.0, "Iyz": 0.0, "Izz": 0.02, "log": 0.0},
}


@pytest.mark.parametrize("rounding", [0.0, 1e-21, 1e-13])
def test_a_window_without_a_fitted_row_explains_nothing(rounding):
    """On a log of six joints such a window ended the diagnosis, or explained 1e275 times everything."""
    rng = np.random.default_rng(0)
    x, q, r = (
        rng.normal(size=(40, 3)),
        np.linalg.qr(rng.normal(size=(40, 5)))[0],
        rng.normal(size=40),
    )
    held = np.stack([q.T @ x, rounding * rng.normal(size=(5, 3))])
    inner = np.stack([x.T @ r, 1e-13 * rng.normal(size=3)])
    gains = _explained(np.stack([x.T @ x, np.zeros((3, 3))]), inner, held)
    free = x - q @ (q.T @ x)
    assert gains[0] == pytest.approx(x.T @ r @ np.linalg.solve(free.T @ free, x.T @ r))
    assert 0.0 <= gains[1] < 1e-9 * gains[0]


@pytest.mark.parametrize("end", [8.1, 1e5], ids=["put down", "kept"])
def test_a_load_is_named_with_its_times_and_its_mass(end, tmp_path):
    truth = Term("payload_change", values={**BODY, "start": 4.3, "end": end})
    found = fitted(elbow_log(truth))
    best = passing(ask(found, "payload_change", *DOUBLES))[0]
    assert best.candidate.term.effect == truth.effect
    after = refit_with(found, best)
    values = find_term(after, best.candidate.term).values
    for name in ("m", "start", "end"):
        assert values[name] == pytest.approx(truth.values[name], rel=0.03), name
    assert values["mcx"] == pytest.approx(0.15, abs=0.02)
    assert (after.fit.sigma < 0.4 * found.fit.sigma).all()
    # What is saved is the arm without it: other logs are predicted without the load.
    save_model(after.model, tmp_path / "model.json")
    (motion,) = fitted(elbow_log()).motions
    saved = load_model(tmp_path / "model.json")
    assert all(not t.law.in_one_log for t in saved.terms)
    left = motion.decimator.apply(motion.tau - model_torque(saved, motion))
    assert np.sqrt((left**2).mean()) < 0.1


def test_held_out_time_in_which_a_load_is_picked_up_says_nothing_of_when():
    """The fit to the others puts it anywhere in there, and lost more by that than it gained in all of them."""
    truth = Term("payload_change", values={**BODY, "m": 0.5, "mcx": 0.05, "start": 4.3, "end": 6.9})
    (best,) = passing(ask(fitted(elbow_log(truth)), "payload_change"))
    assert best.candidate.term.values["start"] == pytest.approx(4.3, abs=0.1)


def test_held_out_time_that_a_load_is_carried_for_most_of_is_not_scored_without_it():
    """Of a load from 4.8 to 11.2 s in 16 s one such stretch cost what ten others gained: p = 3e-4 for 3e-15."""
    truth = Term("payload_change", values={**BODY, "m": 0.2, "mcx": 0.02, "start": 4.3, "end": 6.9})
    (best,) = ask(fitted(elbow_log(truth)), "payload_change")
    assert best.share > 0.9
    assert best.repeats == 1.0


def test_a_window_is_worth_what_a_refit_of_everything_takes_off():
    """Beside two bodies of the last link alone the window of a load was found to end 2.4 s late."""
    rng = np.random.default_rng(0)
    basis, _ = np.linalg.qr(rng.normal(size=(800, 5)))
    columns = rng.normal(size=(400, 2, 3)) + 20.0 * basis.reshape(400, 2, 5)[:, :, :3]
    residual = rng.normal(size=800)
    residual -= basis @ (basis.T @ residual)
    log = columns, residual.reshape(400, 2), basis.reshape(400, 2, 5)
    gain, window = _look(log, np.array([100]), np.array([220]))
    within = np.zeros_like(columns)
    within[100:220] = columns[100:220]
    both = np.concatenate([basis, within.reshape(800, 3)], axis=1)
    left = residual - both @ np.linalg.lstsq(both, residual)[0]
    assert window == (100, 220)
    assert gain == pytest.approx(residual @ residual - left @ left, rel=1e-6)


def test_rows_whose_window_a_fit_to_others_cannot_tell():
    train = np.repeat([True, False, True, False, True], 4)
    within = (np.arange(20) >= 6) & (np.arange(20) < 12)
    assert np.flatnonzero(_untold(1.0 * within, train)).tolist() == [*range(4, 8), *range(12, 16)]
    within = (np.arange(20) >= 2) & (np.arange(20) < 10)
    assert not _untold(1.0 * within, train).any()
    assert not _untold(1.0 * within, train | True).any()


def test_a_load_follows_the_posture_as_no_constant_torques_do():
    """A zero that wandered passed as a load of 0.1 kg, and so did noise with a memory of seconds."""
    window = {"start": 4.3, "end": 8.1, "log": 0.0}
    small = {k: 0.05 * v for k, v in BODY.items() if k != "log"}
    load = Term("payload_change", values={**small, **window})
    held = Term(
        "contact", values={**window, "tau_joint1": 0.0, "tau_joint2": 0.2, "tau_joint3": 0.1}
    )
    for hidden in (load, held):
        found = fitted(elbow_log(hidden))
        (best,) = passing(ask(found, "payload_change"))
        assert is_carried(best, cross_fit(found)) == (hidden is load)


def test_each_log_has_its_own_load():
    """Of one picked up in both of two logs the second was told as three contacts."""
    loads = [
        Term("payload_change", values={**BODY, "m": m, "start": start, "end": 8.1})
        for m, start in ((1.5, 4.3), (1.0, 2.9))
    ]
    logs = [elbow_log(load, seed=k) for k, load in enumerate(loads, 1)]
    declared = parse_terms("viscous_friction,coulomb_friction", elbow().joints)
    found = estimate(elbow(), declared, [prepare(x, BAND) for x in logs], bounded=False)
    for _ in logs:
        (best,) = passing(ask(found, "payload_change"))
        found = refit_with(found, best)
    told = sorted((t for t in found.model.terms if t.effect == "payload_change"), key=_log)
    assert [_log(t) for t in told] == [0.0, 1.0]
    for term, load in zip(told, loads, strict=True):
        assert term.values["m"] == pytest.approx(load.values["m"], rel=0.2)
        assert term.values["start"] == pytest.approx(load.values["start"], abs=0.1)
    names = [name for t in told for name in t.columns(elbow().joints)]
    assert len(set(names)) == len(names)
    left = [t.place for t in eligible_terms(found.model, tuple(found.motions))]
    assert ("payload_change", None, None) not in left


def _log(term: Term) -> float:
    return term.values["log"]


def test_a_load_kept_all_along_belongs_to_the_link():
    assert not passing(ask(fitted(elbow_log()), "payload_change"))


def test_a_push_is_no_load():
    push = {"start": 5.2, "end": 6.0, "log": 0.0, "tau_joint1": 6.0, "tau_joint2": 4.0}
    truth = Term("contact", values={**push, "tau_joint3": 1.0})
    best = passing(ask(fitted(elbow_log(truth)), "payload_change", "contact"))[0]
    assert best.candidate.term.effect == "contact"


def test_the_times_of_a_small_load_are_as_uncertain_as_edges_are():
    """A begin 25 ms off was told as known to 10 ms, by a slope that holds no further than a pick-up takes."""
    times = {"start": 4.3, "end": 6.9}
    small = {k: 0.02 * v for k, v in BODY.items() if k != "log"}
    truth = Term("payload_change", values={**BODY, **small, **times})
    found = fitted(elbow_log(truth))
    after = refit(found, (*found.model.terms, Term("payload_change", values={**times, "log": 0.0})))
    own, errors = after.model.terms[-1], after.std_errors[-1]
    for edge in times:
        assert abs(own.values[edge] - times[edge]) < 1.96 * errors[edge], edge
    # Twice the torque is known four times as well, as edges are; by its slope it would be twice.
    double = replace(own, values={**own.values, **{k: 2.0 * own.values[k] for k in small}})
    given = after.fit, after.regression, after.motions, after.rigids
    once, twice = (window_errors(t, after.model, *given) for t in (own, double))
    assert once["start"] == pytest.approx(4.0 * twice["start"], rel=0.1)
    assert errors["start"] >= once["start"] and errors["end"] >= once["end"]
    assert window_errors(after.model.terms[0], after.model, *given) == {}
