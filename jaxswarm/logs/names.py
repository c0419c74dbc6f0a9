"""The names of columns: what they mean, and which wrong name was probably meant to be which.

``q_joint1`` and the short ``q1`` are read; ``Position_1`` is not, but the message about the missing
``q_joint1`` offers it.
"""

import difflib
import re
from collections.abc import Iterable

QUANTITIES = ("q", "dq", "ddq", "tau", "current")
_SHORT = re.compile(r"(q|dq|ddq|tau|current)([0-9]{1,3})")
# What other tools call these, in lower case without separators; used in messages only.
_ALIASES = {
    "t": (
        "t",
        "time",
        "times",
        "timestamp",
        "timestamps",
        "stamp",
        "seconds",
        "sec",
        "ts",
        "times",
    ),
    "q": ("q", "pos", "position", "angle", "theta", "qpos", "actualq"),
    "dq": ("dq", "qd", "vel", "velocity", "speed", "qvel", "qdot", "actualqd"),
    "ddq": ("ddq", "qdd", "acc", "acceleration", "qddot"),
    "tau": ("tau", "torque", "effort", "force", "trq"),
    "current": ("current", "i", "cur", "curr", "actualcurrent"),
}


def place(name: str, joints: tuple[str, ...]) -> tuple[str, int | None]:
    """Split a column name into its quantity or channel and the index of its joint (None: no joint).

    >>> place("q_link_joint2", ("joint1", "joint2"))
    ('q_link', 1)
    >>> place("tau2", ("shoulder", "elbow"))
    ('tau', 1)
    >>> place("ambient", ("joint1", "joint2"))
    ('ambient', None)
    """
    for joint in sorted(joints, key=len, reverse=True):
        if name.endswith(f"_{joint}") and len(name) > len(joint) + 1:
            return name[: -len(joint) - 1], joints.index(joint)
    short = _SHORT.fullmatch(name)
    if short and 1 <= int(short[2]) <= len(joints):
        return short[1], int(short[2]) - 1
    return name, None


def looks_like(name: str) -> bool:
    """Whether a name has the form of a quantity of some joint, known or not.

    >>> looks_like("q_joint7"), looks_like("tau9"), looks_like("temperature_joint7")
    (True, True, False)
    """
    return bool(_SHORT.fullmatch(name)) or name.split("_")[0] in QUANTITIES


def expected_columns(quantity: str, joints: tuple[str, ...]) -> tuple[str, ...]:
    """Full names of the columns of a quantity.

    >>> expected_columns("q", ("joint1", "joint2"))
    ('q_joint1', 'q_joint2')
    """
    return tuple(f"{quantity}_{joint}" for joint in joints)


def offer(quantity: str, joint: str | None, number: int, candidates: Iterable[str]) -> str:
    """A sentence that offers the candidates that may stand for a missing column, or an empty
    string.

    Args:
        quantity: The missing quantity, or ``"t"``.
        joint: Its joint, or None for a column without one.
        number: Number of the joint, from 1.
        candidates: Names in the file that are not used otherwise.

    >>> offer("q", "joint2", 2, ["Position_2", "tau_joint1"])
    ' Did you mean Position_2? Rename it to q_joint2, or pass --columns q_joint2=Position_2.'
    """
    candidates = list(candidates)
    missing = quantity if joint is None else f"{quantity}_{joint}"
    endings = [""] if joint is None else [_plain(joint), str(number)]
    wanted = {alias + ending for alias in _ALIASES[quantity] for ending in endings}
    matches = [name for name in candidates if _plain(re.sub(r"[\[(].*", "", name)) in wanted]
    if not matches and joint is not None:
        matches = difflib.get_close_matches(missing, candidates, n=2, cutoff=0.75)
    if not matches and joint is not None:
        matches = [name for name in candidates if _plain(name) in _ALIASES[quantity]]
        missing = quantity
    if not matches:
        return ""
    matches = list(dict.fromkeys(matches))[:2]
    mapped = f", or pass --columns {missing}={matches[0]}"
    listable = len(matches) == 1 and re.fullmatch(r"[^\s,:=]+", matches[0])
    return (
        f" Did you mean {' or '.join(matches)}? Rename it to {missing}{mapped if listable else ''}."
    )


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())
