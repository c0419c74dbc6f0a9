"""Laws that one log hardly tells apart, told apart by the error they leave on other motion.

Where a user has given a second log, what a law is worth there decides between those that came near each other:
the shape of friction between two joints' speeds, say, is a matter of how often either speed was reached.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.rules import GAIN
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.selection.elsewhere import residuals_on, rms
from jaxswarm.diagnose.selection.refit import refit, refit_with
from jaxswarm.effects.alike import has
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion


def left_elsewhere(after: Estimate, before: Estimate, joint: int, other: Sequence[Motion]) -> float:
    """Largest ratio, over other logs, of a joint's errors under two fits."""
    pairs = (residuals_on(before, after, motion)[:2] for motion in other)
    errors = ((rms(one)[joint], rms(two)[joint]) for one, two in pairs)
    return float(max(two / max(one, 1e-300) for one, two in errors))


def no_worse(
    after: Estimate, before: Estimate, joint: int, other: Sequence[Motion], part: float = 1.0
) -> bool:
    """Whether a fit leaves at most a part of a joint's errors under another one on all other motion, if any."""
    return not other or left_elsewhere(after, before, joint, other) <= part


def told_elsewhere(current: Estimate, chosen: Score, other: Sequence[Motion]) -> Estimate | None:
    """The fit with a law that its own log does not tell from those that it contains, where other motion does.

    A spring of 0.028 +- 0.017 N m/rad beside a constant torque was refused by the log that it was fitted to,
    and told as one on a lever, of three numbers, which contains none. On the other log it left a fifth of the
    squared error that the constant torque left. Asked is what any addition has to take off, on every other log.
    On a measured arm whose joint lacked much else one of 15 +- 8 N m/rad, 12 in truth, was refused alike, and a
    cubic one told in its place.
    """
    term = chosen.candidate.term
    inner = [Term(name, term.joint) for name in term.law.contains]
    # One that bends has no fit of its own from which it could be judged here.
    if not other or not inner or any(t.law.nonlinear for t in inner):
        return None
    after = refit_with(current, chosen, beyond=False)
    if after is None:
        return None
    lacking = (t for t in inner if not has(t, current.model.terms))
    plain = refit(current, (*current.model.terms, *lacking))
    return after if no_worse(after, plain, chosen.joint, other, GAIN) else None


def best_elsewhere(
    current: Estimate,
    chosen: Score,
    after: Estimate,
    rivals: Sequence[Score],
    near: Sequence[Score],
    other: Sequence[Motion],
) -> tuple[Score, Estimate, list[Score]]:
    """The law to add, its fit, and the rivals that other motion does not tell from it.

    Args:
        current: The model without any of them.
        chosen, after: What one log prefers, and the fit with it.
        rivals: What that log does not tell from it.
        near: What passed too, gains nearly as much and says the same.
        other: Logs of other motion.
    """
    fits: dict[int, tuple[Score, Estimate | None]] = {id(chosen): (chosen, after)}
    for score in (*rivals, *near):
        if score.joint == chosen.joint and id(score) not in fits:
            fits[id(score)] = (score, refit_with(current, score))
    left = {
        key: np.inf if fit is None else left_elsewhere(fit, current, chosen.joint, other)
        for key, (_, fit) in fits.items()
    }
    best = min(left, key=lambda key: left[key])
    if left[best] > GAIN * left[id(chosen)]:
        best = id(chosen)
    kept = [
        s
        for s in (chosen, *rivals)
        if id(s) != best and (id(s) not in left or GAIN * left[id(s)] <= left[best])
    ]
    score, fit = fits[best]
    assert fit is not None  # what has no fit leaves more than anything
    return score, fit, kept
