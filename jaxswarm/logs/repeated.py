"""The same recording under two names: a copy in another format or with fewer digits, or a part of it."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.log import Log

# Stretches of a log that are looked for in another one, and their length in samples: torques of two runs of one
# motion differ by noise of a hundredth of their size and never agree to a thousandth ten times in a row.
_STRETCHES, _LENGTH, _ALIKE = 200, 10, 1e-3
# A stretch counts in which a joint moves by this part of its standard deviation: at rest all logs look alike.
_MOVES = 1e-2
# Share of the stretches from which on a part of a log is told to be in the other one, and of a copy.
_PART, _COPY = 0.1, 0.9


def refuse_repeated_stretches(log: Log, earlier: Sequence[Log]) -> None:
    """Refuse a log of which a part stands in another one: standard errors would shrink by what is no evidence.

    Raises:
        InputError: Naming both logs.
    """
    for other in earlier:
        share = max(_share(log, other), _share(other, log))  # either may be a part of the other one
        if share >= _PART:
            much = "all" if share >= _COPY else f"{100 * share:.0f} %"
            raise InputError(
                f"{log.source}: of it and {other.source} one holds {much} of the other, sample for sample; the "
                "same motion twice is no second proof, name every recording once and score on another one"
            )


def _share(log: Log, other: Log) -> float:
    """Share of the moving stretches of a log that stand in another one."""
    if log.tau is None or other.tau is None or log.q.shape[1] != other.q.shape[1]:
        return 0.0
    rows, known = (np.concatenate([one.tau, one.q], axis=1) for one in (log, other))
    if min(len(rows), len(known)) < 2 * _LENGTH:
        return 0.0
    spread = rows.std(axis=0)
    near = _ALIKE * np.maximum(spread, 1e-300)
    starts = np.unique(np.linspace(0, len(rows) - _LENGTH, _STRETCHES).astype(int))
    moved = [np.ptp(log.q[s : s + _LENGTH], axis=0) for s in starts]
    starts = starts[(np.array(moved) > _MOVES * spread[log.tau.shape[1] :]).any(axis=1)]
    last = len(known) - _LENGTH
    order = np.argsort(known[: last + 1, 0], kind="stable")
    sorted_ = known[order, 0]
    found = 0
    for start in starts:
        own = rows[start : start + _LENGTH]
        low, high = np.searchsorted(sorted_, [own[0, 0] - near[0], own[0, 0] + near[0]])
        places = order[low:high]
        for k in range(_LENGTH):
            places = places[(np.abs(known[places + k] - own[k]) <= near).all(axis=1)]
        found += len(places) > 0
    return found / len(starts) if len(starts) else 0.0
