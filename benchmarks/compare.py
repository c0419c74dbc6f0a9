"""Two result files side by side: rows that belong together, and the ratio of each of their numbers.

A row is known by its texts and truth values and, where those do not tell the rows of a file apart, by
as many of its whole numbers as it takes. All other numbers are measured; a list counts by its median,
a nested record by its members.
"""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jaxswarm.errors import InputError

Row = dict[str, Any]


def read_rows(path: Path) -> list[Row]:
    """Read JSON lines, one object each.

    Raises:
        InputError: No such file, or a line that is no object.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read ({error}): give a file of JSON lines.") from error
    rows = []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip():
            continue
        try:
            row = json.loads(line)
        except json.JSONDecodeError as error:
            raise InputError(f"{path}, line {number} is no JSON ({error}).") from error
        if not isinstance(row, dict):
            raise InputError(f"{path}, line {number} is {line[:40]!r}, expected an object.")
        rows.append(row)
    if not rows:
        raise InputError(f"{path} is empty: expected one JSON object a line.")
    return rows


def compare(first: Path, second: Path, by: Sequence[str] | None = None) -> str:
    """Table of the numbers of two files with their ratios, and the geometric mean a field.

    Args:
        first, second: Files of JSON lines, as the benchmarks write them.
        by: Fields that tell rows apart; default as the head of this file says.
    """
    rows = read_rows(first), read_rows(second)
    by = _known_by(rows[0] + rows[1], rows) if by is None else list(by)
    a, b = (_by_key(path, part, by) for path, part in zip((first, second), rows, strict=True))
    shared = [key for key in a if key in b]
    if not shared:
        raise InputError(
            f"{first} and {second} have no row in common by {', '.join(by)}: name the fields that "
            "tell rows apart with --by."
        )
    lines = [f"A = {first}", f"B = {second}", *_other_machines(a, b, shared)]
    ratios: dict[str, list[float]] = {}
    for key in shared:
        lines.append(" ".join(map(str, key)))
        before, after = (_numbers(side[key], by) for side in (a, b))
        for field in (name for name in before if name in after):
            ratio = _ratio(before[field], after[field])
            lines.append(f"    {field:<32}{before[field]:>12.4g}{after[field]:>12.4g}{ratio:>9.3f}")
            if 0.0 < ratio < math.inf:
                ratios.setdefault(field, []).append(ratio)
    lines += ["", f"B / A, geometric mean over rows (rows known by {', '.join(by)})"]
    for field, values in ratios.items():
        mean = math.exp(np.mean(np.log(values)))
        lines.append(
            f"    {field:<32}{mean:>9.3f}   [{min(values):.3g}, {max(values):.3g}] of {len(values)}"
        )
    for name, side in (("A", a), ("B", b)):
        alone = [key for key in side if key not in shared]
        lines += [f"only in {name}: {' '.join(map(str, key))}" for key in alone]
    return "\n".join(lines)


def _known_by(rows: list[Row], files: Sequence[list[Row]]) -> list[str]:
    """Texts and truth values; whole numbers as long as two rows of a file look alike."""

    def of(kind):
        names = dict.fromkeys(name for row in rows for name in row)
        return [n for n in names if all(isinstance(row.get(n, kind()), kind) for row in rows)]

    by = of(str) + of(bool)
    for name in of(int):
        if name in by or all(_distinct(part, by) == len(part) for part in files):
            continue
        if any(_distinct(part, [*by, name]) > _distinct(part, by) for part in files):
            by.append(name)
    return by


def _distinct(rows: list[Row], by: list[str]) -> int:
    return len({_key(row, by) for row in rows})


def _key(row: Row, by: Sequence[str]) -> tuple:
    return tuple(str(row.get(name)) for name in by)


def _by_key(path: Path, rows: list[Row], by: Sequence[str]) -> dict[tuple, Row]:
    absent = [name for name in by if not any(name in row for row in rows)]
    if absent:
        raise InputError(f"{path} has no field {absent[0]!r}; it has {', '.join(rows[0])}.")
    found: dict[tuple, Row] = {}
    for row in rows:
        key = _key(row, by)
        if key in found:
            raise InputError(
                f"{path} has two rows with {dict(zip(by, key, strict=True))}: name more fields "
                "with --by."
            )
        found[key] = row
    return found


def _numbers(row: Row, by: Sequence[str], prefix: str = "") -> dict[str, float]:
    """Measured numbers by name, those of nested records with a dot."""
    found: dict[str, float] = {}
    for name, value in row.items():
        if name in by and not prefix:
            continue
        if isinstance(value, dict):
            found |= _numbers(value, by, f"{prefix}{name}.")
        elif isinstance(value, list) and value and all(_is_number(v) for v in value):
            found[f"{prefix}{name}, median"] = float(np.median(value))
        elif _is_number(value):
            found[f"{prefix}{name}"] = float(value)
    return found


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _ratio(before: float, after: float) -> float:
    if before == after:
        return 1.0
    return after / before if before else math.inf


def _other_machines(a: dict, b: dict, shared: Sequence[tuple]) -> list[str]:
    """Say where two files come from different machines or versions: then ratios mean less."""
    machines = [side[shared[0]].get("machine") for side in (a, b)]
    if machines[0] == machines[1]:
        return []
    return [f"Other machines or versions: {machines[0]} and {machines[1]}"]
