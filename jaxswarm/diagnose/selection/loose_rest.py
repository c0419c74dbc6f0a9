r"""Rest that friction holds, but that motion alone does not tell: it counts by what friction may do there.

Of an arm whose joints move one by one, or hardly beside their rest, rest tells what motion does not: how heavy
the links are where they stand. Left out, a model is off on other motion by thousands of times the noise; fitted
as if no friction held the joint, a clean arm was left with 3.1 times its noise, and "unexplained".

Dry friction holds a joint at any torque within its own, evenly as far as anybody knows, and at the same one for
as long as it stands. So the mean of a rest has the variance

.. math:: 1 / \sum_t \sigma_t^{-2} + f^2 / 3

with the noise sigma of its rows and the friction f, and each of its rows counts by the root of what that makes
of it: weighted least squares with known variances (A. C. Aitken, Proc. R. Soc. Edinburgh 55 (1936)).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import NEAR
from jaxswarm.diagnose.folds.noise import row_noise
from jaxswarm.diagnose.selection.friction_at_rest import (
    left_and_friction,
    much_nearer,
    with_all_held,
    within_friction,
)
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.standing import hardly_moving, holds, mixed_with, shares_of
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.runs import runs


def with_loose_rest(
    search: Search, asked: set[int], fitted: Callable[[Sequence[Motion]], Estimate]
) -> Estimate | None:
    """The fit in which rest of some of these joints counts by their friction; None if friction holds none.

    It does where motion is left near its noise then, with a small part of what was left, and rest with no more
    than the friction of its joint, and no other joint lacks anything: beside a spring that was missing three
    joints were so for a while, and their errors and a fourth one's on other motion rose up to four times.

    Args:
        search: The selection; such joints are kept in it.
        asked: Joints that it may be so for.
        fitted: Fits the model to logs, with their noise.
    """
    current = search.current
    rests = mixed_with(current.motions, hardly_moving(current.motions))
    friction = np.abs(left_and_friction(current)[1]).max(axis=0)
    noise = np.split(row_noise(current), np.cumsum([len(r) for r in rests])[:-1])

    def without(joints: set[int]) -> Estimate:
        loose = np.isin(np.arange(len(friction)), list(joints))
        return fitted(loosened(current.motions, rests, loose, noise, friction))

    return with_all_held(search, asked, without, _is_held)


def _is_held(before: Estimate, after: Estimate) -> np.ndarray:
    """Whether friction may be what holds each joint, (n,), in rows that count less in the fit after.

    None, where another joint is left far from its noise.
    """
    left, friction = left_and_friction(after)
    rest = after.regression.shares < before.regression.shares
    if (over_noise(after)[~rest.any(axis=0)] > NEAR).any():
        return np.zeros(rest.shape[1], bool)
    return much_nearer(before, after) & within_friction(left, friction, rest)


def loosened(
    motions: Sequence[Motion],
    rests: Sequence[np.ndarray],
    joints: np.ndarray,
    noise: Sequence[np.ndarray],
    friction: np.ndarray,
) -> list[Motion]:
    """The logs with the rest of some joints counted by the friction that may hold them there.

    Args:
        motions: The logs.
        rests: Rows in which each joint hardly moves, (T', n) each.
        joints: Which joints, (n,).
        noise: Standard deviation of every row's noise, (T', n) each.
        friction: Dry friction, (n,).
    """
    every = [_shares(rows & joints, own, friction) for rows, own in zip(rests, noise, strict=True)]
    return [
        replace(m, loose=share if m.loose is None else m.loose * share)
        for m, share in zip(motions, every, strict=True)
    ]


def _shares(rows: np.ndarray, noise: np.ndarray, friction: np.ndarray) -> np.ndarray:
    """How much every row counts, (T', n): all of it where a joint moves.

    >>> rows = np.array([[True], [True], [False]])
    >>> _shares(rows, np.array([[1.0], [1.0], [9.0]]), np.array([3.0])).round(3).ravel().tolist()
    [0.378, 0.378, 1.0]
    """
    share = np.ones(rows.shape)
    for own, rest, sigma, most in zip(share.T, rows.T, noise.T, friction, strict=True):
        for begin, end in zip(*runs(rest), strict=True):
            told = (sigma[begin:end] ** -2).sum()
            own[begin:end] = (1.0 + told * most**2 / 3.0) ** -0.5
    return share


def loose_lines(motions: Sequence[Motion]) -> list[str]:
    """What a reader has to know of joints whose rest counts by their friction, if there are any."""
    rows = [m.loose for m in motions if m.loose is not None]
    if not rows:
        return []
    held = holds(shares_of(motions[0].joints, np.concatenate(rows) < 1.0))
    return [
        f"{held}, and motion does not tell what the model does there: rest counts by as much as that friction "
        "leaves of it."
    ]
