"""The processor's cores: how many there are, and work of one process shared out over them.

Where an error or a signal ends the work, nobody waits for what the other threads are at.
"""

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import copy_context
from typing import TypeVar

Given = TypeVar("Given")
Found = TypeVar("Found")


def count() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def each(function: Callable[[Given], Found], items: Iterable[Given]) -> list[Found]:
    """What a function gives for each of some items, in their order, by as many threads as there are cores.

    For functions that spend their time in operations on whole arrays, which let other threads run meanwhile;
    thousands of small ones would wait for each other. What one of them raises ends them all.

    >>> each(abs, [-1, 2, -3])
    [1, 2, 3]
    """
    given = list(items)
    threads = min(count(), len(given))
    if threads < 2:
        return [function(one) for one in given]
    pool = ThreadPoolExecutor(threads)
    try:
        begun = [pool.submit(copy_context().run, function, one) for one in given]
        return [one.result() for one in begun]
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


@contextmanager
def beside(function: Callable[[], Found]) -> Iterator[Callable[[], Found]]:
    """What a function gives, found by another thread meanwhile; on a single core when it is asked for.

    >>> with beside(lambda: 1 + 1) as found:
    ...     found()
    2
    """
    if count() < 2:
        yield function
        return
    pool = ThreadPoolExecutor(1)
    try:
        yield pool.submit(copy_context().run, function).result
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


@contextmanager
def beside_each(
    function: Callable[[Given], Found], items: Iterable[Given]
) -> Iterator[Callable[[], list[Found]]]:
    """What a function gives for each of some items, in their order, found by another thread meanwhile.

    What that one has not begun when they are asked for is found here, from the last one on: of much to do for
    one thread and little for the other, neither waits.

    >>> with beside_each(abs, [-1, 2, -3]) as found:
    ...     found()
    [1, 2, 3]
    """
    given = list(items)
    if count() < 2 or not given:
        yield lambda: [function(one) for one in given]
        return
    pool = ThreadPoolExecutor(1)
    begun = [pool.submit(copy_context().run, function, one) for one in given]

    def found() -> list[Found]:
        here = {k: function(given[k]) for k in reversed(range(len(given))) if begun[k].cancel()}
        return [here[k] if k in here else one.result() for k, one in enumerate(begun)]

    try:
        yield found
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
