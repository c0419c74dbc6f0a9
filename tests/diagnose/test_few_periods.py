"""An order of which few periods are seen is one only if it leaves nothing that follows what it is about."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, declared_fit, log_with
from test_unexplained import with_extra

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.position_laws import hardly_repeats, imitates
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.diagnose.selection.survives import one_place
from jaxswarm.effects.term import Term
from jaxswarm.logs.motion import prepare

RIPPLE, FRICTION = Term("torque_ripple", 1), Term("position_dependent_friction", 1)
FEW = replace(RIPPLE, values={"sine": 1.0, "cosine": 0.0, "n": 4.0})
MANY = replace(RIPPLE, values={"sine": 1.0, "cosine": 0.0, "n": 40.0})
SPRING, CUBIC, DEAD_ZONE, BRISTLES = (
    Term(name, 1) for name in ("joint_spring", "cubic_spring", "dead_zone_spring", "hysteresis")
)


def magnet(q, dq):
    x = (q[:, 1] - 0.2) / 0.4
    return 4.0 * x * np.exp(-(x**2))


def brake(low, high):
    """Drag of an eddy-current brake between two angles."""

    def torque(q, dq):
        place = 0.5 * (np.tanh((q[:, 1] - low) / 0.05) - np.tanh((q[:, 1] - high) / 0.05))
        return 6.0 * place * dq[:, 1] / (1.0 + (dq[:, 1] / 0.35) ** 2)

    return torque


def why_not(log, law=RIPPLE):
    """Why the best order of a law of the second joint is refused on a log, and that order."""
    before, crossfit = declared_fit(log)
    (score,) = score_terms(Linearization(before, crossfit), [law], 0)
    after = refit_with(before, score)
    assert after is not None
    found = find_term(after, law)
    return one_place(after, found, Rules(), 0), found.values["n"]


@pytest.mark.parametrize("order", [3.5, 20.0])
def test_a_ripple_is_one(order):
    true = Term("torque_ripple", 1, values={"sine": 1.5, "cosine": 0.5, "n": order})
    why, found = why_not(log_with(true))
    assert why is None
    assert found == pytest.approx(order, rel=0.02)


def test_a_magnet_is_none():
    why, found = why_not(with_extra(magnet))
    assert why is not None


@pytest.mark.parametrize(("low", "high"), [(-0.2, 0.5), (-0.5, 0.0), (0.1, 0.6), (-0.2, 0.2)])
def test_a_brake_between_two_angles_is_no_friction_by_the_position(low, high):
    why, found = why_not(with_extra(brake(low, high)), FRICTION)
    assert why is not None


@pytest.mark.parametrize("order", [1.5, 3.5])
def test_friction_by_the_position_is_one(order):
    true = replace(FRICTION, values={"sine": 1.5, "cosine": 0.5, "n": order})
    why, found = why_not(log_with(true), FRICTION)
    assert why is None
    assert found == pytest.approx(order, rel=0.1)


def test_only_orders_of_waves_are_seen_in_periods():
    """A load friction has numbers without a unit, too, and no periods."""
    motions = [prepare(log_with(), BAND)]
    assert hardly_repeats(replace(FRICTION, values={"n": 1.0}), motions)
    assert not hardly_repeats(replace(FRICTION, values={"n": 40.0}), motions)
    load = Term("load_dependent_friction", 1, values={"mu": 0.1, "inertial": 1.0})
    assert not hardly_repeats(load, motions)


@pytest.mark.parametrize(
    ("one", "other"), [(FEW, SPRING), (FEW, CUBIC), (CUBIC, DEAD_ZONE)], ids=lambda t: t.effect
)
def test_two_that_imitate_any_law_of_the_position_do_not_stand_together(one, other):
    """Whichever came first: a cushion was told as a cubic spring and such a ripple, which leave nothing."""
    motions = [prepare(log_with(), BAND)]
    assert imitates(one, [one, other], motions) and imitates(other, [one, other], motions)
    assert not imitates(one, [replace(other, joint=0)], motions)


@pytest.mark.parametrize(
    ("one", "other"),
    [(MANY, CUBIC), (MANY, MANY), (FEW, FEW), (FEW, BRISTLES), (SPRING, CUBIC)],
    ids=lambda t: t.effect,
)
def test_what_has_a_shape_of_its_own_may_stand_beside_another_one(one, other):
    motions = [prepare(log_with(), BAND)]
    assert not imitates(one, [other], motions) and not imitates(other, [one], motions)
