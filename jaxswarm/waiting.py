"""Waiting for arrays so that a signal is heard: in compiled code nothing of Python runs until it has ended."""

import time
from typing import Any

import jax

# Time [s] between two looks at the beginning and later, so that short work is not held up by the looking.
_FIRST, _LAST = 1e-4, 0.05


def wait_for(tree: Any) -> Any:
    """Wait until all arrays of a tree are computed; an exception of a signal is raised in between.

    Returns:
        The tree.

    >>> wait_for({"x": jax.numpy.arange(2)})["x"].tolist()
    [0, 1]
    """
    pause = _FIRST
    arrays: list[Any] = [leaf for leaf in jax.tree.leaves(tree) if isinstance(leaf, jax.Array)]
    for array in arrays:
        while not array.is_ready():
            time.sleep(pause)
            pause = min(2.0 * pause, _LAST)
    return tree
