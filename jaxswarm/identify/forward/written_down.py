"""How drives and their clock write down torques: with each other's, each its own, then all of them late."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.identify.forward.own_columns import placed
from jaxswarm.logs.motion import Motion


def report(terms: tuple[Term, ...], motion: Motion, block: np.ndarray) -> np.ndarray:
    """Torques (T, n, ...) as they are written down: by the drive of each joint, then by their clock.

    What a sensor picks up of another joint is the true torque there, whatever that one's sensor picks up.
    """
    measured = in_order(terms)
    size, block = len(block), filled(block) if measured else block
    true = {t.other: block[:, t.other].copy() for t in measured if t.law.crosses}
    for term in measured:
        own = (slice(None), slice(None) if term.joint is None else term.joint)
        seen = block[own]
        if term.law.crosses:
            seen = np.stack([seen, true[term.other]], axis=1)
        block[own] = term.law.report(term.values, seen, 1.0 / motion.rate)
    return block[:size]


def report_own(terms: tuple[Term, ...], motion: Motion, own: np.ndarray, joint: int) -> np.ndarray:
    """Columns (T, k) that act on one joint as its drive and the clock report them."""
    if mixed(terms):
        return report(terms, motion, placed(own, joint, motion.q.shape[1]))[:, joint]
    measured = on_joint(terms, joint)
    size, own = len(own), filled(own) if measured else own
    for term in measured:
        own = np.asarray(term.law.report(term.values, own, 1.0 / motion.rate))
    return own[:size]


def mixed(terms: tuple[Term, ...]) -> bool:
    """Whether what is written down may mix joints: then no term stays with its own."""
    return any(
        t.law.crosses or (t.joint is None and not t.law.alike)
        for t in of_kind(terms, MeasurementLaw)
    )


def in_order(terms: tuple[Term, ...]) -> list:
    """What a torque is written down by, the drives before their clock."""
    return sorted(of_kind(terms, MeasurementLaw), key=lambda t: t.law.turn)


def on_joint(terms: tuple[Term, ...], joint: int) -> list:
    """What the torque of a joint is written down by, where joints are not mixed."""
    return [t for t in in_order(terms) if t.joint in (None, joint)]


def lateness(terms: tuple[Term, ...]) -> float:
    """Time [s] by which the terms say the clock of the torque lags."""
    measured = of_kind(terms, MeasurementLaw)
    return sum(t.law.lateness({**t.law.neutral(), **t.values}) for t in measured)


def clock_lag(terms: Sequence[Term]) -> float:
    """Time [s] by which the torque's own clock lags: what happens at t stands in it that much later."""
    return lateness(tuple(t for t in of_kind(terms, MeasurementLaw) if t.law.clock))
