"""Which column is what: from the names in a file to arrays in the robot's order of joints.

A name is ``t``, ``<quantity>_<joint>``, or the short ``<quantity><k>`` with k counting the robot's
joints from 1; an array (T, n) is named by the quantity alone. The longest joint name that ends a
column wins, so ``q_link_joint1`` is the channel ``q_link`` of ``joint1``. Nothing is guessed:
names that are nearly right are offered in the message (:mod:`jaxswarm.logs.names`), and the user
mends the file.
"""

from dataclasses import dataclass, field

import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.logs.names import QUANTITIES, expected_columns, looks_like, offer, place
from jaxswarm.logs.table import Table


@dataclass(frozen=True, eq=False)
class Arranged:
    """Columns by quantity, in the robot's order.

    Attributes:
        t: Time, shape (T,).
        joint: Quantity or channel to (T, n), NaN where a joint has no such channel.
        shared: Channel without a joint to (T,).
        labels: (quantity, joint index) to the name the user knows the column by.
        notes: Sentences about columns that were left out.
    """

    t: np.ndarray
    joint: dict[str, np.ndarray]
    shared: dict[str, np.ndarray]
    labels: dict[tuple[str, int], str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def arrange(table: Table, joints: tuple[str, ...]) -> Arranged:
    """Sort the columns of a table by quantity and joint.

    Args:
        table: Columns of shape (T,) and arrays of shape (T, n).
        joints: The robot's joint names, n of them.

    Returns:
        The arrays; ``q`` is complete, and so is every other quantity that is given at all.

    Raises:
        InputError: If ``t`` or ``q`` is missing, a quantity is given for some joints only, a name
            belongs to no joint of the robot, a shape does not fit, or a needed column holds text.
    """
    notes = _left_out(table, joints)
    time = _time(table)
    order = _order(table, joints)
    joint: dict[str, np.ndarray] = {}
    shared: dict[str, np.ndarray] = {}
    labels: dict[tuple[str, int], str] = {}
    strange = []

    def name_once(quantity: str, index: int, label: str) -> None:
        if (quantity, index) in labels:
            raise InputError(
                f"{table.source}: {labels[quantity, index]} and {label} both give {quantity} of "
                f"{joints[index]}. Keep one of them."
            )
        labels[quantity, index] = label

    for name, values in table.columns.items():
        if name == "t":
            continue
        quantity, index = place(name, joints)
        per_joint = values.ndim == 2 and values.shape == (len(time), len(joints))
        if index is not None:
            column = _vector(table, name, values, len(time))
            name_once(quantity, index, name)
            if quantity not in joint:
                joint[quantity] = np.full((len(time), len(joints)), np.nan)
            joint[quantity][:, index] = column
        elif name in QUANTITIES or per_joint:
            matrix = _matrix(table, name, values, len(time), joints)
            if order != sorted(order):
                matrix = matrix[:, order]
            for k in range(len(joints)):
                label = name if len(joints) == 1 else f"{name}[:, {order[k]}] ({joints[k]})"
                name_once(name, k, label)
            joint[name] = matrix  # whole, without a copy: no other column may belong to it
        elif values.ndim == 1 and "q" not in table.columns and looks_like(name):
            strange.append(name)
        elif values.shape in ((len(time),), (len(time), 1)):
            shared[name] = values.reshape(-1)
        else:
            notes.append(f"{name} was left out: shape {values.shape} is neither (T,) nor (T, n).")
    _complete(table, joints, labels, strange, shared)
    for name in set(shared) & set(joint):
        raise InputError(
            f"{table.source}: {name} is given with and without a joint. Rename one of them."
        )
    return Arranged(time, joint, shared, labels, tuple(notes))


def _left_out(table: Table, joints: tuple[str, ...]) -> list[str]:
    """Notes about columns that are no numbers; a needed one is refused."""
    notes = []
    for name, reason in table.rejected.items():
        if name == "t" or place(name, joints)[0] in QUANTITIES or looks_like(name):
            raise InputError(f"{table.source}: {reason} Every sample needs a number there.")
        notes.append(f"{name} was left out: {reason}")
    return notes


def _time(table: Table) -> np.ndarray:
    if "t" not in table.columns:
        raise InputError(
            f"{table.source}: missing column t, the time in seconds."
            + offer("t", None, 0, table.columns)
            + f" Found: {_listing(table.columns)}."
        )
    time = table.columns["t"]
    if time.ndim == 0 or time.size != max(time.shape):
        raise InputError(
            f"{table.source}: t has shape {time.shape}, expected (T,). Give one time per sample."
        )
    return time.reshape(-1)


def _order(table: Table, joints: tuple[str, ...]) -> list[int]:
    """For each joint of the robot, its column in the arrays of the file."""
    if table.joints is None:
        return list(range(len(joints)))
    if len(table.joints) != len(joints):
        raise InputError(
            f"{table.source}: the log has {len(table.joints)} joints ({', '.join(table.joints)}), "
            f"the robot has {len(joints)} ({', '.join(joints)}). Choose the robot of this log, or "
            "keep its joints only."
        )
    for name in table.joints:
        if name not in joints:
            raise InputError(
                f"{table.source}: joints names {name}, which the robot does not have. "
                f"{nearest(name, joints)} Rename it, or leave joints out if the columns are in the "
                "robot's order (--columns q=q reads them so)."
            )
        if table.joints.count(name) > 1:
            raise InputError(f"{table.source}: joints names {name} twice. Name every joint once.")
    return [table.joints.index(name) for name in joints]


def _vector(table: Table, name: str, values: np.ndarray, length: int) -> np.ndarray:
    if values.shape not in ((length,), (length, 1)):
        raise InputError(
            f"{table.source}: {name} has shape {values.shape}, t has {length} samples. Give one "
            "value per sample."
        )
    return values.reshape(-1)


def _matrix(
    table: Table, name: str, values: np.ndarray, length: int, joints: tuple[str, ...]
) -> np.ndarray:
    width = len(joints)
    if values.shape == (length, width) or (width == 1 and values.shape == (length,)):
        return values.reshape(length, width)
    start = f"{table.source}: {name} has shape {values.shape}, expected (T, n) = {(length, width)}."
    if values.shape == (width, length):
        raise InputError(f"{start} Transpose it: one row per sample.")
    if values.ndim == 2 and values.shape[0] == length:
        raise InputError(
            f"{start} The log has {values.shape[1]} joints, the robot {width} "
            f"({', '.join(joints)}). Choose the robot of this log, or keep its joints only."
        )
    raise InputError(f"{start} Give one row per sample of t and one column per joint.")


def _complete(
    table: Table,
    joints: tuple[str, ...],
    labels: dict[tuple[str, int], str],
    strange: list[str],
    shared: dict[str, np.ndarray],
) -> None:
    """Refuse a log without q, with half a quantity, or with columns of joints the robot lacks."""
    given = {quantity for quantity, _ in labels if quantity in QUANTITIES} | {"q"}
    missing = [
        (quantity, index)
        for quantity in QUANTITIES
        for index in range(len(joints))
        if quantity in given and (quantity, index) not in labels
    ]
    if not missing and not strange:
        return
    others = [
        *strange,
        *shared,
        *(name.split("[:")[0] for (kind, _), name in labels.items() if kind not in QUANTITIES),
    ]
    count = sum(kind == "q" for kind, _ in labels) + sum(name.startswith("q") for name in strange)
    counts = ""
    if count not in (0, len(joints)):
        counts = (
            f" The log has positions of {count} joint{'s' * (count != 1)}, the robot has "
            f"{len(joints)} ({', '.join(joints)})."
        )
    if not missing:
        verb = "belongs" if len(strange) == 1 else "belong"
        known = [expected for kind in QUANTITIES for expected in expected_columns(kind, joints)]
        remedy = (
            "Choose the robot of this log, or remove these columns."
            if counts
            else f"{nearest(strange[0], known)} A channel of a joint is named CHANNEL_JOINT."
        )
        raise InputError(
            f"{table.source}: {_listing(strange)} {verb} to no joint of the robot.{counts} {remedy}"
        )
    names = [f"{quantity}_{joints[index]}" for quantity, index in missing]
    quantity, index = missing[0]
    raise InputError(
        f"{table.source}: missing column{'s' * (len(names) > 1)} {_listing(names)}.{counts}"
        + offer(quantity, joints[index], index + 1, others)
        + f" Found: {_listing(table.columns)}."
    )


def _listing(names, limit: int = 12) -> str:
    names = list(names)
    return ", ".join(names[:limit]) + (
        f" and {len(names) - limit} more" if len(names) > limit else ""
    )
