"""From the columns of a file to columns of ours: renamed, in SI, of the side and kind that were asked for.

What a file says itself is used without being asked: units in brackets behind a name. What it leaves open
is asked for: positions of both sides of a gear, and efforts where the robot could make a torque of either
kind.
"""

import re
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.logs.names import QUANTITIES, looks_like, place
from jaxswarm.logs.reading import EFFORTS, SIDES, Column, Reading
from jaxswarm.logs.table import Table
from jaxswarm.logs.units import in_brackets, is_unit, rate_of, size_of

EFFORT = "effort"
_SLICE = re.compile(r"(.*)\[([0-9]+)(?::([0-9]+))?\]")


def as_ours(
    table: Table,
    joints: tuple[str, ...],
    reading: Reading,
    drive_gain: np.ndarray | None = None,
) -> Table:
    """The table with names and units of ours.

    Args:
        table: As a file holds it.
        joints: The robot's joint names.
        reading: What the user says of it.
        drive_gain: Torque per current of every joint, NaN where unknown; None if all are.

    Raises:
        InputError: If a column that is named is not there, or a side or a kind has to be chosen.
    """
    table = _mapped(_with_units(table, joints), joints, reading)
    return _of_kind(_of_side(table, joints, reading.side), joints, reading.effort, drive_gain)


def joints_of_pattern(names: Iterable[str], reading: Reading) -> tuple[str, ...] | None:
    """Joints that a pattern for the positions finds in a file; None where there is no pattern.

    >>> joints_of_pattern(["pos_1", "pos_2", "x"], Reading((("q", Column("pos_{k}")),)))
    ('joint1', 'joint2')
    """
    name = dict(reading.columns).get("q", Column()).name
    if "{" not in name:
        return None
    pattern = re.escape(name).replace(r"\{k\}", "([0-9]+)").replace(r"\{joint\}", "(.+)")
    found = [match[1] for match in map(re.compile(pattern).fullmatch, names) if match]
    return tuple(f"joint{k}" if "{k}" in name else k for k in found) or None


def _with_units(table: Table, joints: tuple[str, ...]) -> Table:
    """Columns whose names end with a unit in brackets, in SI."""
    columns, notes = {}, list(table.notes)
    for name, values in table.columns.items():
        found = in_brackets(name)
        quantity = _quantity(found[0], joints) if found else ""
        if not found or not is_unit(quantity, found[1]) or found[0] in table.columns:
            columns[name] = values
            continue
        size = size_of(quantity, found[1], name)
        columns[found[0]] = values * size
        if size != 1.0:
            notes.append(f"{name} was converted to SI: times {size:.6g}.")
    return replace(table, columns=columns, notes=tuple(notes))


def _quantity(name: str, joints: tuple[str, ...]) -> str:
    """What a column measures, also a channel such as ``q_link``, and of a joint that is not known yet."""
    quantity = place(name, joints)[0]
    return re.split("[_0-9]", name)[0] if looks_like(name) else quantity


def _mapped(table: Table, joints: tuple[str, ...], reading: Reading) -> Table:
    if not reading.columns:
        return table
    made: dict[str, np.ndarray] = {}
    taken, notes = set(), []
    for target, column in reading.columns:
        if target == "t" and (rate := rate_of(column.unit)) is not None:
            made["t"] = np.arange(_length(table)) / rate
            continue
        for name, said, index in _expanded(table, target, column, joints):
            source = _meant(table, said)
            made[name] = _values(table, name, source, column, index, joints)
            taken.add(_SLICE.sub(r"\1", source))
    left = {name: x for name, x in table.columns.items() if name not in taken and name not in made}
    lost = [name for name in made if name in table.columns and name not in taken]
    notes += [f"{name} of the file was left out for what --columns names." for name in lost]
    rejected = {name: why for name, why in table.rejected.items() if name not in made}
    return replace(
        table,
        columns={**left, **made},
        # Positions that the user has chosen stand in the robot's order, not in that of the file's names.
        joints=None if "q" in made else table.joints,
        rejected=rejected,
        notes=(*table.notes, *notes),
    )


def _meant(table: Table, source: str) -> str:
    """The column that a user means, with the part of it that is asked for."""
    part = _SLICE.fullmatch(source) if source not in table.columns else None
    if part is None:
        return table.column_of(source)
    return table.column_of(part[1]) + source[len(part[1]) :]


def _length(table: Table) -> int:
    return max((len(x) for x in table.columns.values() if x.ndim), default=0)


def _expanded(table: Table, target: str, column: Column, joints: tuple[str, ...]):
    """Our name, the name in the file and the joint's index, for every column that an entry stands for."""
    name = column.name or target
    if "{" in name:
        return [
            (f"{target}_{joint}", name.replace("{k}", str(k + 1)).replace("{joint}", joint), k)
            for k, joint in enumerate(joints)
        ]
    if name == target and target in QUANTITIES and target not in table.columns:
        every = [(n, place(n, joints)) for n in table.columns]
        rows = [(n, n, index) for n, (quantity, index) in every if quantity == target]
        return rows or [(target, target, None)]
    return [(target, name, place(target, joints)[1])]


