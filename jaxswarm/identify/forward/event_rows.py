"""Rows and columns of a regression that belong to events of a log: nothing of them is fitted with the rest."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.written_down import clock_lag
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot


def event_rows(terms: Sequence[Term], motion: Motion, number: int) -> np.ndarray:
    """Whether the low-pass of a decimated row of a log, by its number, reaches into an event, (T',)."""
    reach = 0.5 * (len(motion.decimator.taps) - 1) / motion.rate
    t = motion.t[motion.decimator.kept(len(motion.t))] - clock_lag(terms)
    within = np.zeros(len(t), dtype=bool)
    for term in terms:
        if term.law.recurring and int(term.values.get("log", 0)) == number:
            within |= (t >= term.values["start"] - reach) & (t <= term.values["end"] + reach)
    return within


def event_columns(robot: Robot, terms: Sequence[Term]) -> np.ndarray:
    """Which columns belong to events of a log, (p,): nothing of them is fitted with the rest."""
    flags = [np.full(len(t.columns(robot.joints)), t.law.recurring) for t in terms]
    return np.concatenate([np.zeros(10 * robot.num_joints, bool), *flags])
