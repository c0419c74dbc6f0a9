"""A stack machine on arrays: thousands of postfix programs of one length evaluated at once under ``vmap``.

Programs are integers, so that another program is no other compiled code: per step an operation and the place
of its operand among variables or constants. Every lane holds a stack of a few rows that operations shift,
and all results of a step are computed and one of them chosen, as wide hardware wants it.
"""

from collections.abc import Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.postfix import BINARY, NUMBER, UNARY, Program

# Rows of the stack: what programs of the grammar need at most.
DEPTH = 4
_NOTHING, _VARIABLE, _CONSTANT = range(3)
_OPERATIONS = {name: 3 + k for k, name in enumerate((*BINARY, *UNARY))}
_FIRST_UNARY = 3 + len(BINARY)
# Lengths to which programs are filled up: one compiled program each.
LENGTHS = (4, 8, 12, 16, 24, 28)


class Codes(NamedTuple):
    """Programs of one length.

    Attributes:
        step: Operation of every step, (..., L).
        place: Row of the operand among variables or constants, (..., L).
    """

    step: np.ndarray
    place: np.ndarray


def stack_depth(program: Program) -> int:
    """Most operands that wait while a program runs.

    >>> stack_depth(("q", "s", "/", "dq", "*"))
    2
    """
    most = waiting = 0
    for token in program:
        waiting += 1 - (2 if token in BINARY else 1 if token in UNARY else 0)
        most = max(most, waiting)
    return most


def encode(
    programs: Sequence[Program],
    variables: Sequence[str],
    constants: Sequence[Sequence[str]],
    length: int,
) -> Codes:
    """Programs as integers, filled up to a length.

    Args:
        programs: The tokens.
        variables: Names of the rows of the data.
        constants: Names of each program's constants, in the order of their values; the number 2 stands
            behind the values, see :func:`run`.
        length: Steps.
    """
    step = np.zeros((len(programs), length), np.int32)
    place = np.zeros((len(programs), length), np.int32)
    rows = {name: k for k, name in enumerate(variables)}
    for i, (program, own) in enumerate(zip(programs, constants, strict=True)):
        for k, token in enumerate(program):
            if token in _OPERATIONS:
                step[i, k] = _OPERATIONS[token]
            elif token in rows:
                step[i, k], place[i, k] = _VARIABLE, rows[token]
            else:
                step[i, k] = _CONSTANT
                place[i, k] = -1 if token == NUMBER else own.index(token)
    return Codes(step, place)


def run(codes: Codes, constants: jax.Array, variables: jax.Array) -> jax.Array:
    """Value of one program along all rows.

    Args:
        codes: Of one program, (L,) each.
        constants: Values of its constants, filled up, (M,).
        variables: (V, T).

    Returns:
        (T,), of the precision of ``variables``.
    """
    variables = jnp.asarray(variables)
    constants = jnp.append(constants, 2.0).astype(variables.dtype)
    stack = (jnp.zeros_like(variables[0]),) * DEPTH

    def advance(stack, code):
        return _step(stack, code, constants, variables), None

    stack, _ = jax.lax.scan(advance, stack, codes)
    return stack[0]


def _step(stack, code: Codes, constants: jax.Array, variables: jax.Array):
    """One operation: push, or replace the top one or two rows by the result."""
    a, b = stack[1], stack[0]
    results = [f(jnp, a, b) for f in BINARY.values()] + [f(jnp, b) for f in UNARY.values()]
    top = jnp.where(code.step == _VARIABLE, variables[code.place], constants[code.place])
    for k, result in enumerate(results):
        top = jnp.where(code.step == 3 + k, result, top)
    top = jnp.where(code.step == _NOTHING, b, top)
    pushed = (code.step == _VARIABLE) | (code.step == _CONSTANT)
    taken = (code.step > _CONSTANT) & (code.step < _FIRST_UNARY)
    below = []
    for k in range(1, DEPTH):
        deeper = stack[min(k + 1, DEPTH - 1)]
        below.append(jnp.where(pushed, stack[k - 1], jnp.where(taken, deeper, stack[k])))
    return (top, *below)


run_many = jax.vmap(run, in_axes=(0, 0, None))


def length_for(count: int) -> int:
    """The length to which a program of so many tokens is filled up.

    >>> length_for(9)
    12
    """
    return next(length for length in LENGTHS if count <= length)
