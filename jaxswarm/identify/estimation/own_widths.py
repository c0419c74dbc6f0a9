"""Which joints' signs have widths of their own, and what the others' widths say of the rest."""

from collections.abc import Mapping, Sequence

import numpy as np

# Widths of one kind of joint differ where one is apart from what they share by so many standard errors: on
# clean practice logs of equal widths the largest ratio was 4.3 (q02, joint 7), on nine worlds whose widths
# differ the largest of each log was 8 to 40. Standard errors of widths are too small by this factor, since
# what is wrong with them is the motion near zero velocity: the same logs. A sign twice as sharp or as wide is
# believed at three: beside another joint's missing law a width four times too large had no more, and
# two Stribeck laws of three times the dry friction were put on top of it.
_CLEARLY, _DOUBTED = 6.0, 2.0
_FAR, _FAR_CLEARLY = np.log(2.0), 3.0


def apart(x: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Which joints of a kind have widths of their own, from the logarithms (m,) of theirs over the shared one.

    None, unless one is clearly apart. Then widths do differ, by a spread that is found by moments
    (R. DerSimonian, N. Laird, Controlled Clinical Trials 7 (1986)), and all those are freed that are known
    better than that.

    Args:
        x: Logarithms, (m,).
        error: Their standard errors, (m,).

    >>> apart(np.array([0.0, 0.1, 2.0]), np.array([0.05, 0.6, 0.1])).tolist()
    [0, 1, 2]
    """
    clear = (np.abs(x) > _CLEARLY * error) | (
        (np.abs(x) > _FAR) & (np.abs(x) > _FAR_CLEARLY * error)
    )
    if not clear.any():
        return np.zeros(0, dtype=int)
    weight = 1.0 / (_DOUBTED * error) ** 2
    excess = (weight * (x - np.average(x, weights=weight)) ** 2).sum() - (len(x) - 1)
    spread = np.sqrt(max(excess, 0.0) / (weight.sum() - (weight**2).sum() / weight.sum()))
    return np.flatnonzero((_DOUBTED * error < spread) | clear)


def told_by_the_others(
    groups: Sequence[tuple[int, ...]],
    split: Sequence[tuple[int, ...]],
    width: tuple[float, ...],
    error: Mapping[int, float],
) -> tuple[float, ...]:
    """Widths (n,) where those that a log hardly tells lean on the mean of those that it tells.

    Where widths differ, what is left of a group is fitted to little else than the motion near zero velocity,
    which is known worst. With m and s the mean and the spread of the logarithms of the freed widths, one of
    logarithm y and doubt v comes to :math:`m + s^2 / (s^2 + v^2) (y - m)` (W. James, C. Stein 1961).

    Args:
        groups: Joints of a kind.
        split: The same without the freed ones, and these alone.
        width: As fitted, (n,).
        error: Standard error of the logarithm of a joint's own width.

    >>> told = told_by_the_others([(0, 1, 2)], [(2,), (0,), (1,)], (0.01, 0.02, 0.001), {2: 100.0})
    >>> [round(w, 5) for w in told]
    [0.01, 0.02, 0.01414]
    """
    told = list(width)
    for group in groups:
        rest = next((g for g in split if g and set(g) < set(group) and len(split) > 1), ())
        freed = [j for j in group if j not in rest]
        if len(freed) < 2 or not any(j in error for j in rest):
            continue
        known = np.log([width[j] for j in freed])
        spread = max(known.std(ddof=1), 1e-9)
        # What a log does not tell at all has no error: it is told by the others alone.
        doubts = [
            _DOUBTED * error[j] if np.isfinite(error[j]) else np.inf for j in rest if j in error
        ]
        part = 1.0 / (1.0 + (np.median(doubts) / spread) ** 2)
        leaning = np.exp(known.mean() + part * (np.log(width[rest[0]]) - known.mean()))
        for j in rest:
            told[j] = float(leaning)
    return tuple(told)
