"""Logs spoiled as tables, before they are written: columns, names, clock, numbers, kinds, shapes."""

from collections.abc import Callable

import numpy as np

from benchmarks.trust.mutate_numbers import number, word

Table = dict[str, np.ndarray]
# Kinds of numbers, and what is none, that an array may hold instead.
_KINDS = (
    "int8",
    "uint16",
    "int64",
    "float16",
    "float32",
    "complex128",
    "bool",
    "U8",
    "S4",
    "datetime64[s]",
)
_SHAPES = ((0,), (1, -1), (-1, 1), (-1, 2), (1, 1, -1), ())


def spoil_table(rng: np.random.Generator, table: Table) -> Table:
    """A copy with one to three changes."""
    table = dict(table)
    for _ in range(1 + rng.binomial(2, 0.25)):
        if not table:
            return table
        change = _CHANGES[rng.integers(len(_CHANGES))]
        with np.errstate(all="ignore"):
            table = change(rng, table)
    return table


def spoil_kinds(rng: np.random.Generator, arrays: Table) -> Table:
    """A copy in which one array is of another kind or shape, or far larger."""
    arrays = dict(arrays)
    name = _name(rng, arrays)
    values = arrays[name]
    change = rng.integers(4)
    with np.errstate(all="ignore"):
        if change == 0:
            kind = _KINDS[rng.integers(len(_KINDS))]
            try:
                arrays[name] = np.asarray(values).astype(kind)
            except (TypeError, ValueError, OverflowError):
                arrays[name] = np.zeros(len(values), kind)
        elif change == 1:
            shape = _SHAPES[rng.integers(len(_SHAPES))]
            try:
                arrays[name] = np.asarray(values).reshape(shape)
            except ValueError:
                arrays[name] = np.zeros([max(k, 0) for k in shape])
        elif change == 2:
            # Zeros compress: megabytes in the file, gigabytes in memory.
            size = int(rng.choice([10**6, 10**7]))
            arrays[str(rng.choice([name, "unused", word(rng)]))] = np.zeros(size)
        else:
            arrays[name] = np.asarray(values, object)
    return arrays


def _name(rng: np.random.Generator, table: Table) -> str:
    return list(table)[rng.integers(len(table))]


def _numbers(values: np.ndarray) -> np.ndarray:
    """A copy as numbers; words become NaN."""
    if values.dtype != object:
        return np.array(values, float)
    return np.array([v if isinstance(v, float) else np.nan for v in values])


def _dropped(rng, table):
    gone = _name(rng, table)
    return {k: v for k, v in table.items() if k != gone}


def _renamed(rng, table):
    old, other = _name(rng, table), _name(rng, table)
    new = str(
        rng.choice(
            ["q1", "tau2", "q", "dq1", "ddq_joint1", "current_joint1", "time", "T", "q_ref_joint1"]
        )
    )
    new = (new, word(rng), other, old + word(rng), old.upper())[rng.integers(5)]
    return {(new if k == old else k): v for k, v in table.items()}


def _exchanged(rng, table):
    one, other = _name(rng, table), _name(rng, table)
    return {**table, one: table[other], other: table[one]}


def _cells(rng, table):
    name = _name(rng, table)
    values = _numbers(table[name])
    if not len(values):
        return table
    count = int(rng.choice([1, 1, 3, max(1, len(values) // 5), len(values)]))
    values[rng.integers(0, len(values), count)] = number(rng)
    return {**table, name: values}


def _words(rng, table):
    name = _name(rng, table)
    values = np.array(table[name], object)
    if len(values):
        values[rng.integers(len(values))] = word(rng)
    return {**table, name: values}


def _scaled(rng, table):
    name = _name(rng, table)
    factor = float(rng.choice([0.0, -1.0, 57.29577951308232, 1e3, 1e-3, 1e9, 1e-9, 1e200]))
    return {**table, name: _numbers(table[name]) * factor}


def _shifted(rng, table):
    name = _name(rng, table)
    return {**table, name: _numbers(table[name]) + number(rng)}


def _coarse(rng, table):
    name = _name(rng, table)
    step = 10.0 ** rng.uniform(-6, 1)
    return {**table, name: np.round(_numbers(table[name]) / step) * step}


def _held(rng, table):
    name = _name(rng, table)
    values = _numbers(table[name])
    if len(values):
        first, last = sorted(rng.integers(0, len(values), 2))
        values[first:last] = values[first]
    return {**table, name: values}


def _noise(rng, table):
    name = _name(rng, table)
    return {**table, name: rng.normal(size=len(table[name])) * 10.0 ** rng.uniform(-9, 6)}


def _cut(rng, table):
    length = int(rng.choice([0, 1, 2, 3, 5, 8, 13, 30, 60, 150]))
    return {k: v[:length] for k, v in table.items()}


def _uneven(rng, table):
    name = _name(rng, table)
    return {**table, name: table[name][: rng.integers(len(table[name]) + 1)]}


def _rows(rng, table):
    """Rows lost, doubled, shuffled or turned round."""
    length = min((len(v) for v in table.values()), default=0)
    if not length:
        return table
    order = np.arange(length)
    change = rng.integers(5)
    if change == 0:
        order = rng.permutation(length)
    elif change == 1:
        order = order[::-1]
    elif change == 2:
        order = np.sort(rng.integers(0, length, length))
    elif change == 3:
        order = np.repeat(order, 2)
    else:
        first, last = sorted(rng.integers(0, length, 2))
        order = np.delete(order, slice(first, last))
    return {k: v[order] for k, v in table.items()}


def _clock(rng, table):
    """Pauses, bursts, jumps back, another start, another unit, jitter, time closed up."""
    if "t" not in table or len(table["t"]) < 4:
        return table
    t = _numbers(table["t"])
    place = int(rng.integers(1, len(t)))
    change = rng.integers(8)
    if change == 0:
        t[place:] += float(rng.choice([0.05, 1.0, 10.0, 100.0, 500.0, 1e6, 1e15]))
    elif change == 1:
        t = t[0] + np.cumsum(np.where(np.arange(len(t)) % 5 == 0, 0.05, 1e-6))
    elif change == 2:
        t[place:] -= float(rng.choice([1e-9, 0.005, 1.0, 100.0]))
    elif change == 3:
        t += float(rng.choice([1.7e9, -5.0, 1e15]))
    elif change == 4:
        t *= float(rng.choice([1e-6, 1e-3, 2.0, 1e3, 1e6, 1e9, -1.0, 0.0]))
    elif change == 5:
        t += rng.normal(size=len(t)) * float(rng.choice([1e-4, 3e-3, 0.05]))
    elif change == 6:
        t = np.arange(len(t)) * np.median(np.diff(t))
    else:
        t[place] = t[place - 1]
    return {**table, "t": t}


_CHANGES: tuple[Callable[[np.random.Generator, Table], Table], ...] = (
    _dropped, _renamed, _exchanged, _cells, _cells, _words, _scaled, _shifted, _coarse, _held, _noise,
    _cut, _uneven, _rows, _clock, _clock,
)  # fmt: skip
