"""What is taken back once nothing more is added: what does harm, and what stands for something else."""

from collections.abc import Callable, Sequence

from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import PAIR_ASKED
from jaxswarm.diagnose.selection.may_not_stay import (
    idle,
    nothing,
    of_noise,
    outdone,
    poor,
    raises_its_own,
    stand_in,
)
from jaxswarm.diagnose.selection.shadow import shadow
from jaxswarm.diagnose.selection.state import Search, kind_of
from jaxswarm.diagnose.selection.state_events import event_of_nothing, event_of_state, time_of_state
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.diagnose.selection.survives import harmful
from jaxswarm.diagnose.selection.unpredicted import unpredicted
from jaxswarm.diagnose.selection.without_steps import go_on_without
from jaxswarm.effects.term import Term


def take_back(search: Search) -> bool:
    """Take back what may not stay; whether a law, or two, may now be found that one of these had kept out.

    A stop was told as a cubic spring, beside which no spring with a dead zone may stand, and the cubic spring
    was taken back as a law of another form: a residual of 59 times the noise, which the other one explains.
    What harms other motion may hide any law of its joint: beside a rotor that was refused there a spring of a
    slide was too small to matter, and without it the slide was unexplained.
    """
    before = list(search.steps)
    take_back_harm(search)
    hid = {t.joint for t in _gone(search, before)}
    _take_back(search, lambda: outdone(search) or of_noise(search))
    take_back_events(search)
    take_back_shadows(search)
    take_back_stand_ins(search)
    gone = _gone(search, before)
    again = {t.joint for t in gone} & (search.kept_out | hid)
    search.kept_out -= again
    # A spring and a lever on a spring took each other's place for ever; of pushes any may be another one.
    kinds = {kind_of(t) for t in gone if t.joint is not None}
    search.barred |= {kind_of(t) for t in gone if t.joint in again} | kinds & search.gone
    search.gone |= kinds
    search.banned = {key for key in search.banned if key[1] not in again}
    search.settled = search.settled and not again
    return bool(again) or _may_be_two(search, gone)


def _may_be_two(search: Search, gone: Sequence[Term]) -> bool:
    """Whether a joint is far from its noise without what was taken back: two laws may hide each other there.

    Friction of either direction stood in for friction by the position and a drag, and was taken back for that:
    nobody asked for the two while it was there.
    """
    over = over_noise(search.current)
    return any(t.joint is not None and over[t.joint] > PAIR_ASKED for t in gone)


def _gone(search: Search, before: Sequence[Step]) -> list[Term]:
    """What was added before and is not any more."""
    held = {s.added.identity for s in search.steps}
    return [s.added for s in before if s.added.identity not in held]


def take_back_harm(search: Search) -> None:
    """Take back, one after the other, what in the end raises a joint's error on other motion or other time."""

    def wrong() -> tuple[Step, str] | None:
        told = search.declared, search.steps, search.current
        if found := harmful(*told, search.other):
            return found
        return raises_its_own(search) if search.other else unpredicted(*told)

    _take_back(search, wrong)


def take_back_idle(search: Search) -> bool:
    """Take back what is not told from nothing once clocks and widths are settled, and proves itself no more.

    Whether anything was.

    Beside clocks and widths of a worse minimum a drive's dead band of -9.1 +- 0.8 N m took half of its joint's
    squared error; beside those of the final fit it was -0.7 +- 0.7 N m, and stood in the headline.
    """
    return _take_back(search, lambda: idle(search))


def take_back_nothing(search: Search) -> bool:
    """Take back what is held at nothing in the end; whether anything was."""
    return _take_back(search, lambda: nothing(search))


def take_back_events(search: Search) -> None:
    """Take back events that nothing is left to, and what a function of the arm's motion predicts as well."""
    _take_back(search, lambda: event_of_nothing(search))
    _take_back(search, lambda: event_of_state(search) or time_of_state(search), events=True)


def take_back_shadows(search: Search) -> None:
    """Take back what explains a small part of what its joint lacks, where the rest stays far above the noise.

    What is missing there has no name, and what goes along with a part of it has no better one: an encoder's
    eccentricity took a fifth off what another joint had left, an eighth off its own, which a soft gear left at
    5.6 times the noise (q10). The part is that which a law has to take off the joint where it shows most, and
    nearly all where what is left is very far above the noise. What takes as much off another log is shown: on
    an arm that swayed on its base, at 2.6 times the noise, a spring that was none took 0.13 off there.
    """
    _take_back(search, lambda: shadow(search))


def take_back_stand_ins(search: Search) -> None:
    """Take back what leaves a function of what its own law is about: far above the noise little else, near it
    much beside what it took.

    It has the place and the variable of what is missing, not its form: a cushion at the end of the travel was
    told as a spring with a dead zone, friction by the partner's direction as a coupling of velocities. A ripple
    may have more orders than were found, and beside everyday friction there may be any other. What a law leaves
    that is small beside what it took is a detail of it. Nor is one left that leaves a third of what a smooth
    function explains nearly all of: two bumps were told as a ripple.
    """
    other_form = _take_back(search, lambda: stand_in(search), events=True)
    little = _take_back(search, lambda: poor(search), events=True)
    if other_form or little:
        # What a law hid shows now: four contacts of one joint stood beside a cable that was taken off another.
        take_back_events(search)


def _take_back(
    search: Search, wrong: Callable[[], tuple[Step, str] | None], events: bool = False
) -> bool:
    """Take back what is wrong, with the reason, until nothing is; ``events`` of its joint with it.

    Whether anything was.
    """
    before = len(search.steps)
    while search.steps:
        found = wrong()
        if found is None:
            break
        step, why = found
        search.refuse(step.added, why)
        gone = [s for s in search.steps if s is step or _goes_with(s, step, events)]
        go_on_without(search, gone)
    return len(search.steps) < before


def _goes_with(one: Step, step: Step, events: bool) -> bool:
    """Whether an addition is the other end of another one's law, or an event found beside it on its joint.

    Beside a spring that stood in for a cushion two contacts were told at the ends of the travel.
    """
    a, b = one.added, step.added
    joint = step.score.joint if b.joint is None else b.joint
    ends = a.law.mutual and (a.effect, a.joint, a.other) == (b.effect, b.other, b.joint)
    return ends or (events and a.law.in_one_log and one.score.joint == joint)
