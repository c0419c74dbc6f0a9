r"""Postfix programs: torques written as data, so that a law can be searched for, stored and read back.

A program is a sequence of tokens: fields of a :class:`Sample`, names of constants, the number 2, and
operations that take their operands from a stack. ``q s / square neg exp`` is :math:`e^{-(q/s)^2}`. A program
is evaluated token by token, never compiled from text: what a file holds can say a torque and do nothing else.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

# Fields of a sample that a program may read; a law's memory is none of them.
FIELDS = (
    "t",
    "q",
    "dq",
    "ddq",
    "direction",
    "load",
    "static_load",
    "temperature",
    "q_other",
    "dq_other",
    "ddq_other",
)
# What a root adds to its argument: far below any angle that is logged.
NOTHING = 1e-12
BINARY: dict[str, Callable] = {
    "+": lambda xp, a, b: a + b,
    "-": lambda xp, a, b: a - b,
    "*": lambda xp, a, b: a * b,
    "/": lambda xp, a, b: a / b,
}
UNARY: dict[str, Callable] = {
    "neg": lambda xp, a: -a,
    "square": lambda xp, a: a * a,
    "cube": lambda xp, a: a * a * a,
    "sin": lambda xp, a: xp.sin(a),
    "cos": lambda xp, a: xp.cos(a),
    "exp": lambda xp, a: xp.exp(a),
    "abs": lambda xp, a: xp.abs(a),
    "tanh": lambda xp, a: xp.tanh(a),
    "sat": lambda xp, a: xp.clip(a, -1.0, 1.0),
    "pos": lambda xp, a: xp.maximum(a, 0.0),
    # It keeps the sign, and has a slope at zero, where buffers and slack cables rest.
    "root": lambda xp, a: a / xp.sqrt(xp.abs(a) + NOTHING),
}
# Functions whose argument has to be a pure number.
FUNCTIONS = ("sin", "cos", "exp", "tanh", "sat", "root")
NUMBER = "2"
WORDS = {*FIELDS, *BINARY, *UNARY, NUMBER}
# Operands that wait at most, and tokens of a program: bounds of what a file may hold.
MOST_WAITING, MOST_TOKENS = 6, 64

Program = tuple[str, ...]


def check_program(program: Sequence[str], constants: Sequence[str]) -> None:
    """Refuse what is no program.

    Args:
        program: The tokens.
        constants: Names of the constants it may use.

    Raises:
        ValueError: Naming the token, or how many operands are left.

    >>> check_program(("q", "s", "/", "sin"), ["s"])
    """
    if not 0 < len(program) <= MOST_TOKENS:
        raise ValueError(f"a program has 1 to {MOST_TOKENS} tokens, this one {len(program)}")
    waiting = 0
    for token in program:
        if not isinstance(token, str) or (token not in WORDS and token not in constants):
            raise ValueError(f"unknown token {token!r} in a program")
        taken = 2 if token in BINARY else 1 if token in UNARY else 0
        if waiting < taken:
            raise ValueError(f"{token!r} finds no operand in {' '.join(map(str, program))}")
        waiting += 1 - taken
        if waiting > MOST_WAITING:
            raise ValueError(f"more than {MOST_WAITING} operands wait in {' '.join(program)}")
    if waiting != 1:
        raise ValueError(f"{waiting} results are left of {' '.join(program)}, not one")


def evaluate(program: Program, known: Callable[[str], Any] | Mapping[str, Any], xp) -> Any:
    """The value of a program.

    Args:
        program: Tokens, see :func:`check_program`.
        known: Value of every field and constant by its name.
        xp: ``numpy`` or ``jax.numpy``.

    >>> import numpy as np
    >>> float(evaluate(("q", "2", "*", "square"), {"q": 1.5}, np))
    9.0
    """
    value = known if callable(known) else known.__getitem__
    stack: list = []
    for token in program:
        if token in BINARY:
            b, a = stack.pop(), stack.pop()
            stack.append(BINARY[token](xp, a, b))
        elif token in UNARY:
            stack.append(UNARY[token](xp, stack.pop()))
        else:
            stack.append(2.0 if token == NUMBER else value(token))
    return stack[0]


def fields_of(program: Program) -> tuple[str, ...]:
    """Fields that a program reads, in the order of :data:`FIELDS`."""
    return tuple(name for name in FIELDS if name in program)


def constants_of(program: Program) -> tuple[str, ...]:
    """Constants of a program, in the order in which they appear."""
    return tuple(dict.fromkeys(token for token in program if token not in WORDS))
