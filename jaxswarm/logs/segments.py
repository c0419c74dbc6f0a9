"""A log as the stretches of motion it really holds: a pause in the record is a boundary, not a motion.

Between the samples on either side of a gap nothing is known; a spline across it would be taken for motion. One
that is short against the motion is bridged for the filters, and left out (:mod:`jaxswarm.logs.bridging`).
Samples whose stamps came in bursts hold no more than their mean at their mean time.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.bridging import CARRIED, bridged_time
from jaxswarm.logs.consistency import drop_contradictions
from jaxswarm.logs.filtering import Decimator
from jaxswarm.logs.log import Log, take
from jaxswarm.logs.motion import Filtering, Motion, prepare
from jaxswarm.logs.resampling import TooShort
from jaxswarm.logs.runs import runs
from jaxswarm.logs.sampling import sampling, usual_period

# Samples closer than this share of the usual period came in one message: their stamps tell no motion.
_BURST = 0.05


def split_at_gaps(log: Log, longest: float = CARRIED) -> list[Log]:
    """Split a log where time passes without samples, or where its clock jumped.

    Args:
        log: A checked log.
        longest: Time without samples [s] up to which it is not split.

    Returns:
        The stretches in order, with the log's own time stamps; the log itself if it has no gap.

    >>> t = np.concatenate([np.arange(50), np.arange(300, 340)]) * 0.01
    >>> [len(part.t) for part in split_at_gaps(Log("demo", ("joint1",), t, np.sin(t)[:, None]))]
    [50, 40]
    """
    if len(log.t) < 3:
        return [log]
    gaps = sampling(log.t, log.q).gaps
    cuts = [gap.sample + 1 for gap in gaps if gap.clock_jump or gap.length > longest]
    if not cuts:
        return [log]
    edges = [0, *cuts, len(log.t)]
    return [take(log, slice(a, b)) for a, b in zip(edges[:-1], edges[1:], strict=True)]


def merge_bursts(log: Log) -> Log:
    """Replace samples that were stamped together by their mean, with a note.

    >>> t = np.repeat(np.arange(40) * 0.01, 2) + np.tile([0.0, 1e-6], 40)
    >>> len(merge_bursts(Log("demo", ("joint1",), t, np.sin(t)[:, None])).t)
    40
    """
    together = np.diff(log.t) < _BURST * usual_period(log.t)
    if not together.any():
        return log
    starts = np.flatnonzero(np.concatenate([[True], ~together]))
    counts = np.diff(np.append(starts, len(log.t)))

    def mean(values: np.ndarray) -> np.ndarray:
        sums = np.add.reduceat(values, starts, axis=0)
        return sums / counts.reshape(-1, *[1] * (values.ndim - 1))

    note = (
        f"{len(log.t)} samples bear {len(starts)} distinct times: those stamped together are averaged. "
        "Stamp every sample where it is measured."
    )
    return replace(
        log,
        # The mean of large stamps loses digits that the differences need.
        t=log.t[0] + mean(log.t - log.t[0]),
        q=mean(log.q),
        dq=None if log.dq is None else mean(log.dq),
        ddq=None if log.ddq is None else mean(log.ddq),
        tau=None if log.tau is None else mean(log.tau),
        channels={name: mean(np.asarray(x, dtype=float)) for name, x in log.channels.items()},
        notes=(*log.notes, note),
    )


def prepare_segments(log: Log, filtering: Filtering | None = None) -> tuple[Log, list[Motion]]:
    """Prepare every stretch of a log by itself, all with the same cutoffs.

    Args:
        log: A checked log.
        filtering: Frequencies to use; what is None is found from the longest stretch.

    Returns:
        The log with notes on what was done, and the motions; their time counts from the begin of the
        log.

    Raises:
        InputError: If not even the longest stretch can be filtered.
    """
    filtering = filtering or Filtering()
    log = drop_contradictions(merge_bursts(log))
    parts, longest, first = _uncut(log, filtering)
    band = first.filtering
    motions, dropped = [], []
    for k, part in enumerate(parts):
        motion = first if k == longest else _prepared(part, band, first)
        if motion is None:
            dropped.append(f"{part.t[0]:.6g} to {part.t[-1]:.6g} s")
        else:
            motions.append(replace(motion, t=motion.t + (part.t[0] - log.t[0])))
    notes = [note for note in first.notes if note not in log.notes]
    if len(parts) > 1:
        cuts = len(parts) - 1
        notes.append(
            f"Split at {cuts} gap{'s' * (cuts > 1)}: {len(motions)} of {len(parts)} parts used."
        )
    notes += _bridged_notes(motions)
    if dropped:
        shown = ", ".join(dropped[:3]) + (f" and {len(dropped) - 3} more" * (len(dropped) > 3))
        notes.append(f"Left out, too short to filter between two gaps: {shown}.")
    return replace(log, notes=(*log.notes, *notes)), motions


def uncut(log: Log, filtering: Filtering) -> list[Log]:
    """The stretches of a checked log between gaps that are not short against its motion."""
    return _uncut(log, filtering)[0]


def _uncut(log: Log, filtering: Filtering) -> tuple[list[Log], int, Motion]:
    """The same, which of them is the longest, and its motion.

    How short a gap has to be is told by the longest stretch without any.
    """
    parts = split_at_gaps(log)
    longest, first = _longest(parts, filtering)
    if len(parts) == 1:
        return parts, longest, first
    noise = first.position_noise
    joined = split_at_gaps(log, bridged_time(first.q, first.dq, first.ddq, noise))
    if len(joined) == len(parts):
        return parts, longest, first
    return joined, *_longest(joined, filtering)


def _longest(parts: list[Log], filtering: Filtering) -> tuple[int, Motion]:
    """Which stretch is the longest, and its motion."""
    longest = max(range(len(parts)), key=lambda k: len(parts[k].t))
    try:
        return longest, prepare(parts[longest], filtering)
    except TooShort as error:
        if len(parts) == 1:
            raise
        raise InputError(f"{error}. Gaps cut the log into {len(parts)} parts") from None


def _bridged_notes(motions: Sequence[Motion]) -> list[str]:
    """What is bridged, and how much is left out for it."""
    lost = [(m, *runs(m.lost)) for m in motions if m.lost is not None]
    lengths = [
        (b - a + 1) / m.rate for m, begins, ends in lost for a, b in zip(begins, ends, strict=True)
    ]
    if not lengths:
        return []
    rows = [m.lost_rows for m in motions]
    out, every = sum(int(r.sum()) for r in rows), sum(map(len, rows))
    gaps = f"{len(lengths)} gap{'s' * (len(lengths) > 1)}"
    return [
        f"{gaps} of up to {max(lengths):.2g} s, short against the motion, bridged for the filters alone: "
        f"{out} of {every} rows in and beside them are neither fitted nor scored."
    ]


def prepare_all(logs: Sequence[Log], filtering: Filtering) -> list[Motion]:
    """The stretches of several checked logs, all with the same cutoffs."""
    return [part for log in logs for part in prepare_segments(log, filtering)[1]]


def unfiltered(part: Log, like: Motion, start: float) -> Motion:
    """A stretch too short to filter as a motion: positions differentiated as they are logged.

    Args:
        part: The stretch, of any length.
        like: A motion of the same log, for its cutoffs.
        start: Time of its first sample since the begin of the log [s].
    """
    q, t = part.q, part.t - part.t[0] + start
    if len(t) > 1:
        dq = np.gradient(q, t, axis=0) if part.dq is None else part.dq
        ddq = np.gradient(dq, t, axis=0)
    else:
        dq = np.zeros_like(q) if part.dq is None else part.dq
        ddq = np.zeros_like(q)
    return replace(
        like,
        t=t,
        q=q,
        dq=dq,
        ddq=ddq,
        tau=part.tau,
        channels={n: np.asarray(x, float) for n, x in part.channels.items() if x.ndim == 2},
        decimator=Decimator(np.ones(1), 1),
        weight_skew=0.0,
    )


def _prepared(part: Log, band: Filtering, first: Motion) -> Motion | None:
    """A further stretch on the first one's cutoffs; None where it is too short for them."""
    try:
        motion = prepare(part, band)
    except TooShort:
        return None
    filtered = len(motion.decimator.taps) > 1 or len(first.decimator.taps) == 1
    return motion if filtered else None


def stretch(motion: Motion, first: int, last: int) -> Motion:
    """The samples of a motion from one to before another."""
    rows = slice(first, last)

    def cut(x: np.ndarray | None) -> np.ndarray | None:
        return None if x is None else x[rows]

    return replace(
        motion,
        t=motion.t[rows],
        q=motion.q[rows],
        dq=motion.dq[rows],
        ddq=motion.ddq[rows],
        tau=cut(motion.tau),
        bridged=cut(motion.bridged),
        lost=cut(motion.lost),
        channels={name: x[rows] for name, x in motion.channels.items()},
    )
