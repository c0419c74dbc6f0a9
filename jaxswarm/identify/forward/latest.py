"""Arrays that are asked for again and again, kept while there is room for them."""

from collections.abc import Callable, Hashable
from threading import Lock
from typing import TypeVar

import numpy as np

Kept = TypeVar("Kept")


class Latest:
    """The arrays that were made last, by what they follow from, the oldest first.

    How much they hold is counted as they come and go: thousands of small ones, added up for each new one, took
    187 of the 418 s of a diagnosis.

    Args:
        most: Numbers that they may hold together; the newest one stays, however large.

    >>> latest = Latest(5)
    >>> for place in ("a", "b", "a", "c", "b"):
    ...     _ = latest.of(place, lambda: print("makes", place) or np.zeros(2))
    makes a
    makes b
    makes c
    """

    def __init__(self, most: int):
        self._most, self._numbers = most, 0
        self._held: dict[Hashable, np.ndarray] = {}
        self._keeping = Lock()

    def of(self, place: Hashable, make: Callable[[], np.ndarray]) -> np.ndarray:
        """What is kept of a place, or is made and kept."""
        known = self._held.get(place)
        if known is not None:
            return known
        made = make()
        with self._keeping:
            if place in self._held:  # another thread made it meanwhile
                return self._held[place]
            while self._held and made.size + self._numbers > self._most:
                self._numbers -= self._held.pop(next(iter(self._held))).size
            self._held[place] = made
            self._numbers += made.size
        return made


def last_of(kept: dict, place: Hashable, make: Callable[[], Kept]) -> Kept:
    """What was kept of a place, or is made and kept of it alone."""
    known = kept.get(place)
    if known is None:
        known = make()
        kept.clear()
        kept[place] = known
    return known
