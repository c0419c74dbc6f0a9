"""Whether a result read from a file holds what a comparison reads of it."""

from collections.abc import Callable, Mapping
from typing import Any

from jaxswarm.errors import InputError

# Numbers beyond this are no result of ours, and their differences overflow.
_LARGEST = 1e150
# Characters of a damaged value that a message shows.
_SHOWN = 60


def check_report(item: Mapping, which: str) -> None:
    """Refuse an identification or a diagnosis of which a part is missing or of another kind.

    Args:
        item: Content of the file.
        which: The file, for the message.

    Raises:
        InputError: Naming the place and what stands there.
    """

    def need(good: bool, place: str, value: Any) -> None:
        if not good:
            raise InputError(
                f"{which}: {place} = {repr(value)[:_SHOWN]}: the file is damaged; write it again"
            )

    joints = item["joints"]
    need(_texts(joints) and bool(joints), "joints", joints)
    need(_list_of(item["effects"], Mapping), "effects", item["effects"])
    for k, effect in enumerate(item["effects"]):
        place = f"effects[{k}]"
        need(isinstance(effect.get("effect"), str), f"{place}.effect", effect.get("effect"))
        for key in ("joint", "other"):
            need(_is(effect.get(key), str, none=True), f"{place}.{key}", effect.get(key))
        rows = effect.get("parameters")
        need(isinstance(rows, Mapping), f"{place}.parameters", rows)
        for name, row in rows.items():
            _check_row(row, f"{place}.parameters.{name}", need)
    rows = item.get("base_parameters", [])
    need(_list_of(rows, Mapping), "base_parameters", rows)
    for k, row in enumerate(rows):
        _check_row(row, f"base_parameters[{k}]", need)
        for key in ("effect", "expression"):
            need(isinstance(row.get(key), str), f"base_parameters[{k}].{key}", row.get(key))
    need(_is(item.get("verdict"), str, none=True), "verdict", item.get("verdict"))
    units = item.get("torque_units")
    need(_texts(units) and units is not None and len(units) == len(joints), "torque_units", units)
    _check_errors(item["error"], len(joints), need)


def _check_row(row: Any, place: str, need: Callable) -> None:
    need(isinstance(row, Mapping), place, row)
    need("value" in row, place, row)
    for key in ("value", "std_error"):
        need(_number(row.get(key), none=True), f"{place}.{key}", row.get(key))
    need(isinstance(row.get("unit"), str), f"{place}.unit", row.get("unit"))


def _check_errors(errors: Any, size: int, need: Callable) -> None:
    need(isinstance(errors, Mapping), "error", errors)
    for name, part in errors.items():
        for one in part if isinstance(part, list) else [part]:
            if not isinstance(one, Mapping) or "relative_global" not in one:
                continue
            place = f"error.{name}"
            need(
                _number(one["relative_global"]), f"{place}.relative_global", one["relative_global"]
            )
            for key in ("rms", "relative"):
                row = one.get(key)
                good = isinstance(row, list) and len(row) == size and all(map(_number, row))
                need(good, f"{place}.{key}", row)


def _texts(value: Any) -> bool:
    return _list_of(value, str)


def _list_of(value: Any, kind: type) -> bool:
    return isinstance(value, list | tuple) and all(isinstance(x, kind) for x in value)


def _is(value: Any, kind: type, none: bool = False) -> bool:
    return isinstance(value, kind) or (none and value is None)


def _number(value: Any, none: bool = False) -> bool:
    if value is None:
        return none
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return value != value or abs(value) < _LARGEST
