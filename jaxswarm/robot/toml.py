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
from jaxswarm.robot.build import build_robot, description_of
from jaxswarm.robot.checks import LARGEST, check_name, shown
from jaxswarm.robot.dh import robot_from_dh
from jaxswarm.robot.joints import DOWN, Description, Joint
from jaxswarm.robot.model import Robot
from jaxswarm.robot.placements import rotation_rpy
from jaxswarm.robot.xmltree import read_bytes

_TOP = ("name", "gravity", "drive_gain", "dh", "joint")
_DH = ("convention", "alpha", "a", "d", "theta", "kinds", "joints", "base_rpy", "parameters")
_JOINT = ("name", "kind", "parent", "xyz", "rpy", "axis", "parameters")
_ZEROS = [0.0, 0.0, 0.0]
# More than a turn between two joints [rad] is an angle in degrees: nobody writes 90 rad.
_TURN = 2.0 * np.pi + 1e-6


def read_toml(path: str | Path) -> Description:
    """Read what a TOML file says; see :func:`load_toml`."""
    return description_of(load_toml(path))


def load_toml(path: str | Path) -> Robot:
    """Read a robot from a TOML file as described at the head of this module.

    Raises:
        InputError: If the file cannot be read, does not parse, or describes no robot.
    """
    try:
        document = tomllib.loads(read_bytes(path).decode("utf-8"))
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: cannot be read as text ({error}): save it as UTF-8.") from error
    except RecursionError as error:
        raise InputError(f"{path}: its lists are nested too deep: no robot needs that.") from error
    except ValueError as error:  # of the syntax, or of an integer with thousands of digits
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: not valid TOML ({error}): correct the file.") from error
    try:
        return _robot(document, str(path))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _robot(document: dict[str, Any], path: str) -> Robot:
    inside = [key for key in document if key in _DH and key not in _TOP]
    if inside:
        raise InputError(f"top level: {inside[0]} belongs into [dh], beside alpha, a and d.")
    _check_keys(document, _TOP, "top level")
    if ("dh" in document) == ("joint" in document):
        raise InputError("give either a [dh] table or [[joint]] blocks, one of the two.")
    name = _text(document, "name", Path(path).stem, "top level")
    gravity = _numbers(document, "gravity", (3,), list(DOWN), "top level")
    gains = document.get("drive_gain")
    if gains is not None:
        gains = _numbers(document, "drive_gain", (None,), None, "top level")
    if "dh" in document:
        return _from_table(name, document["dh"], gravity, gains)
    blocks = document["joint"]
    if not isinstance(blocks, list) or not blocks:
        raise InputError(f"joint = {shown(blocks)}: a list of [[joint]] blocks is needed.")
    for k, block in enumerate(blocks):
        if not isinstance(block, dict) or "name" not in block:
            raise InputError(f"[[joint]] number {k + 1} has no name: give it one.")
        check_name(f"[[joint]] number {k + 1}", block["name"])
    before = ["base", *(block["name"] for block in blocks)]
    joints = [_joint(block, above) for block, above in zip(blocks, before, strict=False)]
    return build_robot(name, joints, gravity=gravity, drive_gain=gains)


def _from_table(name: str, table: Any, gravity, gains) -> Robot:
    if not isinstance(table, dict):
        raise InputError(f"dh = {shown(table)}: a table of columns is needed.")
    _check_keys(table, _DH, "[dh]")
    for column in ("convention", "alpha", "a", "d"):
        if column not in table:
            raise InputError(f"[dh] lacks {column}: convention, alpha, a and d are needed.")
    columns: dict[str, Any] = {
        c: _numbers(table, c, (None,), None, "[dh]") for c in ("alpha", "a", "d")
    }
    if "theta" in table:
        columns["theta"] = _numbers(table, "theta", (None,), None, "[dh]")
    for angle in ("alpha", "theta"):
        far = np.abs(columns.get(angle, np.zeros(0)))
        if far.size and far.max() > _TURN:
            raise InputError(
                f"[dh]: {angle} has {far.max():g}, more than a turn: angles are in rad, 90 deg is 1.5708."
            )
    if "parameters" in table:
        columns["parameters"] = _numbers(table, "parameters", (None, 10), None, "[dh]")
    if not len(columns["alpha"]):
        raise InputError("[dh]: alpha is empty: give one row for each joint.")
    for key in ("kinds", "joints"):
        values = table.get(key, [])
        if not isinstance(values, list) or not all(isinstance(v, str) for v in values):
            raise InputError(f"[dh]: {key} = {shown(values)}: a list of texts is needed.")
    return robot_from_dh(
        name,
        convention=_text(table, "convention", "", "[dh]"),
        **columns,
        kinds=table.get("kinds"),
        joints=table.get("joints"),
        base_rotation=rotation_rpy(_numbers(table, "base_rpy", (3,), _ZEROS, "[dh]")),
        gravity=gravity,
        drive_gain=gains,
    )


def _joint(block: dict[str, Any], before: str) -> Joint:
    place = f"joint {block['name']!r}"
    _check_keys(block, _JOINT, place)
    parent = _text(block, "parent", before, place)
    axis = block.get("axis", "z")
    if isinstance(axis, str):
        if axis not in ("x", "y", "z"):
            raise InputError(f"{place}: axis {shown(axis)}: use x, y, z or 3 numbers.")
        axis = np.eye(3)["xyz".index(axis)]
    else:
        axis = _numbers(block, "axis", (3,), None, place)
    return Joint(
        name=block["name"],
        kind=_text(block, "kind", "revolute", place),
        parent=None if parent == "base" else parent,
        rotation=rotation_rpy(_numbers(block, "rpy", (3,), _ZEROS, place)),
        translation=_numbers(block, "xyz", (3,), _ZEROS, place),
        axis=axis,
        parameters=_numbers(block, "parameters", (10,), [0.0] * 10, place),
    )


def _check_keys(table: dict, known: tuple[str, ...], place: str) -> None:
    for key in table:
        if key not in known:
            raise InputError(f"{place}: unknown key {shown(key)}. {nearest(key, known)}")


def _text(table: dict, key: str, default: str, place: str) -> str:
    """Return an entry that has to be text."""
    value = table.get(key, default)
    if not isinstance(value, str):
        raise InputError(f"{place}: {key} = {shown(value)} is no text: put it in quotes.")
    return value


def _numbers(table: dict, key: str, shape: tuple, default: list | None, place: str) -> np.ndarray:
    """Return an entry as a finite array of the given shape (None: any length)."""
    value = table.get(key, default)
    if not _fits(value, shape):
        size = " x ".join("n" if want is None else str(want) for want in shape)
        raise InputError(f"{place}: {key} = {shown(value)}: {size} finite numbers are needed.")
    return np.array(value, dtype=float).reshape([-1 if want is None else want for want in shape])


def _fits(value: Any, shape: tuple) -> bool:
    """Tell whether a value is a nest of lists of this shape, with numbers inside."""
    if not shape:
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        return is_number and abs(value) <= LARGEST  # false for NaN, too
    right = isinstance(value, list) and shape[0] in (None, len(value))
    return right and all(_fits(part, shape[1:]) for part in value)
