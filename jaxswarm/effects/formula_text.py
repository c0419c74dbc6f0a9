"""Formulas as people read them: infix, LaTeX, Python."""

import re
from collections.abc import Callable, Mapping, Sequence

from jaxswarm.effects.postfix import BINARY, FIELDS, NOTHING, NUMBER, UNARY, Program

# How strongly the parts of an expression hold together: sum, product, prefix or power, atom.
_SUM, _PRODUCT, _POWER, _ATOM = range(4)
_LEVEL = {"+": _SUM, "-": _SUM, "*": _PRODUCT, "/": _PRODUCT}
PLAIN_FIELDS = {"direction": "sign(dq)", "static_load": "load0", "temperature": "T"}
_LATEX_FIELDS = {
    "t": "t",
    "q": "q",
    "dq": r"\dot q",
    "ddq": r"\ddot q",
    "direction": r"\operatorname{sign}(\dot q)",
    "load": r"\tau_{l}",
    "static_load": r"\tau_{l0}",
    "temperature": r"\vartheta",
    "q_other": r"q_{o}",
    "dq_other": r"\dot q_{o}",
    "ddq_other": r"\ddot q_{o}",
}
Part = tuple[str, int]


def infix(program: Program, names: Mapping[str, str] | None = None) -> str:
    """A program as one reads it; ``names`` are those of fields, by default short ones.

    >>> infix(("q", "s", "/", "square", "neg", "exp", "dq", "*"))
    'exp(-(q/s)^2)*dq'
    """
    told = {**PLAIN_FIELDS, **(names or {})}

    def unary(token: str, a: Part) -> Part:
        if token == "neg":
            return f"-{_held(a, _PRODUCT)}", _PRODUCT
        if token in ("square", "cube"):
            return f"{_held(a, _ATOM)}^{2 if token == 'square' else 3}", _POWER
        return (f"max({a[0]}, 0)" if token == "pos" else f"{token}({a[0]})"), _ATOM

    return _told(program, lambda n: (told.get(n, n), _ATOM), unary, _plain)


def latex(program: Program, names: Mapping[str, str] | None = None) -> str:
    r"""A program as LaTeX.

    >>> latex(("q", "s", "/", "square", "neg", "exp", "dq", "*"))
    'e^{-\\left(\\frac{q}{s}\\right)^{2}}\\,\\dot q'
    """
    told = {**_LATEX_FIELDS, **(names or {})}

    def leaf(name: str) -> Part:
        return told.get(name) or latex_name(name), _ATOM

    def unary(token: str, a: Part) -> Part:
        if token == "neg":
            return f"-{_held(a, _PRODUCT, True)}", _PRODUCT
        if token in ("square", "cube"):
            return f"{_held(a, _ATOM, True)}^{{{2 if token == 'square' else 3}}}", _POWER
        if token == "exp":
            return f"e^{{{a[0]}}}", _POWER
        if token == "abs":
            return rf"\left|{a[0]}\right|", _ATOM
        if token == "root":
            return rf"\sqrt{{{a[0]}}}", _ATOM
        if token == "pos":
            return rf"\max\left({a[0]},\,0\right)", _ATOM
        known = {"sat": r"\operatorname{sat}"}.get(token, "\\" + token)
        return rf"{known}\left({a[0]}\right)", _ATOM

    def binary(token: str, a: Part, b: Part) -> Part:
        if token == "/":
            return rf"\frac{{{a[0]}}}{{{b[0]}}}", _PRODUCT
        level = _LEVEL[token]
        right = _held(b, level + (token == "-"), True)
        between = r"\," if token == "*" else f" {token} "
        return _held(a, level, True) + between + right, level

    return _told(program, leaf, unary, binary)


def latex_name(name: str) -> str:
    """A constant's name with its number as index.

    >>> latex_name("k1"), latex_name("s")
    ('k_{1}', 's')
    """
    return re.sub(r"^([A-Za-z]+?)_?(\d+)$", r"\1_{\2}", name)


def python(program: Program) -> str:
    """A program as a Python expression of ``p`` (parameters), ``s`` (sample) and ``jnp``.

    >>> python(("q", "s", "/", "sin", "dq", "*"))
    'jnp.sin(s.q / p["s"]) * s.dq'
    """

    def leaf(name: str) -> Part:
        return (f"s.{name}" if name in FIELDS else f'p["{name}"]'), _ATOM

    def unary(token: str, a: Part) -> Part:
        if token == "neg":
            return f"-{_held(a, _POWER)}", _PRODUCT
        if token in ("square", "cube"):
            return f"{_held(a, _ATOM)} ** {2 if token == 'square' else 3}", _POWER
        if token == "sat":
            return f"jnp.clip({a[0]}, -1.0, 1.0)", _ATOM
        if token == "pos":
            return f"jnp.maximum({a[0]}, 0.0)", _ATOM
        if token == "root":
            return f"{_held(a, _POWER)} / jnp.sqrt(jnp.abs({a[0]}) + {NOTHING})", _PRODUCT
        return f"jnp.{token}({a[0]})", _ATOM

    def binary(token: str, a: Part, b: Part) -> Part:
        level = _LEVEL[token]
        right = _held(b, level + (token in "-/"))
        return f"{_held(a, level)} {token} {right}", level

    return _told(program, leaf, unary, binary)


def total(terms: Sequence[str], names: Sequence[str], product: str = "*") -> str:
    """Terms, each times its constant, as one sum.

    >>> total(["sin(q)", "dq + 2"], ["a", "b"])
    'a*sin(q) + b*(dq + 2)'
    """
    parts = []
    for term, name in zip(terms, names, strict=True):
        if term == "1":
            parts.append(name)
            continue
        parts.append(f"{name}{product}{term if _whole(term) else f'({term})'}")
    return " + ".join(parts)


def _whole(term: str) -> bool:
    """Whether no sum stands open in a term, and no sign leads it."""
    depth = 0
    for mark in term:
        depth += {"(": 1, "{": 1, "[": 1, ")": -1, "}": -1, "]": -1}.get(mark, 0)
        if depth == 0 and mark in "+-":
            return False
    return True


def _plain(token: str, a: Part, b: Part) -> Part:
    level = _LEVEL[token]
    right = _held(b, level + (token in "-/"))
    space = " " if level == _SUM else ""
    return f"{_held(a, level)}{space}{token}{space}{right}", level


def _held(part: Part, level: int, tex: bool = False) -> str:
    """A part, in parentheses where it would fall apart."""
    if part[1] >= level:
        return part[0]
    return rf"\left({part[0]}\right)" if tex else f"({part[0]})"


def _told(
    program: Program,
    leaf: Callable[[str], Part],
    unary: Callable[[str, Part], Part],
    binary: Callable[[str, Part, Part], Part],
) -> str:
    stack: list[Part] = []
    for token in program:
        if token in BINARY:
            b, a = stack.pop(), stack.pop()
            stack.append(binary(token, a, b))
        elif token in UNARY:
            stack.append(unary(token, stack.pop()))
        else:
            stack.append((NUMBER, _ATOM) if token == NUMBER else leaf(token))
    return stack[0][0]
