"""Units of measured columns, and the factors that bring them to SI.

A unit stands behind a name in brackets, ``q_joint1 [deg]``, or in ``--columns``.
"""

import re

import numpy as np

from jaxswarm.errors import InputError, nearest

_TURN = 2.0 * np.pi
_POSITIONS = {
    "rad": 1.0, "mrad": 1e-3, "deg": _TURN / 360.0, "turn": _TURN, "rev": _TURN,
    "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6,
}  # fmt: skip
# By quantity: unit without blanks to its size in s, rad, m, N m, N or A.
UNITS: dict[str, dict[str, float]] = {
    "t": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0},
    "q": _POSITIONS,
    "dq": {**{f"{unit}/s": size for unit, size in _POSITIONS.items()}, "rpm": _TURN / 60.0},
    "ddq": {f"{unit}/s^2": size for unit, size in _POSITIONS.items()},
    "tau": {"Nm": 1.0, "mNm": 1e-3, "Nmm": 1e-3, "Ncm": 1e-2, "kNm": 1e3, "N": 1.0, "kN": 1e3},
    "current": {"A": 1.0, "mA": 1e-3},
}
_BRACKETS = re.compile(r"(.*\S)\s*[\[(]([^\[\]()]+)[\])]")
_RATE = re.compile(r"([0-9.eE+]+)(k?)Hz")


def size_of(quantity: str, unit: str, place: str) -> float:
    """How much one of a unit is in SI.

    Args:
        quantity: ``t``, ``q``, ``dq``, ``ddq``, ``tau`` or ``current``.
        unit: Such as ``deg`` or ``N mm``.
        place: Where it stands, for the message.

    Raises:
        InputError: If the quantity has no units here, or the unit is not known.

    >>> size_of("tau", "N mm", "--columns")
    0.001
    """
    known = UNITS.get(quantity)
    if known is None:
        raise InputError(
            f"{place}: {quantity} has no unit here, only {', '.join(UNITS)} have. Give a scale."
        )
    size = known.get(_plain(unit))
    if size is None:
        raise InputError(f"{place}: unknown unit {unit!r} of {quantity}. {nearest(unit, known)}")
    return size


def rate_of(unit: str) -> float | None:
    """Samples a second, where the unit of time is a rate: the log has no clock of its own.

    >>> rate_of("1 kHz"), rate_of("ms")
    (1000.0, None)
    """
    found = _RATE.fullmatch(_plain(unit))
    try:
        rate = float(found[1]) * (1000.0 if found[2] else 1.0) if found else 0.0
    except ValueError:
        return None
    return rate if 0.0 < rate < np.inf else None


def in_brackets(name: str) -> tuple[str, str] | None:
    """A name and the unit behind it; None where there is none.

    >>> in_brackets("q_joint1 [deg]")
    ('q_joint1', 'deg')
    """
    found = _BRACKETS.fullmatch(name.strip())
    return (found[1], found[2].strip()) if found else None


def is_unit(quantity: str, unit: str) -> bool:
    """Whether a quantity can have this unit."""
    return _plain(unit) in UNITS.get(quantity, {})


def _plain(unit: str) -> str:
    """A unit without blanks, dots and stars, in letters of a keyboard."""
    text = re.sub(r"[\s*·.]", "", unit) if not unit.strip()[:1].isdigit() else unit.replace(" ", "")
    for sign, letters in (("°", "deg"), ("µ", "u"), ("μ", "u"), ("²", "^2"), ("s2", "s^2")):
        text = text.replace(sign, letters)
    return text
