"""Joints that stand, held by dry friction at a torque that no law tells.

A joint at rest is held by any torque up to its breakaway level, and its drive leaves it at whichever it had. On
measured strain-wave gears that is nine tenths of the error of point-to-point motion. On a measured robot of
300 kg the first second, in which every joint still stood, was told as a push of 1000 N m, and the error of
other motion rose from 450 to 740 N m. Where the smooth sign of a model does tell the torque at rest, as in many
simulations, rest says as much as motion and stays.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import scipy

from jaxswarm.identify.forward.metrics import moves_at
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.runs import runs

# A joint stands where it does not move for so long [s]: at a reversal it does not move either.
_REST = 0.25
# It is held where half of what is left at rest, by time or by rests, is beyond this multiple of the RMS that is
# left in motion. On 28 practice logs and their tests, none of which holds a joint so, that is 0.7 on most
# joints, and at most 2.34 (1.9 by rests), where a law is missing that shows at rest, too; on measured robots of
# two makers 2.6 to 5.7. Rests count beside time: an arm of 300 kg is held at 960 N m before its first move and
# for longer at 20 N m after its last one.
HELD = 2.5
# Where no more than this part of the rows in which a joint hardly moves is fitted, its sign has no width to
# fit: logs are moved by parts of a sample after rows were left out.
_UNTOLD = 0.02
# Part of its top speed below which a joint is not too fast to tell its sign's width. A slide that slowed down
# to 0.03 of it and went on, where a width of 0.05 is true, was left with 27 times its noise by one of 0.007.
_NEAR_REST = 0.05
# A joint that moves in fewer rows than this share of all, and in fewer than so many, tells nothing of motion.
# Decimated rows are nearly independent (0.7 to 0.8 of one each), so that 50 tell an RMS to a tenth. Joints of
# five to seven that move one by one do so in 7 to 24 % of the rows, 60 to 2400 of them.
_SHARE, _ROWS = 0.1, 50


def standing(motions: Sequence[Motion]) -> list[np.ndarray]:
    """Whether each joint stands on the decimated rows of every log, (T', n) each."""
    return _decimated(motions, map(_for_long, motions, _still(motions)))


def hardly_moving(motions: Sequence[Motion]) -> list[np.ndarray]:
    """The same where it is for a moment only, as where it starts, stops, sticks or reverses."""
    return _decimated(motions, _still(motions))


def tells_sign(motions: Sequence[Motion]) -> np.ndarray:
    """Whether some of the rows in which a joint hardly moves are fitted, (n,): they tell its sign's width."""
    slow = hardly_moving(motions)
    fitted = [
        rows if m.held is None else rows & ~m.held for m, rows in zip(motions, slow, strict=True)
    ]
    here, asked = (np.concatenate(x).mean(axis=0) for x in (fitted, slow))
    return here > _UNTOLD * asked


def never_slow(motions: Sequence[Motion]) -> np.ndarray:
    """Whether a joint moves in no row slowly enough to tell its sign's width, (n,): it races through zero."""
    return ~np.any([rows.any(axis=0) for rows in hardly_moving(motions)], axis=0)


def comes_near_rest(motions: Sequence[Motion]) -> np.ndarray:
    """Whether a joint comes near being that slow, (n,): its sign is not whole there and shows its width."""
    speeds = _decimated(motions, (np.abs(m.dq) for m in motions))
    return np.min([x.min(axis=0) for x in speeds], axis=0) < _NEAR_REST * _top_speed(motions)


def tells_motion(rows: np.ndarray) -> np.ndarray:
    """Whether rows in which joints move, (T,) or (T, n), are enough to tell what is left in motion."""
    return (rows.mean(axis=0) >= _SHARE) | (rows.sum(axis=0) >= _ROWS)


def _still(motions: Sequence[Motion]) -> list[np.ndarray]:
    """Whether each joint hardly moves on the samples of every log, (T, n) each, by its top speed in all."""
    top = _top_speed(motions)
    return [~moves_at(m.dq, top) for m in motions]


def _top_speed(motions: Sequence[Motion]) -> np.ndarray:
    """Top speed of every joint in all logs, (n,)."""
    return np.max([np.abs(m.dq).max(axis=0) for m in motions], axis=0)


def _for_long(motion: Motion, still: np.ndarray) -> np.ndarray:
    """The samples (T, n) in which a joint hardly moves for so long that it stands."""
    long = max(1, round(_REST * motion.rate))
    rest = np.zeros_like(still)
    for joint, flags in enumerate(still.T):
        for begin, end in zip(*runs(flags), strict=True):
            rest[begin:end, joint] = end - begin >= long
    return rest


def _decimated(motions: Sequence[Motion], flags: Iterable[np.ndarray]) -> list[np.ndarray]:
    """The decimated rows of what is told of every log's samples."""
    return [f[m.decimator.kept(len(m.t))] for m, f in zip(motions, flags, strict=True)]


def held(left: np.ndarray, rest: Sequence[np.ndarray], mixed: Sequence[np.ndarray]) -> np.ndarray:
    """Whether what a model leaves at rest is dry friction's and not the model's, (n,).

    Args:
        left: What the model leaves on the rows of all logs, (T, n).
        rest: Whether each joint stands on the rows of every log, (T', n) each.
        mixed: The rest with what the low-pass mixes with it, which counts on neither side: the torque that
            holds a joint, on either side of every stop, hid itself.

    >>> still, seen = np.array([[True]] * 4 + [[False]] * 5), np.array([[True]] * 5 + [[False]] * 4)
    >>> stuck = np.array([[9.0], [-7.0], [8.0], [6.0], [9.0], [0.1], [-0.1], [0.2], [0.1]])
    >>> held(stuck, [still], [seen]).tolist()
    [True]
    >>> held(np.where(still, 0.3, stuck), [still], [seen]).tolist()
    [False]
    """
    still, moves = np.concatenate(rest), ~np.concatenate(mixed)
    spans = [_spans(joint, rest) for joint in range(left.shape[1])]
    told = []
    for e, s, m, own in zip(left.T, still.T, moves.T, spans, strict=True):
        known = s.any() and tells_motion(m)
        told.append(known and _half(e, s, own) > HELD * np.sqrt(np.mean(e[m] ** 2)))
    return np.array(told, dtype=bool)


def _spans(joint: int, rest: Sequence[np.ndarray]) -> list[slice]:
    """Every rest of a joint, as rows of all logs."""
    begins = np.cumsum([0, *map(len, rest)])
    return [
        slice(begin + a, begin + b)
        for begin, rows in zip(begins, rest, strict=False)
        for a, b in zip(*runs(rows[:, joint]), strict=True)
    ]


def _half(left: np.ndarray, still: np.ndarray, spans: Sequence[slice]) -> float:
    """The size that half of what is left (T,) at rest reaches, by time or by rests: the larger one."""
    by_rest = np.median([abs(np.median(left[s])) for s in spans])
    return max(float(np.median(np.abs(left[still]))), float(by_rest))


def leave_out(
    motions: Sequence[Motion], rest: Sequence[np.ndarray], joints: np.ndarray
) -> list[Motion]:
    """The logs with the rest of some joints (n,) left out of the fit, and what the low-pass mixes with it.

    What is left out already stays so.
    """
    seen = mixed_with(motions, [r & joints for r in rest])
    return [
        replace(m, held=s | (False if m.held is None else m.held))
        for m, s in zip(motions, seen, strict=True)
    ]


def mixed_with(motions: Sequence[Motion], rest: Sequence[np.ndarray]) -> list[np.ndarray]:
    """The rest of joints with what the low-pass mixes with it, (T', n) each."""
    return [_seen(m, r) for m, r in zip(motions, rest, strict=True)]


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
    return shares_of(motions[0].joints, np.concatenate(rows))


def held_lines(shares: Mapping[str, float]) -> list[str]:
    """What a reader has to know of joints that friction holds at rest, if there are any."""
    if not shares:
        return []
    return [f"{holds(shares)}: that is not fitted. It counts in the errors of other logs."]


def shares_of(joints: Sequence[str], rows: np.ndarray) -> dict[str, float]:
    """Joints of which some rows (T, n) are told, with the share of these."""
    share = rows.mean(axis=0)
    return {name: float(x) for name, x in zip(joints, share, strict=True) if x > 0.0}


def holds(shares: Mapping[str, float]) -> str:
    """In words, which joints friction holds, and in which shares of the time."""
    told = ", ".join(f"{name} ({100 * x:.0f} % of the time)" for name, x in shares.items())
    return f"At rest or nearly so dry friction holds {told} at torques that no law tells"
