"""Numbers as a reader wants them: percentages, units, and no more digits than the interval supports."""

import math

# A share beyond this is no matter of digits: nothing told what it is a share of.
_MUCH = 10.0


def percent(share: float | None, digits: int = 2) -> str:
    """A share in percent; what rounds to nothing has no sign, what is no number is a dash, and much is much.

    >>> percent(0.0234), percent(-0.00001, 1), percent(95673.42)
    ('2.34 %', '0.0 %', '>1000 %')
    """
    if share is None or not math.isfinite(share):
        return "-"
    if share > _MUCH:
        return f">{100.0 * _MUCH:.0f} %"
    return f"{round(100.0 * share, digits) + 0.0:.{digits}f} %"


def number(value: float | None, digits: int = 4) -> str:
    """A number with so many significant digits; a dash where there is none, and no sign of a zero.

    >>> number(2.00004), number(-0.0), number(None)
    ('2', '0', '-')
    """
    return "-" if value is None or not math.isfinite(value) else f"{value + 0.0:.{digits}g}"


def measure(value: float | None) -> str:
    """A number with three significant digits, zeros at its end included, so that a column lines up.

    >>> measure(0.06), measure(123.4)
    ('0.0600', '123')
    """
    if value is None or not math.isfinite(value):
        return "-"
    return f"{value:#.3g}".rstrip(".")


def unit_text(unit: str) -> str:
    """A unit behind a number: a pure number has none.

    >>> unit_text("rad/s"), unit_text("1")
    (' rad/s', '')
    """
    return "" if unit in ("1", "") else f" {unit}"


def interval(row: dict) -> tuple[float, float] | None:
    """The 95 % interval of a parameter; None where nothing is known of its error."""
    pair = row.get("interval_95")
    if pair is None and row.get("std_error") is not None and math.isfinite(row["std_error"]):
        pair = row["value"] - 1.96 * row["std_error"], row["value"] + 1.96 * row["std_error"]
    if pair is None or any(x is None or not math.isfinite(x) for x in pair) or pair[0] == pair[1]:
        return None
    return pair[0], pair[1]


def estimate(row: dict) -> tuple[str, str]:
    """Value and 95 % interval of a parameter with the digits that the interval supports, without unit.

    >>> estimate({"value": 0.223961, "interval_95": [0.221609, 0.226313]})
    ('0.2240', '0.2216 to 0.2263')
    >>> estimate({"value": 2.0, "std_error": None})
    ('2', '-')
    """
    pair = interval(row)
    if pair is None:
        return number(row["value"], 5), "-"
    low, high = pair
    size = max(abs(low), abs(high))
    # Two digits of the half width, and so many for all three numbers.
    digits = math.floor(math.log10(size)) - math.floor(math.log10((high - low) / 2)) + 2
    value, low_text, high_text = (
        _fixed(x, size, min(max(digits, 2), 10)) for x in (row["value"], low, high)
    )
    return value, f"{low_text} to {high_text}"


def _fixed(x: float, size: float, digits: int) -> str:
    """A number with the decimals that so many significant digits of ``size`` have."""
    power = math.floor(math.log10(size))
    if not -4 <= power < 6:
        return f"{round(x / 10.0**power, digits - 1) + 0.0:.{digits - 1}f}e{power:+03d}"
    decimals = max(digits - 1 - power, 0)
    return f"{round(x, decimals) + 0.0:.{decimals}f}"


def value_text(row: dict) -> str:
    """A parameter with its interval and unit: ``0.108 rad/s (95 %: 0.104 to 0.112)``; of a change, both."""
    if row.get("change"):
        now = value_text({k: v for k, v in row.items() if k not in ("change", "before")})
        before = f"{number(row['before'], 5)}{unit_text(row['unit'])}"
        return f"{now}, was {before}: changed by {value_text(row['change'])}"
    value, between = estimate(row)
    told = f"{value}{unit_text(row['unit'])}"
    if between != "-":
        return f"{told} (95 %: {between})"
    error = row.get("std_error")
    return f"{told} (assumed: the log does not tell it)" if error is not None else told
