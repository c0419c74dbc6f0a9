"""Where a contact begins and ends is told to the row, and rows that do not count cut none in two."""

from dataclasses import replace

import numpy as np
import pytest
from planted import declared_fit, log_with
from test_contacts import contact, pushed

from jaxswarm.diagnose.candidates.contact import external_candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.effects.term import Term

NUM_LOGS = 10


def window(found, crossfit) -> dict[str, float]:
    return dict(external_candidate(Linearization(found, crossfit), Term("contact")).term.values)


def test_begin_and_end_are_within_their_intervals():
    """Lengths were tried a tenth apart and rows were taken for instants: 9 of 20 edges were in theirs."""
    within = 0
    for k in range(NUM_LOGS):
        start, end = 2.31 + 0.377 * k, 2.31 + 0.377 * k + 0.6 + 0.17 * k
        log = pushed(log_with(seed=k + 1), [(start, end, 1.2, -0.8)])
        found = with_motion_noise(declared_fit(log)[0])
        told = window(found, cross_fit(found))
        term = contact(told["start"], told["end"])
        errors = refit(found, (*found.model.terms, term)).std_errors[-1]
        for name, true in (("start", start), ("end", end)):
            within += abs(told[name] - true) < 1.96 * errors[name]
    # Of 20 edges at 95 %, as few as this happens once in three thousand.
    assert within >= 16


def test_a_joint_that_rests_within_a_contact_does_not_cut_it_in_two():
    """Its torque is not known there; a push of 2 s was told as one of 1.1 s and one of 0.3 s."""
    found, crossfit = declared_fit(pushed(log_with(), [(4.0, 6.5, 2.0, 0.0)]))
    clock = found.regression.t
    unknown = (clock > 5.2) & (clock < 6.1)
    timing = np.where(unknown[:, None], 1e-3, crossfit.timing)
    left = np.where(unknown[:, None], 0.0, crossfit.whole.residual)
    crossfit = replace(crossfit, timing=timing, whole=replace(crossfit.whole, residual=left))
    told = window(found, crossfit)
    assert (told["start"], told["end"]) == pytest.approx((4.0, 6.5), abs=0.06)
