"""Joints that stand, held by dry friction at a torque that no law tells.

A joint at rest is held by any torque up to its breakaway level, and its drive leaves it at whichever it had. On
measured strain-wave gears that is nine tenths of the error of point-to-point motion. On a measured robot of
300 kg the first second, in which every joint still stood, was told as a push of 1000 N m, and the error of
other motion rose from 450 to 740 N m. Where the smooth sign of a model does tell the torque at rest, as in many
simulations, rest says as much as motion and stays.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import scipy

from jaxswarm.identify.forward.metrics import moves_at
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.runs import runs

# A joint stands where it does not move for so long [s]: at a reversal it does not move either.
_REST = 0.25
# It is held where half of what is left at rest is beyond this multiple of the RMS that is left in motion. On 28
# practice logs and their tests, none of which holds a joint so, that is 0.7 on most joints, and at most 2.26,
# where a law is missing that shows at rest, too; on measured robots of two makers 2.6 to 5.7.
_HELD = 2.5
# Where no more than this part of the rows in which a joint hardly moves is fitted, its sign has no width to
# fit: logs are moved by parts of a sample after rows were left out.
_UNTOLD = 0.02
# A joint that moves in fewer rows than this share of all says nothing of its motion.
_MOVES = 0.1


def standing(motions: Sequence[Motion]) -> list[np.ndarray]:
    """Whether each joint stands on the decimated rows of every log, (T', n) each."""
    top = np.max([np.abs(m.dq).max(axis=0) for m in motions], axis=0)
    return [_at_rest(m, top) for m in motions]


def hardly_moving(motions: Sequence[Motion]) -> list[np.ndarray]:
    """The same where it is for a moment only, as where it starts, stops, sticks or reverses."""
    top = np.max([np.abs(m.dq).max(axis=0) for m in motions], axis=0)
    return [_at_rest(m, top, 0.0) for m in motions]


def tells_sign(motions: Sequence[Motion]) -> np.ndarray:
    """Whether some of the rows in which a joint hardly moves are fitted, (n,): they tell its sign's width."""
    left = []
    for motion, rows in zip(motions, hardly_moving(motions), strict=True):
        left.append(rows if motion.held is None else rows & ~motion.held)
    here, asked = (np.concatenate(x).mean(axis=0) for x in (left, hardly_moving(motions)))
    return here > _UNTOLD * asked


def _at_rest(motion: Motion, top: np.ndarray, least: float = _REST) -> np.ndarray:
    kept = motion.decimator.kept(len(motion.t))
    still = ~moves_at(motion.dq, top)
    long = max(1, round(least * motion.rate))
    rest = np.zeros_like(still)
    for joint, flags in enumerate(still.T):
        for begin, end in zip(*runs(flags), strict=True):
            rest[begin:end, joint] = end - begin >= long
    return rest[kept]


def held(left: Sequence[np.ndarray], rest: Sequence[np.ndarray]) -> np.ndarray:
    """Whether what a model leaves at rest is dry friction's and not the model's, (n,).

    Args:
        left: What the model leaves on the rows of every log, (T', n) each.
        rest: Whether each joint stands there.

    >>> still = np.array([[True]] * 4 + [[False]] * 4)
    >>> held([np.array([[9.0], [-7.0], [8.0], [6.0], [0.1], [-0.1], [0.2], [0.1]])], [still]).tolist()
    [True]
    >>> held([np.array([[0.3], [-0.1], [0.0], [0.2], [0.1], [-0.1], [0.2], [0.1]])], [still]).tolist()
    [False]
    """
    error, still = np.concatenate(left), np.concatenate(rest)
    told = []
    for e, s in zip(error.T, still.T, strict=True):
        known = s.any() and (~s).mean() >= _MOVES
        told.append(known and np.median(np.abs(e[s])) > _HELD * np.sqrt(np.mean(e[~s] ** 2)))
    return np.array(told, dtype=bool)


def leave_out(
    motions: Sequence[Motion], rest: Sequence[np.ndarray], joints: np.ndarray
) -> list[Motion]:
    """The logs with the rest of some joints (n,) left out of the fit, and what the low-pass mixes with it.

    What is left out already stays so.
    """
    return [
        replace(m, held=_seen(m, r & joints) | (False if m.held is None else m.held))
        for m, r in zip(motions, rest, strict=True)
    ]


def _seen(motion: Motion, rows: np.ndarray) -> np.ndarray:
    """The decimated rows (T', n) of which the main lobe of the low-pass reaches into some of them."""
    step = motion.decimator.factor / motion.rate
    reach = int(np.ceil(0.5 / (motion.torque_cutoff * step)))
    return scipy.ndimage.maximum_filter1d(rows, 2 * reach + 1, axis=0, mode="constant")


def held_shares(motions: Sequence[Motion]) -> dict[str, float]:
    """Joints that friction holds at rest in some logs, with the share of these."""
    rows = [m.held for m in motions if m.held is not None]
    if not rows:
        return {}
    share = np.concatenate(rows).mean(axis=0)
    return {name: float(x) for name, x in zip(motions[0].joints, share, strict=True) if x > 0.0}


def held_lines(shares: Mapping[str, float]) -> list[str]:
    """What a reader has to know of joints that friction holds at rest, if there are any."""
    if not shares:
        return []
    told = ", ".join(f"{name} ({100 * x:.0f} % of the time)" for name, x in shares.items())
    return [
        f"At rest or nearly so dry friction holds {told} at torques that no law tells: that is not fitted. It "
        "counts in the errors of other logs."
    ]
