"""What the results of single logs say of the fleet: one short entry a log, one series a parameter."""

from array import array
from collections.abc import Iterable, Sequence
from datetime import datetime
from typing import NamedTuple

import numpy as np

from jaxswarm.diagnose.report.text import where
from jaxswarm.fleet.mixed_model import Series
from jaxswarm.fleet.sources import Source

_DAY = 86400.0
# Held by physics, not told by the data: nothing to compare.
_HELD = "at bound"


class Entry(NamedTuple):
    """One log in a line.

    Attributes:
        source: The log.
        verdict: That of the diagnosis, or ``refused`` or ``failed``.
        reason: Why nothing can be said of it; empty: no such.
        found: Effects that were added or have changed, as text.
        over_noise: Residual over noise of every joint; empty: unknown.
    """

    source: Source
    verdict: str
    reason: str
    found: tuple[str, ...]
    over_noise: tuple[float, ...]


class Fleet(NamedTuple):
    """All logs, those of one arm together and in order of time.

    Attributes:
        joints, units: Names, and units of torque; empty where no log could be used.
        entries: One a log.
        series: One for every parameter that is a number of the arm; see :class:`Series`.
        parameters: Unit and joint (or None) of every series, by its name.
    """

    joints: tuple[str, ...]
    units: tuple[str, ...]
    entries: list[Entry]
    series: list[Series]
    parameters: dict[str, tuple[str, str | None]]


def in_order(sources: Iterable[Source]) -> list[Source]:
    """Arm by arm, in order of time; logs without a date last, by path."""
    return sorted(sources, key=lambda s: (s.arm, s.date or datetime.max, s.path))


def entry(source: Source, content: dict) -> Entry:
    """The line of a log, from the content of its result."""
    if "unused" in content:
        return Entry(source, content["unused"], content["reason"], (), ())
    found = tuple(where(effect) for effect in (*content["effects"], *content["changed"]))
    over = tuple(np.nan if x is None else x for x in content["residual_over_noise"] or ())
    return Entry(source, content["verdict"], "; ".join(content["reasons"]), found, over)


def collect(results: Iterable[tuple[Source, dict]]) -> Fleet:
    """Put results together that come arm by arm, in order of time."""
    entries: list[Entry] = []
    numbers: dict[str, tuple[array, array, array]] = {}
    parameters: dict[str, tuple[str, str | None]] = {}
    joints: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    for source, content in results:
        entries.append(entry(source, content))
        if "verdict" not in content:
            continue
        joints, units = tuple(content["joints"]), tuple(content["torque_units"])
        for row in content.get("base_parameters", ()):
            if row["verdict"] == _HELD or row["value"] is None or not row["std_error"]:
                continue
            key = parameter_key(row)
            parameters.setdefault(key, (row["unit"], joint_of(row, joints)))
            place, values, errors = numbers.setdefault(key, (array("q"), array("d"), array("d")))
            place.append(len(entries) - 1)
            values.append(row["value"])
            errors.append(row["std_error"])
    series = [_series(key, entries, *columns) for key, columns in sorted(numbers.items())]
    return Fleet(joints, units, entries, series, parameters)


def parameter_key(row: dict) -> str:
    """What tells which parameters of two logs are the same: the combination that the data could tell."""
    return row["expression"]


def joint_of(row: dict, joints: Sequence[str]) -> str | None:
    """The joint of a base parameter: that in its name, or that of its link."""
    named = [joint for joint in joints if row["name"].endswith(f"_{joint}")]
    if named:
        return max(named, key=len)
    digits = row["name"].lstrip("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_")
    if digits.isdigit() and 1 <= int(digits) <= len(joints):
        return joints[int(digits) - 1]
    return None


def _series(key: str, entries: list[Entry], place, values, errors) -> Series:
    own = [entries[k].source for k in place]
    days = [np.nan if s.date is None else s.date.timestamp() / _DAY for s in own]
    arms = [s.arm for s in own]
    return Series(key, arms, np.array(values), np.array(errors), np.array(days))
