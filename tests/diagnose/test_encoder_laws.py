"""Wrong positions are named by their law and joint, and not one of their doubles; true ones by none."""

import pytest
from elbow import ask, elbow_log, fitted, passing

from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.term import Term

LAWS = ("encoder_offset", "encoder_eccentricity", "gear_coupling_error", "base_tilt")
DOUBLES = ("joint_spring", "cubic_spring", "cable_coupling", "transmission_coupling")
PLANTED = [
    Term("encoder_offset", 1, values={"dq0": 0.06}),
    Term("encoder_eccentricity", 1, values={"s1": 0.03, "c1": -0.01, "s2": 0.01, "c2": 0.0}),
    Term("gear_coupling_error", 2, 1, values={"c": 0.08}),
]


@pytest.mark.parametrize("truth", PLANTED, ids=lambda t: t.effect)
def test_a_wrong_position_is_named_with_its_values(truth):
    found = fitted(elbow_log(truth))
    scores = ask(found, *LAWS, *DOUBLES)
    best = passing(scores)[0]
    assert best.candidate.term.place == truth.place
    after = refit_with(found, best)
    values = find_term(after, best.candidate.term).values
    for name, value in truth.values.items():
        assert values[name] == pytest.approx(value, rel=0.1, abs=2e-3), name
    assert (after.fit.sigma <= 1.05 * found.fit.sigma).all()


def test_true_positions_are_left_as_they_are():
    assert not passing(ask(fitted(elbow_log()), *LAWS))
