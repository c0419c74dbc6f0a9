"""How drives and their clock write down torques: each drive its own, then the clock all of them."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.identify.forward.own_columns import placed
from jaxswarm.logs.motion import Motion


def report(terms: tuple[Term, ...], motion: Motion, block: np.ndarray) -> np.ndarray:
    """Torques (T, n, ...) as they are written down: by the drive of each joint, then by their clock."""
    measured = in_order(terms)
    size, block = len(block), filled(block) if measured else block
    for term in measured:
        own = (slice(None), slice(None) if term.joint is None else term.joint)
        block[own] = term.law.report(term.values, block[own], 1.0 / motion.rate)
    return block[:size]


def report_own(terms: tuple[Term, ...], motion: Motion, own: np.ndarray, joint: int) -> np.ndarray:
    """Columns (T, k) that act on one joint as its drive and the clock report them."""
    if mixed(terms):
        return report(terms, motion, placed(own, joint, motion.q.shape[1]))[:, joint]
    measured = [t for t in in_order(terms) if t.joint in (None, joint)]
    size, own = len(own), filled(own) if measured else own
    for term in measured:
        own = np.asarray(term.law.report(term.values, own, 1.0 / motion.rate))
    return own[:size]


def mixed(terms: tuple[Term, ...]) -> bool:
    """Whether what is written down of the whole arm may mix its joints: then no term stays with its own."""
    return any(t.joint is None and not t.law.alike for t in of_kind(terms, MeasurementLaw))


def in_order(terms: tuple[Term, ...]) -> list:
    """What a torque is written down by, the drives before their clock."""
    return sorted(of_kind(terms, MeasurementLaw), key=lambda t: t.joint is None)


def lateness(terms: tuple[Term, ...]) -> float:
    """Time [s] by which the terms say the clock of the torque lags."""
    measured = of_kind(terms, MeasurementLaw)
    return sum(t.law.lateness({**t.law.neutral(), **t.values}) for t in measured)


def clock_lag(terms: Sequence[Term]) -> float:
    """Time [s] by which the torque's own clock lags: what happens at t stands in it that much later."""
    return lateness(tuple(t for t in of_kind(terms, MeasurementLaw) if t.law.clock))
