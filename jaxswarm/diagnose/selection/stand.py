"""Which of the candidates that passed may stand beside what the model has already."""

from collections.abc import Sequence
from dataclasses import replace

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.position_laws import imitates, is_unseen, strays
from jaxswarm.diagnose.decision.carried import is_carried
from jaxswarm.diagnose.decision.level import level_of
from jaxswarm.diagnose.decision.rules import BY_STATE, Rules
from jaxswarm.diagnose.decision.sharpness import (
    FoldsOf,
    only_friction,
    only_sharp,
    refitted_folds,
)
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.free_parts import coefficients, free_parts
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.diagnose.selection.shadow import of_lost_joints
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.tenable import winds_up
from jaxswarm.diagnose.selection.without_end import jumps_for_events
from jaxswarm.effects.kinds import BodyChange

_ALONE = "shows in dry friction alone, which may be early or late by itself"
_SHARP = "shows only where the motion is sharper than its samples"
_STRAY = "is no multiple of an order seen through too few periods"
_UNSEEN = "is an order of which no whole period is seen: move the joint further"
_BENT = "would be, with another law, any torque of one place"
_NO_LOAD = "is no load: constant torques in its time tell as much, whatever the arm's posture"
_NO_EVENT = (
    "is no event: a law of the motion, itself not proven, tells more, and tells it from other times"
)


def that_may_stand(search: Search, passed: Sequence[Score]) -> list[Score]:
    """Those that passed without what may not stand beside the model as it is, refused with the reason."""
    model, motions = search.current.model, search.current.motions
    passed = _that_wind_up(search, passed)
    passed = jumps_for_events(passed, search.scores, search.current)
    stray = [s for s in passed if strays(s.candidate.term, model.terms, motions)]
    bent = [s for s in passed if imitates(s.candidate.term, model.terms, motions)]
    unseen = [s for s in passed if is_unseen(s.candidate.term, motions)]
    motion = events_of_laws(search.scores, passed, search.folds, search.rules)
    loads = [s for s in passed if _is_body(s) and not is_carried(s, search.folds)]
    standing = in_all_motion(search, passed)
    refused = [(s, _STRAY) for s in stray] + [(s, _BENT) for s in bent]
    refused += [(s, _UNSEEN) for s in unseen] + [(s, _NO_EVENT) for s in motion]
    refused += [(s, _NO_LOAD) for s in loads] + of_lost_joints(search, passed)
    for one, why in refused:
        search.refuse(one.candidate.term, why)
    _ask_in_place(search, bent)
    for one in sorted(unseen, key=lambda s: s.worth):
        search.unseen[one.candidate.term.joint] = one
    # Should the law that is there be none, these are asked again.
    search.kept_out |= {one.candidate.term.joint for one in bent}
    gone = [one for one, _ in refused]
    return [s for s in standing if s not in gone]


def _that_wind_up(search: Search, passed: Sequence[Score]) -> list[Score]:
    """Those that passed without bristles of the least way there is: friction that holds a joint, not a law.

    Of 25 such that were fitted all the same, 1 to 15 s each, none was more; true ones begin far above it.
    """
    for one in passed:
        if not winds_up(one.candidate.term):
            search.refuse(one.candidate.term)
    return [s for s in passed if winds_up(s.candidate.term)]


def _ask_in_place(search: Search, bent: Sequence[Score]) -> None:
    """Let laws that imitate any beside one of their place be asked in the place of that, all others there.

    That one may have been chosen while bristles on its joint were still missing: a spring with a dead zone was
    told for a balancer, beside which all was within the noise and held-out time told by 0.08 % instead of 0.30.
    """
    motions = search.current.motions
    for one in bent:
        for k, step in enumerate(search.steps):
            if imitates(one.candidate.term, [step.added], motions):
                search.steps[k] = replace(step, near=(*step.near, one))
                search.settled = False


def _is_body(s: Score) -> bool:
    law = s.candidate.term.law
    return isinstance(law, BodyChange) and law.window


def events_of_laws(
    scores: Sequence[Score], passed: Sequence[Score], crossfit: CrossFit, rules: Rules
) -> list[Score]:
    """Events that passed and that a law of their joint tells from other times, and more beside them.

    An event is what no other time tells of. The law need not be proven against all that were asked: friction
    that grows with the position was told as a push of half a second where the joint went furthest. Friction by
    the position told 0.6 of that push from the rest of the log and took off more than twice as much, by p =
    0.0004, which is too little of its own among a hundred.
    """
    lasting = [
        s
        for s in scores
        if not s.candidate.term.law.in_one_log
        and s.allowed
        and s.p_value < rules.significance
        and s.share >= rules.share
    ]
    return [
        event
        for event in passed
        if event.candidate.term.law.recurring
        and any(
            s.joint == event.joint
            and s.worth > event.gain
            and _share_within(s.candidate, event, crossfit) > BY_STATE
            for s in lasting
        )
    ]


def _share_within(candidate: Candidate, event: Score, crossfit: CrossFit) -> float:
    """Share of an event's squared error, on its joint, that a candidate tells from other times."""
    inside = event.candidate.columns[0].any(axis=(1, 2))
    before = after = 0.0
    parts = next(free_parts([candidate.columns], crossfit))
    for fold, free in zip(crossfit.halves, parts[1:], strict=True):
        a = coefficients(candidate.view(free), fold, candidate.view(fold.residual))
        rows = inside & ~fold.train
        left = fold.residual[rows, event.joint]
        before += float((left**2).sum())
        after += float(((left - free[rows, event.joint] @ a) ** 2).sum())
    return 1.0 - after / max(before, 1e-300)


def in_all_motion(
    search: Search, passed: Sequence[Score], folds_of: FoldsOf = refitted_folds
) -> list[Score]:
    """Those that passed and show in all motion and torque they should show in; others refused with the reason.

    ``folds_of``: makes the folds of the model by the noise of every row.
    """
    current, folds = search.current, search.folds
    tested = level_of(search.scores, search.rules, search.added)
    sharp = only_sharp(list(passed), current, folds, tested, folds_of, bool(search.other))
    alone = only_friction(passed, current, folds, tested)
    for found, why in ((sharp, _SHARP), (alone, _ALONE)):
        for one in found:
            search.refuse(one.candidate.term, why, by_all=True)
    return [s for s in passed if s not in (*sharp, *alone)]
