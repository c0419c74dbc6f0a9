"""Room for compiled programs: they are let go of before the system has no memory maps left for this process.

A compiled program lies in six memory maps or more (:func:`jaxswarm.swarm.minimize` of a new function: 86, a
diagnosis of an arm it has not seen: up to 1000). Linux allows a process 65,530 of them, and the next one ends
it in a segmentation fault; JAX keeps every program it has made. So whoever works through many logs, functions
or shapes makes room between them. Arrays, functions and results stay as they are: what is called again is
compiled again, to the same bytes.
"""

import gc
import time
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import jax

__all__ = ["Room", "count_maps", "holds_programs", "most_maps", "room_for_programs"]

# What Linux tells of a process and of its limit; no other system has such files.
_MAPS, _MOST = Path("/proc/self/maps"), Path("/proc/sys/vm/max_map_count")
# Of the maps that are left to take, those after which programs are let go of. The largest unit of work known, a
# diagnosis that searches formulas, takes 3000 of 65,530.
_SHARE = 0.5
# Time [s] between two looks: to count takes 3 ms for 5000 maps, and a search that is compiled may take less. In
# that time two cores compile programs of some hundred maps.
_PAUSE = 1.0


class Holder(Protocol):
    """Whoever keeps compiled programs beside JAX."""

    def forget(self) -> None:
        """Let go of them."""


_HOLDERS: "weakref.WeakSet[Holder]" = weakref.WeakSet()


def holds_programs(holder: Holder) -> None:
    """Remember one whose programs are let go of with those of JAX."""
    _HOLDERS.add(holder)


def count_maps() -> int | None:
    """Memory maps of this process; None where the system does not tell."""
    try:
        return _MAPS.read_bytes().count(b"\n")
    except OSError:
        return None


def most_maps() -> int | None:
    """Memory maps that a process may have; None where the system does not tell."""
    try:
        return int(_MOST.read_text(encoding="ascii"))
    except (OSError, ValueError):
        return None


class Room:
    """Looks now and then how many maps are taken.

    Args:
        count, most: Give the maps that are taken, and may be; None: unknown, and nothing is done.
        clock: Gives the time [s].

    >>> Room(count=lambda: 500, most=lambda: 65530).make()
    False
    """

    def __init__(
        self,
        count: Callable[[], int | None] = count_maps,
        most: Callable[[], int | None] = most_maps,
        clock: Callable[[], float] = time.monotonic,
    ):
        self._count, self._most, self._clock = count, most, clock
        self._looked = -_PAUSE
        # Maps that were there after programs were let go of: of libraries, files, memory of the user.
        self._others = 0

    def make(self) -> bool:
        """Let go of all compiled programs if they take half of the maps that others leave.

        Returns:
            Whether that was done.
        """
        now = self._clock()
        if now - self._looked < _PAUSE:
            return False
        self._looked = now
        taken = self._count()
        most = None if taken is None else self._most()
        if taken is None or most is None or taken < self._others + _SHARE * (most - self._others):
            return False
        for holder in list(_HOLDERS):
            holder.forget()
        jax.clear_caches()
        gc.collect()  # programs of functions that hold each other
        self._others = self._count() or 0
        return True


room_for_programs = Room().make
"""What every task and search calls before it begins."""
