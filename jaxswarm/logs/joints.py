"""Names of the joints that a file seems to hold, for looking at a log before a robot is chosen."""

import re
from pathlib import Path

from jaxswarm.errors import InputError
from jaxswarm.logs.read import read_table
from jaxswarm.logs.reading import LogChoice, reading_of
from jaxswarm.logs.rename import as_ours, joints_of_pattern
from jaxswarm.logs.table import Table

_SHORT = re.compile(r"q([0-9]{1,3})")


def joints_in(path: str | Path | LogChoice) -> tuple[str, ...]:
    """Joints whose positions a file holds, in its own order.

    Raises:
        InputError: If the file cannot be read, needs a robot to be read, or names no positions.
    """
    reading = reading_of(path)
    table = read_table(Path(path), None, reading)
    found = joints_of_pattern(table.columns, reading)
    return found or joints_of(as_ours(table, table.joints or (), reading))


def joints_of(table: Table) -> tuple[str, ...]:
    """Joints of a table: its own names, the columns of an array ``q``, ``q_NAME``, or ``q1``, ``q2``...

    >>> import numpy as np
    >>> x = np.zeros(3)
    >>> joints_of(Table("log.csv", {"t": x, "q_a": x, "q_link_a": x, "q_b": x, "tau_a": x}))
    ('a', 'b')
    """
    if table.joints is not None:
        return table.joints
    q = table.columns.get("q")
    if q is not None:
        return tuple(f"joint{k + 1}" for k in range(q.shape[1] if q.ndim == 2 else 1))
    short = [name for name in table.columns if _SHORT.fullmatch(name)]
    if short:
        return tuple(f"joint{k + 1}" for k in range(len(short)))
    names = [name[2:] for name in table.columns if name.startswith("q_")]
    # A channel such as q_link_a is one of joint a, not a joint named link_a.
    names = [n for n in names if not any(n.endswith(f"_{other}") for other in names)]
    if not names:
        raise InputError(
            f"{table.source}: no positions found; expected columns q_<joint> or an array q. Found: "
            f"{', '.join(list(table.columns)[:12])}. Give --robot to have the names checked."
        )
    return tuple(names)
