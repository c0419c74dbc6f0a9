"""Torques of one joint that are as large wherever it comes to the same place again are no pushes."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, log_with
from test_state_events import told_as_contacts

from jaxswarm.diagnose.selection.event_elsewhere import of_place
from jaxswarm.logs.motion import prepare

PLACE, WIDTH = 0.25, 0.06


def detent(log):
    """A notch on the way of joint 2 [N m]."""
    return 6.0 * np.exp(-0.5 * ((log.q[:, 1] - PLACE) / WIDTH) ** 2)


def passed_once(log):
    """The same, but only on the first pass of a log."""
    inside = np.abs(log.q[:, 1] - PLACE) < 2.0 * WIDTH
    first = np.flatnonzero(inside)[0]
    over = first + np.flatnonzero(~inside[first:])[0]
    return detent(log) * (np.arange(len(log.t)) < over)


def nothing(log):
    return 0.0 * log.t


def found(here, *there):
    """Why a contact told on one log is a matter of place, by others with further torques of joint 2."""
    search = told_as_contacts(here, 1)
    other = []
    for number, extra in enumerate(there):
        log = log_with(duration=20.0, motion_seed=11 + number)
        tau = log.tau + np.stack([0.0 * log.t, extra(log)], 1)
        other.append(prepare(replace(log, tau=tau), BAND))
    return of_place(search.current, 1, [s.added for s in search.steps], other)


@pytest.mark.parametrize(
    ("here", "there", "told"),
    [
        (passed_once, (detent,), False),  # most other passes of its own log have nothing
        (passed_once, (nothing,), False),
        (passed_once, (), False),
    ],
)
def test_a_push_that_other_visits_do_not_have_stays(here, there, told):
    assert (found(here, *there) is not None) == told


def test_a_detent_that_every_other_visit_has_is_no_push():
    why = found(detent, detent)
    assert why is not None and "of q_joint2" in why and "other visits" in why