def _values(
    table: Table,
    target: str,
    source: str,
    column: Column,
    index: int | None,
    joints: tuple[str, ...],
) -> np.ndarray:
    quantity = place(target, joints)[0]
    where = f"{table.source}: --columns {target}"
    unit, written = column.unit, in_brackets(source)
    if not unit and written and is_unit(quantity, written[1]):
        unit = written[1]  # the file says it behind its own name
    factor = size_of(quantity, unit, where) if unit else 1.0
    if len(column.scale) not in (0, 1, len(joints)):
        raise InputError(
            f"{where}: {len(column.scale)} scales for {len(joints)} joints ({', '.join(joints)}); give "
            "one, or one a joint"
        )
    scale = np.asarray(column.scale or (1.0,))
    if index is not None:
        scale = scale[min(index, len(scale) - 1)]
    found = _SLICE.fullmatch(source) if source not in table.columns else None
    name = found[1] if found else source
    if name not in table.columns:
        raise InputError(_not_there(table, where, name, table.columns))
    values = table.columns[name]
    if found:
        start, end = int(found[2]), int(found[3] or int(found[2]) + 1)
        if values.ndim != 2 or not start < end <= values.shape[1]:
            raise InputError(f"{where}: {source} asks for columns that shape {values.shape} lacks")
        values = values[:, start:end] if found[3] else values[:, start]
    if scale.size > 1 and values.shape[-1:] != scale.shape:
        raise InputError(f"{where}: one scale a joint, but {name} has shape {values.shape}")
    return values * (factor * scale)


def _not_there(table: Table, where: str, name: str, offered: Iterable[str]) -> str:
    reason = table.rejected.get(name)
    if reason:
        return f"{where}: {reason} Every sample needs a number there."
    return f"{where}: the file has no column {name!r}. {nearest(name, offered)}"


def _of_side(table: Table, joints: tuple[str, ...], side: str | None) -> Table:
    """Columns of the side that was asked for in place of those without a side."""
    placed = {name: place(name, joints) for name in table.columns}
    given = {quantity for quantity, _ in placed.values()}
    chosen: dict[str, str] = {}
    for quantity in QUANTITIES:
        offered = [s for s in SIDES if f"{quantity}_{s}" in given]
        if side in offered:
            chosen[f"{quantity}_{side}"] = quantity
        elif offered and quantity not in given and quantity in ("q", "tau"):
            raise InputError(
                f"{table.source}: {quantity} is measured on the side of the "
                f"{' and of the '.join(offered)} ({', '.join(f'{quantity}_{s}' for s in offered)}). "
                f"Say which is meant: {' or '.join(f'--side {s}' for s in offered)}."
            )
    if side is not None and not chosen:
        raise InputError(
            f"{table.source}: --side {side}: no column q_{side} or tau_{side}; leave --side out"
        )
    if not chosen:
        return table
    columns = {}
    for name, values in table.columns.items():
        quantity, index = placed[name]
        if quantity in chosen:
            quantity = chosen[quantity]
            columns[quantity if index is None else f"{quantity}_{joints[index]}"] = values
        elif quantity not in chosen.values():
            columns[name] = values
    told = f"{', '.join(chosen.values())} are those of the {side} side."
    return replace(table, columns=columns, notes=(*table.notes, told))


def _of_kind(
    table: Table, joints: tuple[str, ...], effort: str | None, drive_gain: np.ndarray | None
) -> Table:
    """Efforts as torques or as currents."""
    efforts = {name: place(name, joints) for name in table.columns}
    efforts = {name: at for name, at in efforts.items() if at[0] == EFFORT}
    if not efforts:
        if effort is not None:
            raise InputError(
                f"{table.source}: --effort {effort}: the log has no efforts; leave it out"
            )
        return table
    if any(place(name, joints)[0] in ("tau", "current") for name in table.columns):
        return table
    if effort is None and drive_gain is not None and np.isfinite(drive_gain).all():
        raise InputError(
            f"{table.source}: efforts may be torques [N m] or motor currents [A], and the robot has "
            "drive gains to make torques of these. Say which: --effort torque or --effort current."
        )
    kind = dict(zip(EFFORTS, ("tau", "current"), strict=True))[effort or "torque"]
    names = {n: kind if at[1] is None else f"{kind}_{joints[at[1]]}" for n, at in efforts.items()}
    columns = {names.get(name, name): values for name, values in table.columns.items()}
    told = () if effort else ("Efforts are taken as torques of the joints, N m or N.",)
    return replace(table, columns=columns, notes=(*table.notes, *told))
