"""Limits of a robot's motion, from a TOML file: what ``jaxswarm excite`` has to keep.

fundamental = 0.1                    # optional, Hz; the motion repeats after 1 / fundamental
harmonics = 5                        # optional, at least 2
rate = 250                           # optional, Hz; samples of the written trajectory
distance = 0.02                      # optional, m; links that are no neighbors stay this far apart; below
                                     # zero where their covers are thicker than they are
radius = 0.06                        # optional, m; of links without shapes: segments from joint to joint

[joint1]                             # one table for every joint of the robot
position = [-2.0, 2.0]               # rad, or m for a prismatic joint
velocity = 1.5                       # rad/s or m/s, either way
acceleration = 4.0                   # rad/s^2 or m/s^2, either way
effort = 60                          # optional, N m or N, either way; else as the robot file says
"""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jaxswarm.documents import read_document
from jaxswarm.errors import InputError, nearest

_JOINT = ("position", "velocity", "acceleration")
_MORE = ("effort",)
_OPTIONS = ("fundamental", "harmonics", "rate", "radius")
_MOST_HARMONICS = 50
_HUGE = 1e9


@dataclass(frozen=True)
class Limits:
    """What a motion may do, per joint, and how it is built.

    Attributes:
        lower, upper: Positions [rad or m], shape (n,).
        velocity: Largest speed [rad/s or m/s], shape (n,).
        acceleration: Largest acceleration [rad/s^2 or m/s^2], shape (n,).
        fundamental: Frequency of the period [Hz]; None: chosen from the duration.
        harmonics: Number of harmonics, at least 2.
        rate: Samples per second of the written trajectory [Hz].
        effort: Largest torque or force [N m or N], shape (n,), NaN where none is given; None: nowhere.
        distance: Least distance of the covers of links that are no neighbors [m]; None: not given.
        radius: Of links without shapes [m]; None: not given.
        smaller: Whether a search may make a motion smaller than positions, speeds and accelerations ask.
    """

    lower: np.ndarray
    upper: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    fundamental: float | None = None
    harmonics: int = 5
    rate: float = 250.0
    effort: np.ndarray | None = None
    distance: float | None = None
    radius: float | None = None
    smaller: bool = False


def read_limits(path: str | Path, joints: tuple[str, ...]) -> Limits:
    """Read a limits file as described at the head of this module.

    Args:
        path: The TOML file.
        joints: The joints of the robot, each of which needs a table.

    Raises:
        InputError: If the file cannot be read or parsed, lacks a joint, names one the robot has not,
            or holds a limit that leaves no room to move.
    """
    path = Path(path)
    try:
        document = tomllib.loads(read_document(path))
    except FileNotFoundError:
        raise InputError(f"limits file {path} does not exist: correct the path.") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as text ({error}).") from None
    except InputError:
        raise
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not valid TOML ({error}): correct the file.") from None
    try:
        return parse_limits(document, joints)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def parse_limits(document: dict[str, Any], joints: tuple[str, ...]) -> Limits:
    """Limits from the content of a limits file.

    >>> slide = {"position": [0, 0.2], "velocity": 0.5, "acceleration": 2}
    >>> parse_limits({"slide": slide, "rate": 100}, ("slide",)).rate
    100.0
    """
    for key in document:
        if key not in joints and key not in (*_OPTIONS, "distance"):
            kind = "joint" if isinstance(document[key], dict) else "key"
            known = (*joints, *_OPTIONS, "distance")
            raise InputError(f"unknown {kind} {key!r}. {nearest(key, known)}")
    missing = [joint for joint in joints if joint not in document]
    if missing:
        raise InputError(
            f"no limits for {', '.join(missing)}: give every joint a table, [{missing[0]}], with "
            "position, velocity and acceleration."
        )
    rows = [_joint(joint, document[joint]) for joint in joints]
    lower, upper, velocity, acceleration, effort = (np.array(x) for x in zip(*rows, strict=True))
    chosen: dict[str, Any] = {
        k: _positive("the file", k, document[k]) for k in _OPTIONS if k in document
    }
    if "distance" in document:
        chosen["distance"] = _number("the file", "distance", document["distance"])
    limits = Limits(lower, upper, velocity, acceleration, effort=effort, **chosen)
    if limits.harmonics != int(limits.harmonics) or not 2 <= limits.harmonics <= _MOST_HARMONICS:
        raise InputError(
            f"harmonics = {limits.harmonics:g}: a whole number from 2 to {_MOST_HARMONICS} is needed; "
            "one harmonic cannot start at rest."
        )
    return Limits(**{**vars(limits), "harmonics": int(limits.harmonics)})


def _joint(joint: str, table: Any) -> tuple[float, float, float, float, float]:
    if not isinstance(table, dict):
        raise InputError(f"{joint} = {table!r}: a table [{joint}] is needed.")
    for key in table:
        if key not in (*_JOINT, *_MORE):
            raise InputError(f"{joint}: unknown key {key!r}. {nearest(key, (*_JOINT, *_MORE))}")
    for key in _JOINT:
        if key not in table:
            raise InputError(f"{joint}: {key} is missing; give position, velocity, acceleration.")
    pair = table["position"]
    if not isinstance(pair, list) or len(pair) != 2 or not all(map(_is_number, pair)):
        raise InputError(f"{joint}: position = {pair!r}: two finite numbers [lower, upper] needed.")
    if not pair[0] < pair[1]:
        raise InputError(
            f"{joint}: position = {pair}: the lower limit must lie below the upper; swap or widen them."
        )
    velocity, acceleration = (_positive(joint, key, table[key]) for key in _JOINT[1:])
    effort = _positive(joint, "effort", table["effort"]) if "effort" in table else np.nan
    return float(pair[0]), float(pair[1]), velocity, acceleration, effort


def _positive(place: str, key: str, value: Any) -> float:
    if not _is_number(value) or not value > 0:
        raise InputError(f"{place}: {key} = {value!r}: a finite number above zero is needed.")
    return float(value)


def _number(place: str, key: str, value: Any) -> float:
    if not _is_number(value):
        raise InputError(f"{place}: {key} = {value!r}: a finite number is needed.")
    return float(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and -_HUGE < value < _HUGE
