"""What shows only where a joint reverses faster than samples tell is not added; what acts elsewhere too is."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import NEAR, Rules
from jaxswarm.diagnose.decision.sharpness import _noise_for, only_sharp, score_softly
from jaxswarm.diagnose.decision.worth import passes
from jaxswarm.diagnose.folds.beside_rest import beside_rest, beside_reversals
from jaxswarm.diagnose.folds.noise import noise_of, row_noise, with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.stand import in_all_motion
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.base import REGISTRY
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

# Standard deviation of what is sharp at reversals [N m], and the speed [rad/s] that is near one.
SHARP, SLOW = 3.0, 0.4
LAWS = {
    "stribeck_friction": {"df": 2.0, "vs": 0.1, "delta": 2.0},
    "quadratic_drag": {"c": 1.5},
}


def scored(effect: str, sharp: float, **values: float):
    """A log with a law of joint 2: its scores that pass, its fit and its folds."""
    log = log_with(Term(effect, 1, values=LAWS[effect] | values))
    found = with_motion_noise(estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False))
    (motion,) = found.motions
    slow = np.abs(motion.decimator.apply(motion.dq)) < SLOW
    noise = np.where(slow, sharp, motion.sharp_noise)
    found = replace(found, motions=(replace(motion, sharp_noise=noise),))
    crossfit = cross_fit(found)
    terms = eligible_terms(found.model, found.motions)
    scores = score_terms(Linearization(found, crossfit), terms, 0)
    return [s for s in scores if passes(s, len(scores), Rules())], found, crossfit


def asked(effect: str, sharp: float):
    """The scores that pass, and those of them that are sharp alone."""
    passed, found, crossfit = scored(effect, sharp)
    return passed, only_sharp(passed, found, crossfit, lambda s: passes(s, len(passed), Rules()))


def test_how_large_a_law_is_beside_the_torque_is_no_question_of_sharpness():
    """A true soft joint of a thousandth of the torque went, as quieter rows made it seem smaller."""
    passed, found, crossfit = scored("quadratic_drag", SHARP)
    (drag,) = [s for s in passed if s.candidate.term.effect == "quadratic_drag" and s.joint == 1]
    (softly,) = score_softly([drag], found, crossfit)
    rules = replace(Rules(), over_torque=drag.over_torque)
    assert softly.over_torque < drag.over_torque
    assert only_sharp([drag], found, crossfit, lambda s: passes(s, len(passed), rules)) == []


def names(scores) -> set[str]:
    return {s.candidate.term.effect for s in scores if s.joint == 1}


@pytest.mark.parametrize("effect", LAWS)
def test_nothing_is_sharp_where_the_samples_tell_all(effect):
    passed, sharp = asked(effect, 0.0)
    assert effect in names(passed)
    assert effect not in names(sharp)


def test_friction_at_reversals_goes_with_what_is_sharp_there():
    passed, sharp = asked("stribeck_friction", SHARP)
    assert "stribeck_friction" in names(passed)
    assert "stribeck_friction" in names(sharp)


def test_a_joint_that_is_near_its_noise_by_clocks_of_its_own_is_asked():
    """Left with 2.07 times the noise it was not asked, and a bristle was told of its reversals."""
    passed, found, crossfit = scored("stribeck_friction", SHARP)
    far = 3.0 * noise_of(found) / found.fit.sigma
    found = replace(found, fit=replace(found.fit, sigma=far * found.fit.sigma))
    sharp = only_sharp(passed, found, crossfit, lambda s: passes(s, len(passed), Rules()))
    assert "stribeck_friction" in names(sharp)
    # Where there is other motion it is left to that.
    tested = lambda s: passes(s, len(passed), Rules())  # noqa: E731
    assert only_sharp(passed, found, crossfit, tested, elsewhere=True) == []


def test_drag_stays_whatever_reversals_are():
    passed, sharp = asked("quadratic_drag", SHARP)
    assert "quadratic_drag" in names(passed)
    assert "quadratic_drag" not in names(sharp)


@pytest.mark.parametrize("changed", [0, 1])
def test_what_went_with_what_is_sharp_is_asked_again_whatever_changes(changed):
    """A drag of joint 2 went while joint 3 lacked Stribeck friction, and was not asked once it had that."""
    passed, found, crossfit = scored("stribeck_friction", SHARP)
    search = Search(found, found, Rules(), 0, Memory(), (), lambda text: None, Budget())
    search.crossfit, search.scores = crossfit, passed
    stays = in_all_motion(search, passed)
    friction = Term("stribeck_friction", 1).identity
    assert friction in search.banned and "stribeck_friction" not in names(stays)
    search.ask_again(changed)
    assert friction not in search.banned


@pytest.mark.parametrize("held, stays", [(False, True), (True, False)])
def test_what_stands_for_where_a_joint_hardly_moves_is_not_added(held, stays):
    """Dry friction may hold it there at any torque; what shows at all low speeds is a law."""
    passed, found, crossfit = scored("stribeck_friction", 0.0, df=0.3)
    (motion,) = found.motions
    slow = np.abs(motion.decimator.apply(motion.dq)) < SLOW
    (one,) = (s for s in passed if s.candidate.term.place[:2] == ("stribeck_friction", 1))
    event = np.where(slow, 10.0 * SHARP, motion.event_noise) if held else motion.event_noise
    found = replace(found, motions=(replace(motion, event_noise=event),))
    refused = only_sharp([one], found, crossfit, lambda s: passes(s, len(passed), Rules()))
    assert (not refused) == stays


def test_what_acts_at_all_speeds_has_to_show_beside_reversals():
    low = {name for name, law in REGISTRY.items() if _noise_for(law) is beside_rest}
    assert {"stribeck_friction", "hysteresis", "dwell_friction", "torque_dead_band"} <= low
    every = {name for name, law in REGISTRY.items() if _noise_for(law) is beside_reversals}
    assert {"gear_coupling_error", "joint_spring", "quadratic_drag", "base_tilt"} <= every
    usual = {name for name, law in REGISTRY.items() if _noise_for(law) is row_noise}
    assert usual == {name for name, law in REGISTRY.items() if law.everyday}


def test_beside_reversals_a_row_counts_by_what_friction_may_hold_there():
    """A true drag stays: it shows where the joint is fast."""
    passed, found, crossfit = scored("quadratic_drag", 0.0, c=0.1)
    (motion,) = found.motions
    noise, plain = beside_reversals(found)[:, 1], row_noise(found)[:, 1]
    speed = np.abs(motion.decimator.apply(motion.dq)[:, 1])
    fc = next(t.values["fc"] for t in found.model.terms if t.place[:2] == ("coulomb_friction", 1))
    assert np.median(noise[speed < 0.02 * speed.max()]) > 0.3 * fc
    assert np.median(noise[speed > 0.3 * speed.max()]) < 1.5 * np.median(plain)
    (one,) = (s for s in passed if s.candidate.term.place[:2] == ("quadratic_drag", 1))
    assert over_noise(found)[1] <= NEAR
    assert not only_sharp([one], found, crossfit, lambda s: passes(s, len(passed), Rules()))
