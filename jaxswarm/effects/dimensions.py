"""Units of programs: what a constant's unit has to be, and whether a program is dimensionally sound.

A unit is a dictionary of exponents by symbol; the torque of a turning joint is one symbol, ``N m``, as
is its angle, ``rad``, so that both translate to ``N`` and ``m`` for a sliding one.
"""

from collections.abc import Mapping

from jaxswarm.effects.postfix import BINARY, FUNCTIONS, NUMBER, UNARY, Program

Unit = dict[str, int]
TORQUE: Unit = {"N m": 1}
FIELD_UNITS: dict[str, Unit] = {
    "t": {"s": 1},
    "q": {"rad": 1},
    "dq": {"rad": 1, "s": -1},
    "ddq": {"rad": 1, "s": -2},
    "direction": {},
    "load": TORQUE,
    "static_load": TORQUE,
    "temperature": {"K": 1},
    "q_other": {"rad": 1},
    "dq_other": {"rad": 1, "s": -1},
    "ddq_other": {"rad": 1, "s": -2},
}
_ORDER = ("N m", "rad", "m", "s", "K")


def times(a: Unit, b: Unit, power: int = 1) -> Unit:
    """The unit of a times b to a power.

    >>> times({"rad": 1}, {"rad": 1, "s": -1}, -1)
    {'s': 1}
    """
    total = {k: a.get(k, 0) + power * b.get(k, 0) for k in dict.fromkeys([*a, *b])}
    return {k: n for k, n in total.items() if n}


def over(a: Unit, b: Unit) -> Unit:
    """The unit of a divided by b."""
    return times(a, b, -1)


def unit_text(unit: Unit) -> str:
    """A unit as effects state it.

    >>> unit_text({"N m": 1, "rad": -2, "s": 1}), unit_text({}), unit_text({"s": -1, "rad": -1})
    ('N m s/rad^2', '1', '1/(rad s)')
    """
    above = [_power(k, unit[k]) for k in _ORDER if unit.get(k, 0) > 0]
    below = [_power(k, -unit[k]) for k in _ORDER if unit.get(k, 0) < 0]
    top = " ".join(above) or "1"
    if not below:
        return top
    return f"{top}/{below[0] if len(below) == 1 else '(' + ' '.join(below) + ')'}"


def parse_unit(text: str) -> Unit:
    """Read what :func:`unit_text` wrote.

    Raises:
        ValueError: If it is no such unit.

    >>> parse_unit("N m s/rad^2"), parse_unit("1/(rad s)"), parse_unit("(N m)^2")
    ({'N m': 1, 's': 1, 'rad': -2}, {'rad': -1, 's': -1}, {'N m': 2})
    """
    above, _, below = text.replace("(N m)", "N_m").replace("N m", "N_m").partition("/")
    unit: Unit = {}
    for part, sign in ((above, 1), (below.strip("()"), -1)):
        for word in part.split():
            symbol, _, power = word.partition("^")
            symbol = symbol.replace("_", " ")
            if symbol == "1" and not power:
                continue
            if symbol not in _ORDER or not (power or "1").isdigit():
                raise ValueError(f"unit {text!r} cannot be read")
            unit = times(unit, {symbol: 1}, sign * int(power or 1))
    return unit


def _power(symbol: str, exponent: int) -> str:
    if exponent == 1:
        return symbol
    return f"{symbol}^{exponent}" if " " not in symbol else f"({symbol})^{exponent}"


def field_units(kind: str, partner: str | None) -> dict[str, Unit]:
    """Units of all fields on a joint of a kind, with a partner of a kind, before they are translated.

    What is said of a turning joint is translated for a sliding one, partner and all; the angle of a partner
    that turns is then a pure number.

    >>> field_units("revolute", "prismatic")["dq_other"]
    {'m': 1, 's': -1}
    """
    if partner in (None, kind):
        return FIELD_UNITS
    length: Unit = {"m": 1} if partner == "prismatic" else {}
    other = {name: times(length, {"s": 1}, -k) for k, name in enumerate(_PARTNER)}
    return {**FIELD_UNITS, **other}


_PARTNER = ("q_other", "dq_other", "ddq_other")


def unit_of(program: Program, constants: Mapping[str, Unit], fields=FIELD_UNITS) -> Unit:
    """The unit of a program's value.

    Args:
        program: The tokens.
        constants: Unit of every constant.
        fields: Unit of every field.

    Raises:
        ValueError: If units are added that differ, or a function is taken of what is no pure number. An
            angle is one: sin(q) of a turning joint is sound.

    >>> unit_of(("q", "s", "/", "square", "neg", "exp", "dq", "*"), {"s": {"rad": 1}})
    {'rad': 1, 's': -1}
    """
    stack: list[Unit] = []
    for token in program:
        if token in BINARY:
            b, a = stack.pop(), stack.pop()
            stack.append(_joined(token, a, b))
        elif token in UNARY:
            stack.append(_of_function(token, stack.pop()))
        elif token == NUMBER:
            stack.append({})
        else:
            stack.append(fields[token] if token in fields else constants[token])
    return stack[0]


def _joined(token: str, a: Unit, b: Unit) -> Unit:
    if token == "*":
        return times(a, b)
    if token == "/":
        return over(a, b)
    if a != b and not {*a, *b} <= {"rad"}:  # the phase beside an angle is a pure number
        raise ValueError(f"{unit_text(a)} and {unit_text(b)} are added")
    return a or b


def _of_function(token: str, a: Unit) -> Unit:
    if token in FUNCTIONS:
        if not set(a) <= {"rad"}:
            raise ValueError(f"{token} of {unit_text(a)}, which is no pure number")
        return {}
    return times({}, a, {"square": 2, "cube": 3}.get(token, 1))
