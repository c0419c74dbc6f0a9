"""The loop: ask every suspect, add the guilty one, refit, ask again; drop what became superfluous."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.eligible import list_suspects
from jaxswarm.diagnose.candidates.journal import Journal
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.competing import choose
from jaxswarm.diagnose.decision.evaluate import judge
from jaxswarm.diagnose.decision.score import Rules, Score, passes
from jaxswarm.diagnose.decision.unexplained import find_unexplained
from jaxswarm.diagnose.folds.partial_out import CrossFit, cross_fit
from jaxswarm.diagnose.selection.everyday import add_everyday
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.reselect import choose_again
from jaxswarm.diagnose.selection.step import Step, find_term, near_ones
from jaxswarm.diagnose.selection.survives import survives
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.estimation.estimate import Estimate, estimate
from jaxswarm.logs.motion import Motion, shift_motion
from jaxswarm.robot.model import Robot

# Rounds per joint, and for any arm; how often the clocks' skew is found anew.
_ROUNDS_PER_JOINT, _LEAST_ROUNDS, _MOST_SKEWS = 4, 12, 3
# A skew [s] below this moves a torque at 10 Hz by a thousandth of its size.
_LEAST_SKEW = 2e-5
# Events of one kind that are looked for in a row.
_MOST_EVENTS = 20
# A law below the first share of a joint's error is doubted where a smooth function reaches the second.
_SMALL_PART, _NEARLY_ALL = 0.4, 0.7


@dataclass(frozen=True)
class Diagnosis:
    """The outcome of the loop.

    Attributes:
        declared: The estimate of the declared model.
        final: The estimate after the last step.
        steps: What was added, in order.
        last: Scores of all suspects in the final round, in which nobody passed.
        background: The folds of the final model.
        asked: Suspects asked in the first round.
        withdrawn: What was added and later exchanged or dropped, with all effects in place.
        ended: Whether the search ended by its number of rounds, and more might be added.
        refused: What would have been added but did not survive on other motion, and why.
    """

    declared: Estimate
    final: Estimate
    steps: tuple[Step, ...]
    last: tuple[Score, ...]
    background: CrossFit
    asked: int
    withdrawn: tuple[Term, ...] = ()
    refused: tuple[tuple[Term, str], ...] = ()
    ended: bool = False

    @property
    def kept(self) -> tuple[Step, ...]:
        """The steps whose effect was not removed again by a later one."""
        gone = {t.identity for step in self.steps for t in step.removed}
        return tuple(step for step in self.steps if step.added.identity not in gone)


def diagnose(
    robot: Robot,
    declared: tuple[Term, ...],
    motions: Sequence[Motion],
    *,
    rules: Rules | None = None,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    journal: Journal | None = None,
    other: Sequence[Motion] = (),
) -> Diagnosis:
    """Find what a declared model lacks.

    Args:
        robot: Kinematics.
        declared: Terms the user knows of.
        motions: Prepared logs with torque.
        rules: Thresholds of the decision.
        seed: Seed of the searches.
        progress: Called with one line per stage.
        journal: Keeps the searches on disk, so that an interrupted diagnosis can go on.
        other: Prepared logs of other motion, with torque: what is added has to survive on them.

    Returns:
        The :class:`Diagnosis`.
    """
    rules = rules or Rules()
    progress("fitting the declared model")
    current = estimate(robot, declared, motions, bounded=False)
    first, steps, banned, asked, skews = current, [], set(), 0, []
    memory, settled, withdrawn, refused = Memory(journal, rules.share), False, (), []
    ended = False
    most_rounds = max(_LEAST_ROUNDS, _ROUNDS_PER_JOINT * robot.num_joints)
    for round_number in range(most_rounds + 1):
        progress(
            f"round {round_number + 1}: asking the suspects, {_error(current):.3g} % error so far"
        )
        background = cross_fit(current)
        stand = Linearization(current, background, memory)
        suspects = [
            t for t in list_suspects(current.model, current.motions) if t.identity not in banned
        ]
        late = clock_skew(stand, suspects, seed) if len(skews) < _MOST_SKEWS else 0.0
        if abs(late) > _LEAST_SKEW:
            skews.append(late)
            current = with_skew(current, late)
            first = current if not steps else first
            continue
        scores = judge(stand, suspects, seed)
        asked = asked or len(scores)
        guilty = [s for s in scores if passes(s, len(scores), rules)]
        # What happens once is believed only if nothing that lasts explains more.
        most = max((s.gain for s in scores), default=0.0)
        guilty = [s for s in guilty if not s.candidate.term.law.recurring or s.gain >= most]
        if round_number == most_rounds:
            ended = bool(guilty)
            break
        if not guilty:
            if settled or not steps:
                break
            settled = True
            former = steps
            steps, current, changed = choose_again(
                steps, current, background, asked, rules, seed, progress
            )
            if not changed:
                break
            held = {s.added.identity for s in steps}
            withdrawn = tuple(s.added for s in former if s.added.identity not in held)
            continue
        together = add_everyday(current, scores, len(scores), rules)
        if together:
            progress(f"round {round_number + 1}: adding what every drive has")
            steps, current = [*steps, *together[0]], together[1]
            continue
        chosen, rivals = choose(guilty, rules, background)
        if stands_in(chosen, current, background, seed):
            banned.add(replace(chosen.candidate.term, values={}).identity)
            continue
        progress(f"round {round_number + 1}: adding {chosen.candidate.term.label(robot.joints)}")
        after, removed = add(current, chosen)
        if after is None:
            banned.add(replace(chosen.candidate.term, values={}).identity)
            continue
        term = chosen.candidate.term
        why = None if term.law.recurring else survives(current, after, chosen.joint, other)
        if why:
            refused.append((term, why))
            banned.add(replace(term, values={}).identity)
            continue
        added = find_term(after, term)
        others = [
            s for s in sorted(scores, key=lambda s: -s.gain) if s is not chosen and s.gain > 0
        ]
        near = near_ones(chosen, guilty, background)
        told = tuple(rivals), tuple(others[:8])
        steps.append(Step(added, chosen, *told, current, after, removed, near))
        current = after
        if added.law.recurring:
            steps, current = further_events(steps, current, added, asked, rules, memory, seed)
        # What was refused on this joint was refused without the new effect.
        banned = {key for key in banned if key[1] != added.joint}
    return Diagnosis(
        first,
        current,
        tuple(steps),
        tuple(scores),
        background,
        asked,
        withdrawn,
        tuple(refused),
        ended,
    )


def further_events(
    steps: list[Step], current: Estimate, first: Term, asked: int, rules: Rules, memory, seed: int
) -> tuple[list[Step], Estimate]:
    """Add what else of an event's kind is in the logs, one after the other, with nothing else asked."""
    for _ in range(_MOST_EVENTS):
        background = cross_fit(current)
        stand = Linearization(current, background, memory)
        told = judge(stand, [replace(first, values={})], seed)
        if not told or not passes(told[0], asked, rules):
            break
        after, removed = add(current, told[0])
        if after is None:
            break
        added = find_term(after, told[0].candidate.term)
        steps = [*steps, Step(added, told[0], (), (), current, after, removed)]
        current = after
    return steps, current


