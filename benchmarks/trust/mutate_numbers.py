"""Numbers, words and names that programs stumble over."""

import numpy as np

NUMBERS = (
    *(0.0, -0.0, 1.0, -1.0, 1e-320, 1e-12, 1e9, 1e15, 1e154, 1e308, -1e308),
    *(float("nan"), float("inf"), -float("inf"), 2.0**53 + 2, 1.7e9, 6.283185307179586),
)
INTEGERS = (0, 1, -1, 2**31, 2**63, -(2**63) - 1, 10**70, 10**400, 7, 300, 100_000)
WORDS = (
    *("", " ", "nan", "inf", "-inf", "1e308", "1e999", "-1", "0", "0 0 0", "1 2", "nan 0 0", "a"),
    *(
        "9" * 70,
        "9" * 5000,
        "0x10",
        "1_0",
        "1,5",
        "\u0663",
        "true",
        "null",
        "None",
        "--",
        "<>&",
        "${x}",
    ),
    *("\x1b[31mred", "a\x00b", "a\nb", "\u202eabc", "[/b]", "$x_{$", "=1+1", "../../etc/passwd"),
    *(
        "x" * 3000,
        "\ud800",
        "joint1",
        "joint2",
        "q_joint1",
        "fixed",
        "floating",
        "t",
        "base",
        "%s%n{0}",
    ),
)


def number(rng: np.random.Generator) -> float:
    """An odd number, or one of any size."""
    if rng.random() < 0.7:
        return float(NUMBERS[rng.integers(len(NUMBERS))])
    return float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-12, 12))


def word(rng: np.random.Generator) -> str:
    """An odd word."""
    return WORDS[rng.integers(len(WORDS))]


def value(rng: np.random.Generator, depth: int = 0):
    """An odd value of a document: number, text, list, table, truth or nothing."""
    kind = rng.integers(8 if depth < 3 else 5)
    if kind == 0:
        return number(rng)
    if kind == 1:
        return INTEGERS[rng.integers(len(INTEGERS))]
    if kind == 2:
        return word(rng)
    if kind == 3:
        return bool(rng.integers(2))
    if kind == 4:
        return None
    if kind == 5:
        return [value(rng, depth + 1) for _ in range(rng.integers(4))]
    if kind == 6:
        return [number(rng)] * int(rng.choice([1, 3, 9, 10]))
    return {word(rng): value(rng, depth + 1) for _ in range(rng.integers(3))}
