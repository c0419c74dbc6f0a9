"""What takes a small part off a joint that stays far above its noise: it goes along with what is missing."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import LOST, LOST_SHARE, NEAR, SMALL_PART
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.selection.elsewhere import errors_elsewhere
from jaxswarm.diagnose.selection.may_not_stay import model_without, standing
from jaxswarm.diagnose.selection.refit import refit_once, share_left
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.diagnose.selection.without_steps import terms_without
from jaxswarm.effects.kinds import TransmissionLaw
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion


def shadow(search: Search) -> tuple[Step, str] | None:
    """The addition that takes least off its joint's error, if it is such, and why; None if none is."""
    current, left = search.current, over_noise(search.current)
    lost = set() if search.other else {int(j) for j in np.flatnonzero(left > LOST)}
    told = []
    for step in standing(search):
        law = step.added.law
        acts = {step.score.joint, step.added.joint}
        far = [j for j in acts if j is not None and left[j] > NEAR]
        event = law.in_one_log and (law.recurring or bool(search.other))
        if event or law.everyday or not far:
            continue
        rest = model_without(current, step)
        taken = 1.0 - share_left(current, rest)
        if lost & set(far):
            together = _taken_together(search, step, taken)
            told += [(together[j], LOST_SHARE, j, step) for j in lost & set(far)]
        if search.other:
            small = taken < SMALL_PART
            taken = np.ones_like(taken)
            if small[far].any():
                taken[small] = _most_elsewhere(rest, current, search.other)[small]
        told += [(taken[j], search.rules.share, j, step) for j in far]
    told = [item for item in told if item[0] < item[1]]
    if not told:
        return None
    share, _, joint, step = min(told, key=lambda item: item[0])
    search.lost |= lost & {joint}
    name = current.model.robot.joints[joint]
    where = " on other motion" if search.other else ""
    return step, _why(share, f"{name}{where}", left[joint])


def of_lost_joints(search: Search, passed: Sequence[Score]) -> list[tuple[Score, str]]:
    """Laws that would be taken back again, of joints from which one was already, and why.

    A joint that no law explains has many that explain a part of it. Each was added, had others beside it, and
    was taken back, in searches of their own: on a wrist of which one joint turns another a dozen of them
    took 20 minutes. What two laws explain together is asked of two.
    """
    over, told = over_noise(search.current), []
    for one in passed:
        law, joint = one.candidate.term.law, one.joint
        # Of a link on a spring first order tells little.
        known = law.shows_on_own_joint and not isinstance(law, TransmissionLaw)
        if joint not in search.lost or not known or law.in_one_log or law.everyday:
            continue
        share = max(one.share, one.trained)
        left = over[joint] * np.sqrt(max(0.0, 1.0 - share))
        if share < LOST_SHARE and left > LOST:
            name = search.current.model.robot.joints[joint]
            told.append((one, _why(share, name, left)))
    return told


def _why(share: float, joint: str, left: float) -> str:
    part = f"takes {100 * share:.0f} % off the squared error of {joint}"
    return f"{part}, which stays {left:.1f} times its noise"


def _taken_together(search: Search, step: Step, alone: np.ndarray) -> np.ndarray:
    """The part (n,) of the squared errors that all additions of a law and a place take: orders, and tones.

    A ripple is found order by order, and each takes what is its own.
    """
    current = search.current
    group = [s for s in standing(search) if s.added.place == step.added.place]
    if len(group) == 1:
        return alone
    terms = terms_without(group, current.model.terms)
    return 1.0 - share_left(current, refit_once(current, terms))


def _most_elsewhere(before: Estimate, after: Estimate, other: Sequence[Motion]) -> np.ndarray:
    """The largest part (n,) that an addition takes off the squared error of another log."""
    falls = [
        1.0 - (two / np.maximum(one, 1e-300)) ** 2
        for one, two, *_ in errors_elsewhere(before, after, other)
    ]
    return np.max(falls, axis=0)