def stands_in(chosen: Score, current: Estimate, background: CrossFit, seed: int) -> bool:
    """Whether a law only stands in for one that no catalog holds.

    That is so if it explains a small part of what a smooth function of one or two variables explains
    nearly all of.
    """
    if chosen.share > _SMALL_PART or chosen.candidate.term.joint is None:
        return False
    smooth = find_unexplained(current, background, seed, [chosen.joint])
    return bool(smooth and smooth[0].share > max(_NEARLY_ALL, 2.0 * chosen.share))


def clock_skew(stand: Linearization, suspects: Sequence[Term], seed: int) -> float:
    """A delay [s] below half a sample: a matter of the clock, not of the robot, and so always allowed for.

    Every sampled and held torque is early or late by a part of a sample. The estimate is shrunk by its own
    certainty, the positive-part rule of W. James and C. Stein (1961): nothing where there is nothing.
    """
    for s in judge(stand, [t for t in of_kind(suspects, MeasurementLaw) if t.law.clock], seed):
        if not s.allowed and s.gain > 0:
            certainty = float(-special.ndtri(max(s.p_value, 1e-300)))
            return float(s.coefficients[0]) * max(0.0, 1.0 - 1.0 / max(certainty, 1e-9) ** 2)
    return 0.0


def with_skew(current: Estimate, seconds: float) -> Estimate:
    """The same model fitted to logs whose motion is moved against the torque."""
    motions = tuple(shift_motion(m, seconds) for m in current.motions)
    return estimate(
        current.model.robot,
        current.model.terms,
        motions,
        bounded=False,
        start=np.asarray(current.model.robot.parameters).ravel(),
    )


def add(current: Estimate, chosen: Score) -> tuple[Estimate | None, tuple[Term, ...]]:
    """Refit with the chosen term, without what it contains; None if the refit does not confirm it."""
    after = refit_with(current, chosen)
    if after is None:
        return None, ()
    kept = {t.identity for t in after.model.terms}
    return after, tuple(t for t in current.model.terms if t.identity not in kept)


def _error(one: Estimate) -> float:
    """Relative error [%] of a fit, all joints."""
    size = np.linalg.norm(one.regression.torque)
    return float(100.0 * np.linalg.norm(one.fit.residual) / max(size, 1e-300))
