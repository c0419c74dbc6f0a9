"""How a log is to be read: which columns mean what, in which units, and which part of a file is meant.

On the command line a list, ``t:ms,q=pos_{k}:deg,tau=trq_{k}:Nmm``; in a file, TOML:

topic = "/joint_states"                  # optional: topic, structure, group or episode
side = "link"                            # optional: where both sides of a gear are measured
effort = "current"                       # optional: what efforts are

[columns]                                # our name = the name in the file
t = { unit = "ms" }                      # the name is right, the unit is not
q = { name = "pos_{k}", unit = "deg" }   # {k}: number of the joint from 1, {joint}: its name
tau = { name = "effort", scale = [100, 120, -80] }
temperature_joint1 = "Motor temp 1"

A scale is one number or one a joint, as of gears between a motor and its joint. ``name[a:b]`` takes columns
a to b - 1 of an array. The unit of t may be a rate, ``100 Hz``, where a file has no clock.
"""

import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jaxswarm.documents import read_document
from jaxswarm.errors import InputError, nearest

SIDES = ("motor", "link")
EFFORTS = ("torque", "current")
_KEYS = ("topic", "side", "effort", "columns")
_COLUMN_KEYS = ("name", "unit", "scale")
_ENTRY = re.compile(r"(?P<target>[^=:]+)(=(?P<name>(?:[^:\[]|\[[^\]]*\])+))?(:(?P<unit>[^:]+))?")


@dataclass(frozen=True)
class Column:
    """Where a column of ours comes from.

    Attributes:
        name: Its name in the file, with ``{k}`` or ``{joint}`` for a column a joint; empty: our own name.
        unit: Its unit; empty: SI.
        scale: A factor, or one a joint.
    """

    name: str = ""
    unit: str = ""
    scale: tuple[float, ...] = ()


@dataclass(frozen=True)
class Reading:
    """What a file does not say about itself.

    Attributes:
        columns: Our names with what they come from.
        topic: Topic of a recording; structure, group or episode of a file with several logs.
        side: ``motor`` or ``link``: which of ``q_motor`` and ``q_link`` is q, likewise dq and tau.
        effort: ``torque`` or ``current``: what efforts are.
    """

    columns: tuple[tuple[str, Column], ...] = ()
    topic: str | None = None
    side: str | None = None
    effort: str | None = None


@dataclass(frozen=True)
class LogChoice:
    """The path of a log, or the address of many, together with how to read it; stands wherever that can."""

    path: str | Path
    reading: Reading

    def __str__(self) -> str:
        return str(self.path)

    def __fspath__(self) -> str:
        return os.fspath(self.path)


def reading_of(path: object) -> Reading:
    """How to read a log; the usual way where nothing is said."""
    return path.reading if isinstance(path, LogChoice) else Reading()


def parse_reading(
    columns: str | None = None,
    topic: str | None = None,
    side: str | None = None,
    effort: str | None = None,
) -> Reading:
    """What the options of the command line say; what they leave out, a TOML file may tell.

    Raises:
        InputError: If a file cannot be read, or something in it or in the list makes no sense.

    >>> parse_reading("t:ms,q=pos_{k}:deg").columns[1]
    ('q', Column(name='pos_{k}', unit='deg', scale=()))
    """
    document = {"columns": {}} if columns is None else _document(columns)
    place = f"--columns {columns}"
    for key, value in (("topic", topic), ("side", side), ("effort", effort)):
        document[key] = value if value is not None else document.get(key)
        if not isinstance(document[key], str | None):
            raise InputError(f"{place}: {key} = {document[key]!r} is no text: put it in quotes")
    for key, known in (("side", SIDES), ("effort", EFFORTS)):
        if document[key] is not None and document[key] not in known:
            raise InputError(f"--{key} {document[key]!r}: use {' or '.join(known)}")
    rows = document["columns"]
    return Reading(
        tuple((target, _column(f"{place}: {target}", entry)) for target, entry in rows.items()),
        document["topic"],
        document["side"],
        document["effort"],
    )


def _document(text: str) -> dict[str, Any]:
    """A list of columns, or the content of a TOML file."""
    if not text.lower().endswith(".toml"):
        return {"columns": _listed(text)}
    try:
        document = tomllib.loads(read_document(text))
    except OSError as error:
        raise InputError(f"--columns {text}: cannot be read ({error.strerror})") from None
    except InputError as error:
        raise InputError(f"--columns {error}") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"--columns {text}: not valid TOML ({error})") from None
    for key in document:
        if key not in _KEYS:
            raise InputError(f"--columns {text}: unknown key {key!r}. {nearest(key, _KEYS)}")
    columns = document.setdefault("columns", {})
    if not isinstance(columns, Mapping):
        raise InputError(f"--columns {text}: columns has to be a table, [columns]")
    return document


def _listed(text: str) -> dict[str, Any]:
    rows: dict[str, Any] = {}
    for entry in text.split(","):
        found = _ENTRY.fullmatch(entry.strip())
        if found is None or not (found["name"] or found["unit"]):
            raise InputError(
                f"--columns {text}: {entry!r} is no OURS=THEIRS[:UNIT] and no OURS:UNIT; give such a "
                "list, or a .toml file"
            )
        target = found["target"].strip()
        if target in rows:
            raise InputError(f"--columns {text}: {target} stands twice; keep one of them")
        rows[target] = {key: found[key].strip() for key in ("name", "unit") if found[key]}
    return rows


def _column(place: str, entry: Any) -> Column:
    if isinstance(entry, str):
        entry = {"name": entry}
    if not isinstance(entry, Mapping):
        raise InputError(
            f"{place} = {entry!r}: a name in quotes, or name, unit and scale in braces"
        )
    for key in entry:
        if key not in _COLUMN_KEYS:
            raise InputError(f"{place}: unknown key {key!r}. {nearest(key, _COLUMN_KEYS)}")
    for key in ("name", "unit"):
        if not isinstance(entry.get(key, ""), str):
            raise InputError(f"{place}: {key} = {entry[key]!r} is no text: put it in quotes")
    scale = entry.get("scale", [])
    scale = scale if isinstance(scale, list) else [scale]
    for factor in scale:
        number = isinstance(factor, int | float) and not isinstance(factor, bool)
        if not number or not 0.0 < abs(factor) < 1e12:
            raise InputError(
                f"{place}: scale {factor!r} is no factor; give numbers other than zero"
            )
    return Column(entry.get("name", ""), entry.get("unit", ""), tuple(map(float, scale)))
