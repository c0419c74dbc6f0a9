"""What every description of a robot has to keep: names that are text, numbers that are numbers."""

from typing import Any

import numpy as np

from jaxswarm.errors import InputError

# Nothing on a robot reaches this in SI units; beyond it products of entries no longer are numbers.
LARGEST = 1e12
# A shorter axis is noise of whoever wrote it: its direction means nothing.
SHORTEST_AXIS = 1e-9
# A longer value is cut in messages.
_LONGEST = 60


def check_name(place: str, name: object) -> None:
    """Raise unless a joint's name is text that files, tables and the command line can hold."""
    if not isinstance(name, str):
        raise InputError(f"{place}: its name {shown(name)} is no text: put it in quotes.")
    if not name.strip():
        raise InputError(f"{place} has no name: give it one.")
    if not name.isprintable() or "," in name:
        raise InputError(
            f"{place}: its name {shown(name)} holds a comma or a character that cannot be printed: "
            "rename it."
        )


def unit_axis(place: str, axis) -> np.ndarray:
    """Return the direction of an axis (3,), or raise: it may be zero or not finite."""
    axis = np.asarray(axis, dtype=float)
    if axis.shape != (3,) or not SHORTEST_AXIS <= np.linalg.norm(axis) <= LARGEST:
        raise InputError(
            f"{place}: axis {axis.tolist()} is no direction: three numbers, not all zero, are needed."
        )
    return axis / np.linalg.norm(axis)


def check_numbers(place: str, what: str, values, shape: tuple[int, ...]) -> None:
    """Raise unless values are finite numbers of a shape."""
    values = np.asarray(values, dtype=float)
    if values.shape != shape or not (np.abs(values) <= LARGEST).all():  # false for NaN, too
        raise InputError(
            f"{place}: {what} {values.tolist()}: {' x '.join(map(str, shape))} finite numbers up to "
            f"{LARGEST:g} are needed."
        )


def shown(value: Any) -> str:
    """Return a value for a message, shortened; its repr may fail for integers of many digits."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        text = f"a {type(value).__name__} too large to show"
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."
