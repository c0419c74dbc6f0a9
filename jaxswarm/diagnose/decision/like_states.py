"""Whether windows of time are where the arm was alike: each is told by the others, as no chance windows are."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

# Rows that are compared with one another at most, and how often windows are placed at random.
_MOST_ROWS, _PLACED = 1000, 99


def told_by_states(states: np.ndarray, window: np.ndarray, seed: int = 0) -> tuple[float, float]:
    """Share of the rows of windows whose nearest state at another time lies in another window, and its chance.

    Windows that have nothing to do with the motion are wherever the arm happened to be, and the nearest of all
    other states lies outside of them. The chance is that of windows as long that are placed at random. Those
    with less between them than the longer one lasts count as one: what changes in strength is told in parts.

    Args:
        states: What is asked of the motion, such as position and velocity of a joint, (T, m).
        window: Number of the window of every row, (T,), from 0; -1: in none.
        seed: Of the places.

    Returns:
        The share, and the part of the placed windows that have as much (at least 1 of 100).

    >>> t = np.linspace(0.0, 20.0, 800)
    >>> states = np.stack([np.sin(2.2 * t), np.cos(2.2 * t)], axis=1)
    >>> begins = np.diff((states[:, 0] > 0.9).astype(int), prepend=0) == 1
    >>> ends = np.where(states[:, 0] > 0.9, begins.cumsum() - 1, -1)
    >>> told_by_states(states, ends)
    (1.0, 0.01)
    >>> told_by_states(states, np.where((t > 5.0) & (t < 6.0), 0, np.where(t > 18.7, 1, -1)))[0] < 0.5
    True
    """
    thin = slice(None, None, -(-len(states) // _MOST_ROWS))
    states, rows = states[thin] / np.maximum(states.std(axis=0), 1e-300), len(window[thin])
    spans = _spans(window[thin])
    lengths = [last - first for first, last in spans]
    share = _share(states, spans)
    rng, as_much = np.random.default_rng(seed), 0
    for _ in range(_PLACED):
        first = [int(rng.integers(rows - length + 1)) for length in lengths]
        placed = [(a, a + length) for a, length in zip(first, lengths, strict=True)]
        as_much += int(_share(states, placed) >= share)
    return share, (1.0 + as_much) / (1.0 + _PLACED)


def _spans(window: np.ndarray) -> list[tuple[int, int]]:
    """First row and the one after the last of every window, those that are near as one.

    >>> _spans(np.array([-1, 0, 0, -1, 1, 1, -1, -1, -1, 2]))
    [(1, 6), (9, 10)]
    """
    rows = (np.flatnonzero(window == one) for one in np.unique(window[window >= 0]))
    pieces = sorted((int(own[0]), int(own[-1]) + 1) for own in rows)
    spans = pieces[:1]
    for (begin, end), (first, last) in pairwise(pieces):
        if first - end < max(last - first, end - begin):
            spans[-1] = spans[-1][0], last
        else:
            spans.append((first, last))
    return spans


def _share(states: np.ndarray, spans: Sequence[tuple[int, int]]) -> float:
    """The share, of states (T, m) in units of their spread."""
    within = np.zeros(len(states), bool)
    for first, last in spans:
        within[first:last] = True
    alike = rows = 0
    for first, last in spans:
        apart = ((states[first:last, None] - states) ** 2).sum(axis=2)
        apart[:, first:last] = np.inf
        alike += int(within[apart.argmin(axis=1)].sum())
        rows += last - first
    return alike / max(rows, 1)
