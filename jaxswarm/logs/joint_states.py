"""Messages of joint states as one table: in order, in seconds, and joined where each holds some joints.

Where one message names all joints, those messages are the log. Else the messages are sorted by the joints
they name; the largest kind gives the clock, and the other joints are read between their own messages by
straight lines, which is told, with how far apart these are.
"""

from collections import Counter
from pathlib import Path
from typing import NamedTuple

import numpy as np

from jaxswarm.errors import InputError

# Joints whose own messages are further apart than this many periods of the clock are not read between them.
_SPARSE = 5.0


class State(NamedTuple):
    """One message.

    Attributes:
        stamp: Time of its header [ns].
        received: Time at which it was recorded [ns].
        names: Joints it names, k of them.
        values: Quantity to values (k,), where it has any.
    """

    stamp: int
    received: int
    names: tuple[str, ...]
    values: dict[str, np.ndarray]


def joined(
    path: Path, topic: str, states: list[State], joints: tuple[str, ...]
) -> tuple[np.ndarray, dict[str, np.ndarray], list[str]]:
    """Time [s] from the first stamp (T,), arrays (T, n) by quantity, and notes.

    Args:
        path: The recording, for messages.
        topic: Its topic, likewise.
        states: All messages of the topic.
        joints: The robot's joints, n of them.

    Raises:
        InputError: If the messages do not hold all joints, or too rarely.
    """
    notes: list[str] = []
    stamps = _stamps(states, notes)
    whole = [k for k, state in enumerate(states) if set(joints) <= set(state.names)]
    if whole:
        skipped = len(states) - len(whole)
        if skipped:
            notes.append(
                f"Left out: {skipped} of the messages of {topic}, without some of the joints."
            )
        extra = sorted({name for k in whole for name in states[k].names} - set(joints))
        kinds = [(joints, _sorted(stamps, whole, notes))]
    else:
        kinds = _kinds(path, topic, states, stamps, joints, notes)
        extra = sorted({name for state in states for name in state.names} - set(joints))
    if extra:
        notes.append(
            f"Joints of the recording that the robot does not have were left out: {', '.join(extra)}."
        )
    _check_sizes(path, topic, states, kinds)
    start = int(stamps[kinds[0][1][0]])
    arrays, clock = _between(path, states, stamps, kinds, joints, notes)
    notes.append(f"Time counts from the first stamp, {start // 10**9}.{start % 10**9:09d} s.")
    return (clock - start) * 1e-9, arrays, notes


def _check_sizes(path: Path, topic: str, states: list[State], kinds) -> None:
    for k in sorted(int(k) for _, rows in kinds for k in rows):
        for quantity, row in states[k].values.items():
            if row.size != len(states[k].names):
                raise InputError(
                    f"{path}: message {k + 1} of {topic} has {row.size} values of {quantity} for "
                    f"{len(states[k].names)} joints. Cut the recording there."
                )


def _stamps(states: list[State], notes: list[str]) -> np.ndarray:
    stamps = np.array([state.stamp for state in states], dtype=np.int64)
    if stamps.any():
        return stamps
    notes.append(
        "The headers carry no time; the times at which the messages were recorded are used."
    )
    return np.array([state.received for state in states], dtype=np.int64)


def _sorted(stamps: np.ndarray, rows: list[int], notes: list[str]) -> np.ndarray:
    """Rows in the order of their stamps."""
    picked = np.array(rows)
    late = int(np.sum(np.diff(stamps[picked]) < 0))
    if late:
        notes.append(f"The messages were sorted by their stamps: {late} came out of order.")
    return picked[np.argsort(stamps[picked], kind="stable")]


def _kinds(path, topic, states, stamps, joints, notes) -> list[tuple[tuple[str, ...], np.ndarray]]:
    """The messages by the joints they are read for: those that name most joints first."""
    counts = Counter(state.names for state in states)
    left, kinds = set(joints), []
    by_size = sorted(counts, key=lambda n: (len(left & set(n)), counts[n]), reverse=True)
    for names in by_size:
        mine = tuple(joint for joint in joints if joint in left and joint in names)
        if mine:
            rows = [k for k, state in enumerate(states) if state.names == names]
            kinds.append((mine, _sorted(stamps, rows, notes)))
            left -= set(mine)
    if left:
        raise InputError(
            f"{path}: no message of {topic} names {', '.join(sorted(left))}; they name "
            f"{', '.join(sorted({n for names in counts for n in names})) or 'none'}. Use the robot's "
            "joint names."
        )
    return kinds


def _between(
    path, states, stamps, kinds, joints, notes
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Arrays of every quantity at the stamps of the first kind that all kinds cover."""
    first = stamps[kinds[0][1]]
    low = max(stamps[rows[0]] for _, rows in kinds)
    high = min(stamps[rows[-1]] for _, rows in kinds)
    clock = first[(first >= low) & (first <= high)] if len(kinds) > 1 else first
    if len(clock) < 2 and len(first) > 1:
        raise InputError(f"{path}: the messages of some joints end before those of others begin.")
    quantities = sorted({q for _, rows in kinds for k in rows for q in states[k].values})
    arrays = {}
    for quantity in quantities:
        columns = np.full((len(clock), len(joints)), np.nan)
        for mine, rows in kinds:
            for joint in mine:
                columns[:, joints.index(joint)] = _series(
                    states, stamps, rows, joint, quantity, None if len(kinds) == 1 else clock
                )
        arrays[quantity] = columns
    for mine, rows in kinds[1:]:
        apart = np.diff(stamps[rows]).max(initial=0) * 1e-9
        period = float(np.median(np.diff(clock))) * 1e-9
        if apart > _SPARSE * period:
            raise InputError(
                f"{path}: the messages of {', '.join(mine)} are up to {apart:.3g} s apart, those of the "
                f"other joints {period:.3g} s. Record all joints at one rate."
            )
        if not np.isin(clock, stamps[rows]).all():
            notes.append(
                f"{', '.join(mine)} come in messages of their own, up to {apart:.3g} s apart, and are read "
                "between them by straight lines."
            )
    return arrays, clock


def _series(states, stamps, rows, joint, quantity, clock: np.ndarray | None) -> np.ndarray:
    """One joint's values at its own stamps, or between them at the stamps of a clock; NaN where missing."""
    values = np.array(
        [states[k].values[quantity][states[k].names.index(joint)] if quantity in states[k].values
         else np.nan for k in rows]
    )  # fmt: skip
    if clock is None:
        return values
    # Stamps of today in nanoseconds have more digits than a float: differences from the first one have not.
    start = clock[0]
    return np.interp((clock - start).astype(float), (stamps[rows] - start).astype(float), values)
