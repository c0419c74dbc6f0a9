"""Events that are rests: where joints hardly move, dry friction leaves as much of their torque elsewhere."""

import numpy as np

from jaxswarm.diagnose.decision.rules import LIKE_RESTS
from jaxswarm.diagnose.folds.noise import noise_of
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.effects.kinds import ExternalTorque
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.standing import hardly_moving
from jaxswarm.identify.forward.model import model_torque
from jaxswarm.identify.forward.written_down import clock_lag
from jaxswarm.logs.motion import Motion


def rows_within(found: Estimate, event: Term) -> np.ndarray:
    """The rows (T,) between an event's begin and end."""
    t = found.regression.t - clock_lag(found.model.terms)
    within = (t >= event.values["start"]) & (t <= event.values["end"])
    return within & (found.regression.log == event.values["log"])


def held_within(search: Search, step: Step) -> bool:
    """Whether friction was found to hold the joint of an event, or all that it acts on, in most of its window.

    A push of 54 N m on the first joint of an arm in motion was taken back, since the last one stood: all six
    joints were left with 24 to 210 times their noise. No row of a window is used for anything else; asked is
    which of them friction was found to hold.
    """
    joints, current = [step.score.joint], search.current
    if isinstance(step.added.law, ExternalTorque):
        joints += np.flatnonzero(_is_loud(current, step.added)).tolist()
    every = np.concatenate([m.held for m in current.motions if m.held is not None])
    held = every[rows_within(current, step.added)][:, joints]
    return search.sticking.issuperset(joints) and bool((2 * held.sum(axis=0) > len(held)).all())


def like_other_rests(current: Estimate, event: Term) -> bool:
    """Whether every joint of an external torque hardly moves in its window and has as much left at other rests.

    A joint that stops is held at any torque within its friction. Of an arm that stopped in 40 ms one rest of
    0.09 s before its next move was told as a contact of six joints. Their torques were 0.8 to 1.4 times the RMS
    that other rests were left with, which was 3 to 19 times that of motion. A push (q07) had 38 to 200 times
    what other rests were left with.
    """
    if not isinstance(event.law, ExternalTorque):
        return False
    torque, loud = _torque(current, event), _is_loud(current, event)
    slow, within = np.concatenate(hardly_moving(current.motions)), rows_within(current, event)
    rests = slow & ~within[:, None]
    left = np.concatenate([_left(current, motion) for motion in current.motions])
    power = np.where(rests, left**2, 0.0).sum(axis=0) / np.maximum(rests.sum(axis=0), 1)
    alike = (2 * slow[within].sum(axis=0) > within.sum()) & (torque < LIKE_RESTS * np.sqrt(power))
    return bool(loud.any() and alike[loud].all())


def _torque(current: Estimate, event: Term) -> np.ndarray:
    """Size of an external torque on every joint, (n,) [N m or N]."""
    return np.abs([event.values[n] for n in event.linear_names(current.model.robot.joints)])


def _is_loud(current: Estimate, event: Term) -> np.ndarray:
    """Whether it is beyond the noise of each joint, (n,)."""
    return _torque(current, event) > noise_of(current)


def _left(found: Estimate, motion: Motion) -> np.ndarray:
    """What a model leaves on all rows of a log, used or not, (T', n)."""
    assert motion.tau is not None  # it was fitted
    return motion.decimator.apply(motion.tau - model_torque(found.model, motion))
