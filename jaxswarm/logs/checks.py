"""What makes a log unusable: refused with file, row, column, what is wrong and what to do.

Only what would falsify a result without being seen is refused. What is merely poor (gaps, jitter,
stuck or saturated values) is told by :mod:`jaxswarm.logs.findings` and left to the reader.
"""

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.columns import Arranged
from jaxswarm.logs.names import QUANTITIES
from jaxswarm.logs.sampling import usual_period
from jaxswarm.logs.table import Table

# No robot moves at less than two samples a second in a useful log; clocks in ms, us or ns look so.
_SLOWEST_PERIOD = 0.5
_FASTEST_PERIOD = 1e-6
# Larger numbers than this are no position, speed or torque of a machine in SI units.
_LARGEST = 1e9
# A gap this many times longer than all recorded time is a clock that was set, not a pause.
_LONGEST_GAP = 100.0


def check_values(table: Table, arranged: Arranged) -> None:
    """Refuse time, positions, velocities, accelerations or torques that are no finite numbers.

    Raises:
        InputError: Naming the first bad row and its column.
    """
    bad = ~np.isfinite(arranged.t)
    if bad.any():
        row = int(np.argmax(bad))
        _refuse_cell(table, row, "t", arranged.t[row])
    for quantity in QUANTITIES:
        values = arranged.joint.get(quantity)
        if values is None:
            continue
        bad = np.stack([~(np.abs(x) <= _LARGEST) for x in values.T], axis=1)
        if bad.any():
            row = int(np.argmax(bad.any(axis=1)))
            index = int(np.argmax(bad[row]))
            _refuse_cell(table, row, arranged.labels[quantity, index], values[row, index])


def _refuse_cell(table: Table, row: int, column: str, value: float) -> None:
    what = "no number (NaN or an empty cell)" if np.isnan(value) else f"{value:g}"
    raise InputError(
        f"{table.source}: {table.row(row)}, column {column} holds {what}. Remove the row, or cut "
        "the log there if the reading failed for longer."
    )


def drop_repeated_rows(table: Table, arranged: Arranged) -> tuple[np.ndarray, str | None]:
    """Find rows that repeat the one before them in every column, time included.

    Returns:
        Mask of the rows to keep, shape (T,), and a sentence about the others, or None.
    """
    same = arranged.t[1:] == arranged.t[:-1]
    others = (
        *(x for values in arranged.joint.values() for x in values.T),
        *arranged.shared.values(),
    )
    for x in others if same.any() else ():  # by their time nearly all rows differ already
        same &= (x[1:] == x[:-1]) | (np.isnan(x[1:]) & np.isnan(x[:-1]))
    keep = np.concatenate([[True], ~same])
    count = int(np.sum(~keep))
    if not count:
        return keep, None
    first = table.row(int(np.argmin(keep)))
    what = "row that repeats" if count == 1 else "rows that repeat"
    return keep, f"Left out: {count} {what} the one before, time included (first: {first})."


def check_time(table: Table, time: np.ndarray, rows: np.ndarray) -> None:
    """Refuse time that does not increase, or whose unit cannot be seconds.

    Args:
        table: For the names in messages.
        time: Time stamps, shape (T,), finite.
        rows: Row of each stamp in the table, shape (T,).

    Raises:
        InputError: If there are fewer than two samples, time stands still or runs backwards, the
            clock was set during the log, or the period is implausible.
    """
    if len(time) < 2:
        raise InputError(
            f"{table.source}: {len(time)} sample{'s' * (len(time) != 1)}, a motion needs many. Was "
            "the log cut?"
        )
    period = np.diff(time)
    if (period <= 0).any():
        first = int(np.argmax(period <= 0))
        before, now, where = time[first], time[first + 1], table.row(int(rows[first + 1]))
        if f"{before:.10g}" != f"{now:.10g}":
            raise InputError(
                f"{table.source}: {where}, column t: time runs backwards, from {before:.10g} to "
                f"{now:.10g} s. Sort the rows if they were shuffled; if two runs were joined, "
                "split them into two logs."
            )
        count = int(np.sum(period == 0))
        raise InputError(
            f"{table.source}: {where}, column t: time {now:.10g} s is given twice with different "
            f"values ({count} such rows). Write time with more digits, or keep one row per time."
        )
    usual = usual_period(time)
    if usual > _SLOWEST_PERIOD:
        unit = "ms" if usual < 200 else "us" if usual < 2e5 else "ns"
        raise InputError(
            f"{table.source}: column t: {usual:g} s between samples is too slow for a motion. t "
            f"must be in seconds: is it in {unit}?"
        )
    if usual < _FASTEST_PERIOD:
        raise InputError(
            f"{table.source}: column t: {usual:g} s between samples is faster than any robot's "
            "log. t must be in seconds."
        )
    recorded = float(np.sum(period[period <= 10 * usual]))
    worst = int(np.argmax(period))
    if period[worst] > _LONGEST_GAP * recorded:
        raise InputError(
            f"{table.source}: {table.row(int(rows[worst + 1]))}, column t: time jumps from "
            f"{time[worst]:.10g} to {time[worst + 1]:.10g} s, but only {recorded:.4g} s were "
            "recorded. The clock was set: split the log there."
        )


def torque(
    table: Table,
    arranged: Arranged,
    joints: tuple[str, ...],
    drive_gain: np.ndarray | None,
    require_torque: bool,
    suggestion: str = "",
) -> tuple[np.ndarray | None, list[str]]:
    """Find the motor torque: ``tau`` as logged, else ``drive_gain * current``.

    Args:
        table: For the names in messages.
        arranged: Columns in the robot's order.
        joints: Joint names, n of them.
        drive_gain: Torque per current [N m/A or N/A], shape (n,), NaN where unknown; None if all
            are.
        require_torque: Whether a log without torque is refused.
        suggestion: Sentence about columns that may have been meant.

    Returns:
        Torque (T, n) [N m or N] or None, and notes.

    Raises:
        InputError: If torque is required and cannot be had.
    """
    if "tau" in arranged.joint:
        both = "current" in arranged.joint
        return arranged.joint["tau"], ["Both tau and current are given; tau is used."] * both
    if "current" not in arranged.joint:
        if require_torque:
            raise InputError(
                f"{table.source}: no torque. Expected columns tau_{joints[0]}, ... [N m], or "
                f"current_{joints[0]}, ... [A] of a robot with drive gains.{suggestion}"
            )
        return None, []
    gain = (
        np.full(len(joints), np.nan)
        if drive_gain is None
        else np.asarray(drive_gain, dtype=np.float64)
    )
    unknown = [joint for joint, value in zip(joints, gain, strict=True) if not np.isfinite(value)]
    if not unknown:
        return arranged.joint["current"] * gain, [
            "Torque is the motor current times the robot's drive gain."
        ]
    if require_torque:
        raise InputError(
            f"{table.source}: the log has currents, but the robot has no drive gain for "
            f"{', '.join(unknown)}. Give drive_gain [N m/A] in the robot's TOML file, or log tau."
        )
    return None, [f"Currents are not used: the robot has no drive gain for {', '.join(unknown)}."]
