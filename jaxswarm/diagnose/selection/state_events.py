"""Events of a log and laws by the time that are none: of no number, or told by where the arm was."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.like_states import told_by_states
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import BY_CHANCE, BY_STATE, FAR_LESS, LIKE_STATES, LOUD
from jaxswarm.diagnose.decision.smooth_rows import table_of
from jaxswarm.diagnose.decision.unexplained import Unexplained, find_unexplained
from jaxswarm.diagnose.folds.noise import noise_of, with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.event_at_rest import held_within, like_other_rests, rows_within
from jaxswarm.diagnose.selection.event_elsewhere import of_place
from jaxswarm.diagnose.selection.refit import refit, share_left
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step, with_errors
from jaxswarm.diagnose.selection.survives import proven
from jaxswarm.diagnose.selection.tenable import is_certain
from jaxswarm.effects.alike import has, without
from jaxswarm.effects.kinds import ExternalTorque
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate


def event_of_nothing(search: Search) -> tuple[Step, str] | None:
    """The first event that is told by nothing any more, and why it is none; None if none is.

    Of one no number is told from zero: a load of -5 +- 8 g, carried for 18 of 28 s, was told on a log whose
    torque has noise that lasts for seconds, and the last joint's error of other motion was 2.4 times as large
    with it. The other was in rows that are left out by now: a rest between two moves, at a torque at which
    friction held the joint, was told as a contact. So is a rest that has no more than others have.
    """
    current = search.current
    for step in search.steps:
        known = with_errors(step.added, current)
        if known is None or not _lasts(step.added):
            continue
        if not is_certain(*known):
            return step, "is an event of which no number is told from zero"
        if held_within(search, step) or like_other_rests(current, step.added):
            own = current.model.robot.joints[step.score.joint]
            return step, f"was told by a rest, in which dry friction holds {own} at any torque"
    return None


def event_of_state(search: Search) -> tuple[Step, str] | None:
    """An event that a function of the arm's motion predicts as well, and why it is none; None if none is.

    What is left without all events of its joint has to follow that function on blocks of the log that it was
    not fitted to, and so have their windows. A cushion at the end of the travel was told as five contacts, each
    while the arm rested in it. Events that leave far less than that function are what it goes along with: on
    motion from point to point two positions predicted 83 % of a load that was picked up for half a log.
    """
    current = search.current
    held = current.model.terms
    events = [step for step in search.steps if _lasts(step.added) and has(step.added, held)]
    for joint in sorted({step.score.joint for step in events}):
        own = [step for step in events if step.score.joint == joint]
        terms = [step.added for step in own]
        alone = [event for event in terms if _is_of_one(current, joint, event)]
        why = (
            _by_function(search, joint, terms)
            or _of_like_states(current, joint, alone)
            or of_place(current, joint, alone, search.other)
        )
        if why:
            return own[0], f"{why}: no event is needed"
    return None


def time_of_state(search: Search) -> tuple[Step, str] | None:
    """A law by the time instead of which the arm's motion tells more, and why it is none; None if none is.

    The function of the motion has to hold in regions of states it was not fitted to and on other logs, to leave
    less than the law does, and to take over what the law takes: friction by another joint's position was told
    as friction that changed in the middle of the log, and the error of other motion grew by half. A function of
    another joint's speed took 84 % off what friction that falls as its joint warms had left, and 12 % off
    another log. A law that leaves its joint within its noise leaves nothing to tell: of friction that fell at
    once a function of two joints told 95 %, with 96 numbers, and the law with two 93 %.
    """
    current, quiet = search.current, over_noise(search.current) <= LOUD
    for step in search.steps:
        term, joint = step.added, step.added.joint
        held = has(term, current.model.terms)
        if joint is None or term.law.shown_against != "time" or not held or quiet[joint]:
            continue
        bare = refit(current, without(term, current.model.terms))
        rest = with_motion_noise(bare, search.seed)
        left = _shown(rest, joint, search)
        if not left or "t" in left[0].depends_on:
            continue
        before, by_time = (e.fit.residual[:, joint] for e in (rest, current))
        taken = before - by_time
        kept = taken @ _left_by(rest, left[0]) / max(float(taken @ taken), 1e-300)
        leaves = share_left(current, rest)[joint]
        if kept < 1.0 - BY_STATE and 1.0 - left[0].share < leaves:
            names = " and ".join(left[0].depends_on)
            return step, (
                f"takes {100 * (1.0 - leaves):.0f} % off the squared error of "
                f"{current.model.robot.joints[joint]}, a function of {names} "
                f"{100 * left[0].share:.0f} %: no time is needed"
            )
    return None


def _shown(rest: Estimate, joint: int, search: Search) -> list[Unexplained]:
    """What the residual of a joint follows that holds in regions it was not fitted to, and on other logs."""

    def held(found: list[Unexplained]) -> list[Unexplained]:
        return [item for item in found if (item.elsewhere or 0.0) >= BY_STATE]

    left = held(find_unexplained(rest, cross_fit(rest), search.seed, [joint]))
    return held(proven(rest, left, search.other))


def _by_function(search: Search, joint: int, events: Sequence[Term]) -> str | None:
    """Why events of a joint are none, if a function of the motion predicts them."""
    current, terms = search.current, search.current.model.terms
    for event in events:
        terms = without(event, terms)
    rest = with_motion_noise(refit(current, terms), search.seed)
    left = find_unexplained(rest, cross_fit(rest), search.seed, [joint])
    left = _uncontradicted(rest, left, search)
    if not left or "t" in left[0].depends_on or left[0].share < BY_STATE:
        return None
    if share_left(current, rest)[joint] < FAR_LESS * (1.0 - left[0].share):
        return None
    share = _share_within(rest, left[0], events)
    if share <= BY_STATE:
        return None
    names = " and ".join(left[0].depends_on)
    return (
        f"is {100 * share:.0f} % a function of {names}, which predicts {100 * left[0].share:.0f} % of what "
        f"{current.model.robot.joints[joint]} lacks"
    )


def _uncontradicted(rest: Estimate, left: list[Unexplained], search: Search) -> list[Unexplained]:
    """What the residual of a joint follows, where no other log is worse for it.

    On motion that goes through few states the two positions at which a load was carried, eight times what a log
    shows, told 86 % of what it did to its joint; on another log they said nothing of the kind, and the load was
    taken back for them. A state that the other log does not come to contradicts nothing.
    """
    if not search.other:
        return left
    return [item for item in proven(rest, left, search.other) if (item.elsewhere or 0.0) >= 0.0]


def _of_like_states(current: Estimate, joint: int, events: Sequence[Term]) -> str | None:
    """Why torques of a joint alone are no pushes: where it was and how it moved tells their windows.

    A dashpot that acted one way beyond an angle was told as five contacts of one joint, each while that went
    this way: of the two long ones one did not predict the other's torque, so that no function of the motion
    held, but none of them lay elsewhere. Nor need they go one way: friction at one place was told as three, to
    either side, of which 0.81 lay nearest to one another by the position and 0.14 by the speed as well. What is
    pushed feels it on the joints before it, too.
    """
    if len(events) < 2:
        return None
    window = np.full(len(current.regression.t), -1)
    for number, event in enumerate(events):
        window[rows_within(current, event)] = number
    name, table = current.model.robot.joints[joint], table_of(current)
    asked = [one for one in (f"q_{name}", f"dq_{name}") if one in table]
    for some in dict.fromkeys((tuple(asked), tuple(asked[:1]))):
        share, chance = told_by_states(np.stack([table[one].raw for one in some], axis=1), window)
        if share >= LIKE_STATES and chance <= BY_CHANCE:
            return (
                f"is one of {len(events)} on {name} alone that go by {' and '.join(some)}: "
                f"{100 * share:.0f} % of their time is nearest to another of them"
            )
    return None


def _is_of_one(current: Estimate, joint: int, event: Term) -> bool:
    """Whether an event has no torque above the noise but on one joint."""
    if not isinstance(event.law, ExternalTorque):
        return False
    names = event.linear_names(current.model.robot.joints)
    torque = np.abs([event.values[name] for name in names])
    return not np.any(np.delete(torque > noise_of(current), joint))


def _lasts(term: Term) -> bool:
    """Whether a term is an event with a begin and an end."""
    return term.law.in_one_log and {"start", "end"} <= set(term.values)


def _share_within(rest: Estimate, left: Unexplained, events: Sequence[Term]) -> float:
    """Share of the squared error within the windows of events that a smooth function takes off."""
    inside = np.any([rows_within(rest, event) for event in events], axis=0)
    before, after = rest.fit.residual[:, left.joint], _left_by(rest, left)
    return 1.0 - float(np.sum(after[inside] ** 2) / max(np.sum(before[inside] ** 2), 1e-300))


def _left_by(rest: Estimate, left: Unexplained) -> np.ndarray:
    """What a smooth function leaves of its joint's residual, (T,)."""
    columns = rest.regression.columns[:, left.joint]
    return rest.fit.residual[:, left.joint] - left.smooth - columns @ left.change
