"""A contact in another log: it is in no model, hides nothing of what the rest shows, and is told."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.diagnose.report.text import log_notes
from jaxswarm.diagnose.selection.elsewhere import errors_elsewhere, event_windows, residuals_on
from jaxswarm.diagnose.selection.unseen_errors import UnseenErrors
from jaxswarm.effects.term import parse_terms
from jaxswarm.identify.estimation.estimate import estimate
from jaxswarm.identify.synthetic import fourier_motion
from jaxswarm.logs import log_from_arrays
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.robot import robot_from_dh

elsewhere = importlib.import_module("jaxswarm.diagnose.selection.elsewhere")

ARM = robot_from_dh("one", convention="modified", alpha=[0.0], a=[0.0], d=[0.0])
BEGIN, END, PUSH = 10.0, 10.8, 40.0


def motion(seed: int, push: float = 0.0):
    """A turning body with friction of both kinds on a path of its own, and a push."""
    t, q, dq, ddq = fourier_motion(1, np.random.default_rng(seed), 24.0, 250.0)
    noise = 0.02 * np.random.default_rng(seed + 1).standard_normal(q.shape)
    tau = 2.0 * ddq + 1.5 * dq + 2.0 * np.tanh(dq / 0.01) + noise
    tau[(t >= BEGIN) & (t <= END)] += push
    return prepare(log_from_arrays(t, q, tau, dq=dq, joints=("joint1",)), Filtering(30.0, 15.0))


@pytest.fixture(scope="module")
def fits():
    """Without and with the Coulomb friction that the arm has."""
    fitted = motion(3)
    names = ("viscous_friction", "viscous_friction,coulomb_friction")
    return [estimate(ARM, parse_terms(effects, ("joint1",)), [fitted]) for effects in names]


def test_a_contact_hides_nothing_of_the_rest(fits):
    pushed = motion(7, PUSH)
    ((begin, end),) = event_windows(*fits, pushed)
    assert begin < BEGIN < END < end and end - begin < 4.0
    ((one, two, falls, rises, _),) = errors_elsewhere(*fits, [pushed])
    assert falls[0] and not rises[0] and two[0] < 0.1 * one[0]
    t = len(residuals_on(*fits, motion(7))[0])
    assert t > len(residuals_on(*fits, pushed)[0]) > 0.8 * t


def test_what_only_one_model_leaves_is_no_contact(fits, monkeypatch):
    """A harm that an addition does in a part of a log is its own."""
    rest = motion(7)
    assert not event_windows(*fits, rest)
    calm = elsewhere.log_residual(fits[1], rest)
    bent = calm + PUSH * (np.arange(len(calm)) // 50 == 4)[:, None]
    monkeypatch.setattr(elsewhere, "log_residual", lambda residual, motion: residual)
    assert not event_windows(calm, bent, rest)
    assert event_windows(bent, bent, rest)


def test_it_is_told_and_not_scored(fits):
    errors = UnseenErrors([motion(7, PUSH)], *fits)
    after = errors.of(fits[1])
    assert after["rms"][0] < 0.03 and len(after["events"]) == 1
    assert UnseenErrors([motion(7)], *fits).of(fits[1])["events"] == []
    result = {"joints": ("joint1",), "torque_units": ("N m",), "findings": (), "logs": ()}
    (note,) = log_notes({**result, "error": {"validation": errors.validation}})
    assert "is not scored" in note and " s " in note


@pytest.mark.parametrize("begin", [400, 410, 445, 449])
@pytest.mark.parametrize("end", [601, 610, 645])
def test_an_event_that_begins_and_ends_within_a_stretch_is_seen_whole(begin, end):
    """Of 1000 rows at 50 Hz, 50 a stretch: a small part of one leaves little of it."""
    left = np.random.default_rng(0).normal(size=(1000, 2))
    left[begin:end, 1] += 20.0
    times, free = np.arange(1000) / 50, np.zeros((1000, 2), bool)
    ((first, last),) = elsewhere._eventful(left, left, free, times)
    assert begin / 50 - 1.0 <= first <= begin / 50
    assert (end - 1) / 50 <= last <= (end - 1) / 50 + 1.0


def test_what_lasts_half_a_log_and_to_its_end_is_an_event(fits):
    held = motion(7)
    half = held.t > 0.5 * (held.t[0] + held.t[-1]) + 0.2
    ((begin, end),) = event_windows(*fits, replace(held, tau=held.tau + PUSH * half[:, None]))
    assert begin <= held.t[half][0] and end == held.t[-1]
