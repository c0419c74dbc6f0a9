"""Robots from TOML: a Denavit-Hartenberg table, or joints placed one in another.

name = "arm"                         # optional, default the file's name
gravity = [0, 0, -9.81]              # optional
drive_gain = [14.9, 13.3]            # optional, N m per unit of current, one for each joint

[dh]                                 # either: a table, one number a joint
convention = "modified"              # or "standard"
alpha = [0, 1.5708]
a = [0, 0.3]
d = [0.2, 0]
theta = [0, 0]                       # optional; also: kinds, joints, base_rpy

[[joint]]                            # or: one block a joint
name = "shoulder"
kind = "revolute"                    # or "prismatic", "fixed"; default revolute
parent = "base"                      # default: the joint before
xyz = [0, 0, 0.2]                    # default zeros
rpy = [0, 0, 0]                      # default zeros, fixed axes as in URDF
axis = "z"                           # or [0, 0, 1]; default z
parameters = [..10 numbers..]        # default zeros
"""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.robot.dh import robot_from_dh
from jaxswarm.robot.model import STANDARD_GRAVITY, Joint, Robot, build_robot
from jaxswarm.robot.placements import rotation_rpy

_TOP = ("name", "gravity", "drive_gain", "dh", "joint")
_DH = ("convention", "alpha", "a", "d", "theta", "kinds", "joints", "base_rpy", "parameters")
_JOINT = ("name", "kind", "parent", "xyz", "rpy", "axis", "parameters")


def load_toml(path: str | Path) -> Robot:
    """Read a robot from a TOML file as described at the head of this module.

    Raises:
        InputError: If the file cannot be read, does not parse, or describes no robot.
    """
    try:
        document = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as text ({error}).") from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not valid TOML ({error}): correct the file.") from error
    try:
        return _robot(document, str(path))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _robot(document: dict[str, Any], path: str) -> Robot:
    _check_keys(document, _TOP, "top level")
    if ("dh" in document) == ("joint" in document):
        raise InputError("give either a [dh] table or [[joint]] blocks, one of the two.")
    name = str(document.get("name", Path(path).stem))
    gravity = _numbers(document, "gravity", (3,), [0.0, 0.0, -STANDARD_GRAVITY])
    gains = document.get("drive_gain")
    if gains is not None:
        gains = _numbers(document, "drive_gain", (None,), None)
    if "dh" in document:
        return _from_table(name, document["dh"], gravity, gains)
    joints = document["joint"]
    if not isinstance(joints, list) or not joints:
        raise InputError("joint must be a list of [[joint]] blocks.")
    return build_robot(
        name,
        [_joint(block, k, joints) for k, block in enumerate(joints)],
        gravity=gravity,
        drive_gain=gains,
    )


def _from_table(name: str, table: Any, gravity, gains) -> Robot:
    if not isinstance(table, dict):
        raise InputError("dh must be a table of columns.")
    _check_keys(table, _DH, "[dh]")
    for column in ("convention", "alpha", "a", "d"):
        if column not in table:
            raise InputError(f"[dh] lacks {column}: convention, alpha, a and d are needed.")
    columns = {c: _numbers(table, c, (None,), None) for c in ("alpha", "a", "d")}
    if "theta" in table:
        columns["theta"] = _numbers(table, "theta", (None,), None)
    if "parameters" in table:
        columns["parameters"] = _numbers(table, "parameters", (None, 10), None)
    return robot_from_dh(
        name,
        convention=table["convention"],
        **columns,
        kinds=table.get("kinds"),
        joints=table.get("joints"),
        base_rotation=rotation_rpy(_numbers(table, "base_rpy", (3,), [0.0, 0.0, 0.0])),
        gravity=gravity,
        drive_gain=gains,
    )


def _joint(block: Any, index: int, blocks: list) -> Joint:
    if not isinstance(block, dict) or "name" not in block:
        raise InputError(f"[[joint]] number {index + 1} has no name: give it one.")
    _check_keys(block, _JOINT, f"joint {block['name']!r}")
    before = blocks[index - 1]["name"] if index else "base"
    parent = block.get("parent", before)
    axis = block.get("axis", "z")
    if isinstance(axis, str):
        if axis not in ("x", "y", "z"):
            raise InputError(f"joint {block['name']!r}: axis {axis!r}: use x, y, z or 3 numbers.")
        axis = np.eye(3)["xyz".index(axis)]
    else:
        axis = _numbers(block, "axis", (3,), None)
    return Joint(
        name=str(block["name"]),
        kind=block.get("kind", "revolute"),
        parent=None if parent == "base" else parent,
        rotation=rotation_rpy(_numbers(block, "rpy", (3,), [0.0, 0.0, 0.0])),
        translation=_numbers(block, "xyz", (3,), [0.0, 0.0, 0.0]),
        axis=axis,
        parameters=_numbers(block, "parameters", (10,), [0.0] * 10),
    )


def _check_keys(table: dict, known: tuple[str, ...], place: str) -> None:
    for key in table:
        if key not in known:
            raise InputError(f"{place}: unknown key {key!r}. {nearest(key, known)}")


def _numbers(table: dict, key: str, shape: tuple, default: list | None) -> np.ndarray:
    """Return an entry as a finite array of the given shape (None: any length)."""
    value = table.get(key, default)
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    fits = array.ndim == len(shape) and all(
        want in (None, have) for want, have in zip(shape, array.shape, strict=True)
    )
    if not fits or not np.isfinite(array).all():
        size = " x ".join("n" if want is None else str(want) for want in shape)
        raise InputError(f"{key} = {value!r}: {size} finite numbers are needed.")
    return array
