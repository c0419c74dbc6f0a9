"""Positions between the steps of an encoder: the instants at which it counts tell more than the counts.

While a joint creeps, an encoder shows one count for many samples and then the next. Taken as the position
with white noise, such a step is smoothed into a pulse of velocity that was never there, and through the
steep sign of friction into a pulse of torque. But at the instant of the step the position is known to a
fraction of it: it is the boundary between the two counts (R. J. E. Merry, M. J. G. van de Molengraft,
M. Steinbuch, Mechatronics 20 (2010), optimal higher-order encoder time-stamping). Between two such instants
it is interpolated here; a joint that crosses several counts a sample is left as it is.
"""

import numpy as np

# Samples on one count from which on the instants of the steps tell more than the counts.
_LONG = 4
# Changes may differ from whole counts by this part of one: rounding of a text file. Its step is found on the
# smallest changes first, up to so many counts.
_WHOLE, _GROWING = 0.1, (3, 10, 30, 100, 300, 1000)
# No encoder counts so often between two samples: that step is the rounding of a number, of which others are
# whole multiples whatever they are.
_MOST = 2.0**31


def between_counts(t: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Positions with what the instants of the encoders' steps tell of them, joint by joint.

    Args:
        t: Stamps (T,) [s].
        q: Positions (T, n) [rad or m]; columns that are not multiples of a step are returned as they are.

    >>> t = np.arange(0, 2, 0.01)
    >>> creeping = 0.003 * t[:, None]
    >>> counts = np.round(creeping / 1e-3) * 1e-3
    >>> inner = slice(30, 160)  # from the first to the last step
    >>> bool(np.abs(between_counts(t, counts) - creeping)[inner].max() < 0.1 * 0.5e-3)
    True
    """
    return np.column_stack([_joint(t, column) for column in np.asarray(q, dtype=float).T])


def _joint(t: np.ndarray, q: np.ndarray) -> np.ndarray:
    change = np.diff(q)
    moved = np.flatnonzero(change)
    # A joint that never rests on a count has none to interpolate between.
    if len(moved) < 2 or np.diff(moved).max() < _LONG:
        return q
    step = _step(np.abs(change[moved]))
    if step is None:
        return q
    counts = np.round(change[moved] / step).astype(int)
    out = q.copy()
    for k in np.flatnonzero(np.diff(moved) >= _LONG):
        first, last = moved[k] + 1, moved[k + 1]
        own = t[first : last + 1]
        begin = _edge(t, q, first - 1, first, counts[k], step)
        end = _edge(t, q, last + 1, last, -counts[k + 1], step)
        x = (own - begin[0]) / (end[0] - begin[0])
        out[first : last + 1] = begin[1] + (end[1] - begin[1]) * x
        if begin[1] == end[1] != q[first]:
            # It turned round within the count: by how much nobody saw, by half of it on the average.
            out[first : last + 1] += 4.0 * (q[first] - begin[1]) * x * (1.0 - x)
    return out


def _step(change: np.ndarray) -> float | None:
    """The step that changes (m,) are multiples of, from the smallest on; None: they are of none."""
    step = change.min()
    for most in _GROWING:
        small = change < most * step
        counts = np.round(change[small] / step)
        step = change[small].sum() / counts.sum()
    counts = change / step
    whole = np.abs(counts - np.round(counts)).max() <= _WHOLE and counts.max() < _MOST
    return float(step) if whole else None


def _edge(
    t: np.ndarray, q: np.ndarray, outside: int, inside: int, counts: int, step: float
) -> tuple[float, float]:
    """Time and position at an end of a rest on a count: the boundary it crossed, halfway between samples.

    ``counts`` is by how many counts the position comes in. Where it crossed several within a sample the
    boundary says little, and the count itself is taken.
    """
    if abs(counts) > 1:
        return t[inside], q[inside]
    return 0.5 * (t[outside] + t[inside]), q[inside] - 0.5 * counts * step
