"""Candidates shared out among the workers of a pool, those that run for too long given up."""

import concurrent.futures
import time
from collections.abc import Callable
from typing import Any

__all__ = ["shared_out", "tried"]

LOOK = 0.02
"""Seconds between two looks at which candidates are running: a time limit is kept to within this."""


def tried(fn: Callable[[Any], Any], params: Any, forgive: tuple, lost: Any) -> Any:
    """What the objective says of a candidate, ``lost`` where an exception is forgiven."""
    try:
        return fn(params)
    except forgive:
        return lost


def shared_out(
    fn: Callable[[Any], Any],
    candidates: list,
    pool: concurrent.futures.Executor,
    timeout: float | None,
    forgive: tuple,
    lost: Any,
) -> tuple[list, int]:
    """Values in order, ``lost`` where a candidate was given up, and how many these are."""
    futures = [pool.submit(tried, fn, params, forgive, lost) for params in candidates]
    try:
        late = _waited(futures, timeout)
        values = [lost if one in late else one.result() for one in futures]
    finally:
        for one in futures:
            one.cancel()
    return values, len(late)


def _waited(futures, timeout):
    """Wait for all; the set of those that ran, or waited while nothing moved, for too long."""
    if timeout is None:
        concurrent.futures.wait(futures, return_when=concurrent.futures.FIRST_EXCEPTION)
        return set()
    waiting, late, began = set(futures), set(), {}
    moved = time.monotonic()
    while waiting:
        done, waiting = concurrent.futures.wait(waiting, timeout=LOOK)
        now = time.monotonic()
        started = {one for one in waiting if one.running()} - began.keys()
        began |= dict.fromkeys(started, now)
        moved = now if done or started else moved
        # Where all workers are held by what was given up, what queues behind them moves no more.
        stuck = now - moved >= timeout
        over = {one for one in waiting if now - began.get(one, now) >= timeout or stuck}
        late |= over
        waiting -= over
    return late
