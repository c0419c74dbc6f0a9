r"""Which arm a log is of, and of what day: read from its path, by one stated rule.

The path is that below LOGS. The arm is the first folder of it; a log without a folder of its own is named
by its file, up to the first underscore, blank or date. The date is the first ``2026-01-31`` or
``20260131`` of the path, with a time (``T0930``, ``_09-30-15``) where one follows. Another rule is a
regular expression with groups named ``arm`` and, if there is one, ``date``, that is searched in the path.
"""

import re
from datetime import datetime
from pathlib import PurePosixPath

from jaxswarm.errors import InputError

_DATE = re.compile(
    r"(?<!\d)(\d{4})-?([01]\d)-?([0-3]\d)(?:[T_ -]?([0-2]\d)[-:]?([0-5]\d)(?:[-:]?([0-5]\d))?)?(?!\d)"
)
_FIRST_WORD = re.compile(r"[_ ]")


def read_pattern(text: str | None) -> re.Pattern | None:
    """The rule of the option ``--arm-pattern``.

    Raises:
        InputError: If it is no regular expression, or has no group ``arm``.
    """
    if text is None:
        return None
    try:
        pattern = re.compile(text)
    except re.error as error:
        raise InputError(f"--arm-pattern {text!r}: is no regular expression ({error})") from None
    if "arm" not in pattern.groupindex:
        raise InputError(
            f"--arm-pattern {text!r}: has no group named arm; write (?P<arm>...), such as "
            r"'(?P<arm>cell\d+)/(?P<date>\d{8})'"
        )
    return pattern


def arm_and_date(path: str, pattern: re.Pattern | None = None) -> tuple[str, datetime | None]:
    """Arm and date of a log.

    Args:
        path: Below LOGS, parted by slashes.
        pattern: Another rule, see :func:`read_pattern`.

    Raises:
        InputError: If the pattern does not match, or its date is none.

    >>> arm_and_date("arm7/run_2026-01-31.csv")
    ('arm7', datetime.datetime(2026, 1, 31, 0, 0))
    >>> arm_and_date("left-20260131T0930.csv")[0], arm_and_date("cell3_a.csv")
    ('left', ('cell3', None))
    """
    if pattern is not None:
        return _by_pattern(path, pattern)
    parts = PurePosixPath(path)
    if len(parts.parts) > 1:
        return parts.parts[0], find_date(path)
    stem = parts.name.removesuffix(parts.suffix)
    dated = _DATE.search(stem)
    name = _FIRST_WORD.split(stem[: dated.start()] if dated else stem)[0].strip("-._ ")
    return name or stem, find_date(stem)


def find_date(text: str) -> datetime | None:
    """The first date in a text; digits that are none, such as a 39th, are passed over."""
    for match in _DATE.finditer(text):
        try:
            year, month, day, *clock = (int(part) for part in match.groups(default="0"))
            hour, minute, second = clock
            return datetime(year, month, day, hour, minute, second)
        except ValueError:
            continue
    return None


def _by_pattern(path: str, pattern: re.Pattern) -> tuple[str, datetime | None]:
    match = pattern.search(path)
    if match is None or not match["arm"]:
        raise InputError(f"--arm-pattern {pattern.pattern!r}: does not match {path}")
    told = match["date"] if "date" in pattern.groupindex else None
    if told is None:
        return match["arm"], None
    try:
        return match["arm"], find_date(told) or datetime.fromisoformat(told).replace(tzinfo=None)
    except ValueError:
        raise InputError(
            f"--arm-pattern {pattern.pattern!r}: {told!r} in {path} is no date; match one such as "
            "2026-01-31, 20260131 or 2026-01-31T09:30"
        ) from None
