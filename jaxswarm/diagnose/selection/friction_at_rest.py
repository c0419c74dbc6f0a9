"""What a model leaves where friction may hold joints, beside its friction and the noise."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import NEAR, STICKS
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import model_torque


def with_all_held(
    search: Search,
    asked: set[int],
    without: Callable[[set[int]], Estimate],
    is_held: Callable[[Estimate, Estimate], np.ndarray],
) -> Estimate | None:
    """The fit without, or with less of, the rest of the most joints that friction holds all; None if of none.

    Args:
        search: The selection; such joints are kept in it.
        asked: Joints that it may be so for.
        without: The fit in which the rest of some joints is left out, or counts less.
        is_held: Whether friction may hold each joint, (n,), by the current fit and such a one.
    """
    while asked:
        after = without(asked)
        held = asked & set(np.flatnonzero(is_held(search.current, after)))
        if held == asked:
            search.sticking |= held
            return after
        asked = held
    return None


def left_and_friction(found: Estimate) -> tuple[np.ndarray, np.ndarray]:
    """What a model leaves on all rows of all logs, and the torque of its laws of the direction, (T, n) each."""
    model = found.model
    others = tuple(t for t in model.terms if not t.law.uses_direction)
    parts = []
    for motion in found.motions:
        whole, rest = (model_torque(m, motion) for m in (model, replace(model, terms=others)))
        assert motion.tau is not None  # it was fitted
        parts.append([motion.decimator.apply(x) for x in (motion.tau - whole, whole - rest)])
    left, friction = (np.concatenate(own) for own in zip(*parts, strict=True))
    return left, friction


def much_nearer(before: Estimate, after: Estimate) -> np.ndarray:
    """Whether a fit to other rows leaves a joint near its noise, and a small part of what was left, (n,)."""
    one, two = over_noise(before), over_noise(after)
    return (two <= NEAR) & (two**2 < STICKS * one**2)


def rms_in(left: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """RMS (n,) of what is left (T, n) in some rows of every joint."""
    return np.sqrt(np.where(rows, left**2, 0.0).sum(axis=0) / np.maximum(rows.sum(axis=0), 1))


def within_friction(left: np.ndarray, friction: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Whether what is left (T, n) in some rows of every joint is no more than its friction (T, n), (n,)."""
    return rms_in(left, rows) <= np.abs(friction).max(axis=0)


def left_out(before: Estimate, after: Estimate) -> np.ndarray:
    """Rows (T, n) that a fit uses no more."""
    return before.regression.used_rows & ~after.regression.used_rows


def rest_exceeds(
    left: np.ndarray, before: Estimate, after: Estimate, times: float = 1.0
) -> np.ndarray:
    """Whether more than so many times as much is left (T, n) in rows no more used as in others, (n,)."""
    rest = rms_in(left, left_out(before, after))
    return rest > times * rms_in(left, after.regression.used_rows)
