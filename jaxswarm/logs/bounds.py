"""How much of a file is read: what its headers declare is added up before anything is unpacked.

Compressed formats hold gigabytes in megabytes. What a log cannot need is never unpacked, and the rest has
to fit into a limit.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.names import QUANTITIES, looks_like

# Bytes of numbers read from one file: an hour of seven joints at 1 kHz with q, dq, ddq and tau takes 0.8 GB.
LARGEST_LOG = 2 * 2**30
_NUMBER = 8


def refuse_large(path: Path, needed: int) -> None:
    """Refuse a file whose numbers would not fit.

    Args:
        path: The file.
        needed: Bytes that its arrays would take as float64.

    Raises:
        InputError: With what it needs and the limit.
    """
    if needed > LARGEST_LOG:
        raise InputError(
            f"{path}: holds {needed / 2**30:.1f} GiB of numbers, at most {LARGEST_LOG / 2**30:.3g} GiB "
            "are read. Cut the log into shorter ones, or log at a lower rate"
        )


def needed_arrays(
    path: Path, shapes: Mapping[str, tuple[int, ...]], sizes: Mapping[str, int] | None = None
) -> tuple[set[str], dict[str, str]]:
    """Choose which arrays of a file to read.

    An array that is no quantity, and larger than the largest of these, can be no channel of the log; where
    there is none by its name, such as where they have other names, all are read.

    Args:
        path: For the message.
        shapes: Declared shape of every array.
        sizes: Bytes that arrays take as stored, where they may be more than their numbers as float64.

    Returns:
        Names to read, and name to note for the others.

    Raises:
        InputError: If those to read do not fit.
    """
    counts = {name: int(np.prod(shape, dtype=object)) for name, shape in shapes.items()}
    quantities = {n for n in shapes if n in (*QUANTITIES, "t", "joints") or looks_like(n)}
    measured = (counts[n] for n in quantities - {"t", "joints"})
    largest = max(measured, default=max(counts.values(), default=0))
    read = {name for name in shapes if name in quantities or counts[name] <= largest}
    notes = {
        name: f"{name} was left out: shape {shapes[name]} is neither (T,) nor (T, n)."
        for name in shapes
        if name not in read
    }
    sizes = sizes or {}
    refuse_large(path, sum(max(sizes.get(name, 0), _NUMBER * counts[name]) for name in read))
    return read, notes
