"""What began in the middle of the fitted log: another log may be of before, of after, or have it too."""

from dataclasses import replace

import pytest
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.report.error_change import begun
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.diagnose.selection.survives import survives
from jaxswarm.diagnose.selection.unseen_errors import UnseenErrors
from jaxswarm.effects.alike import has
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.forward.begun import ALL_ALONG, AS_FITTED, NOT_BEGUN, in_state_of, states_of
from jaxswarm.logs.motion import prepare

CHANGES = {
    "friction_change": Term("friction_change", 1, values={"fc": 1.5, "t0": 6.0}),
    "offset_change": Term("offset_change", 1, values={"tau": -2.0, "t0": 6.0}),
}
ALWAYS = {
    "friction_change": Term("coulomb_friction", 1, values={"fc": 1.5}),
    "offset_change": Term("torque_offset", 1, values={"tau0": -2.0}),
}


def other_log(name, state):
    """A log of other motion in which the change is as in the fitted one, is not, or was before."""
    terms = {AS_FITTED: [CHANGES[name]], NOT_BEGUN: [], ALL_ALONG: [ALWAYS[name]]}[state]
    return prepare(log_with(*terms, seed=5, motion_seed=11), BAND)


@pytest.fixture(scope="module", params=sorted(CHANGES))
def fits(request):
    change = CHANGES[request.param]
    motion = prepare(log_with(change), BAND)
    before = with_motion_noise(estimate(small_arm(), blank(), [motion], bounded=False))
    return request.param, before, refit(before, (*before.model.terms, change))


@pytest.mark.parametrize("state", [AS_FITTED, NOT_BEGUN, ALL_ALONG])
def test_a_change_survives_on_logs_of_before_and_after_it(fits, state):
    name, before, after = fits
    other = other_log(name, state)
    assert survives(before, after, 1, [other]) is None
    assert list(states_of(after.model, [other]).values()) == [state]
    (entry,) = UnseenErrors([other], before, after).validation
    assert entry["after"]["rms"][1] < 0.5 * entry["before"]["rms"][1]
    told = begun([entry])
    if state == AS_FITTED:
        assert not told
    else:
        ending = {NOT_BEGUN: "had not begun", ALL_ALONG: "was there all along"}[state]
        assert told == [f"on {entry['on']} {name}@joint2 {ending}"]


def test_a_jump_where_nothing_jumps_is_refused_by_another_log(fits):
    name, _, after = fits
    plain = prepare(log_with(seed=5), BAND)
    none = with_motion_noise(estimate(small_arm(), blank(), [plain], bounded=False))
    added = refit(none, (*none.model.terms, after.model.terms[-1]))
    assert added.model.terms[-1].effect == name
    assert survives(none, added, 1, [other_log(name, NOT_BEGUN)]) is not None


def test_an_event_of_the_fitted_log_says_nothing_of_another_one(fits):
    """It was in the model that told the state, and not in the one that was scored."""
    name, _, after = fits
    pushed = {"start": 1.0, "end": 9.0, "log": 0.0, "tau_joint1": 0.0, "tau_joint2": 50.0}
    event = Term("contact", values=pushed)
    model = replace(after.model, terms=(*after.model.terms, event))
    other = [other_log(name, NOT_BEGUN)]
    assert states_of(model, other) == states_of(after.model, other)
    assert not has(event, in_state_of(model, other).terms)
