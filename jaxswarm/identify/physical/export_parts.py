"""What the exports of an arm share: numbers as text, bodies about their centers, angles, the side file."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np
from numpy.typing import ArrayLike

from jaxswarm.errors import InputError
from jaxswarm.robot.model import Robot


def split_effects(effects: Iterable[Any], form: str) -> tuple[dict[int, dict[str, float]], list]:
    """Return joint attributes the format holds, and the effects it does not."""
    held: dict[int, dict[str, float]] = {}
    left = []
    for effect in effects:
        export = next((e for e in effect.law.export if e.format == form), None)
        if export is None or not export.holds(effect.values):
            left.append(effect)
            continue
        own = export.attributes(effect.values)
        attributes = held.setdefault(effect.joint, {})
        if not export.adds and set(own) & set(attributes):
            left.append(effect)
            continue
        for name, value in own.items():
            attributes[name] = attributes.get(name, 0.0) + float(value)
    return held, left


def write_with_side_file(
    root: xml.Element, path: Path, robot: Robot, left: list, beside: dict
) -> Path:
    """Write a document, and ``PATH.json`` with the effects that are left and what else stands beside.

    Raises:
        InputError: If a file cannot be written.
    """
    gains = [None if np.isnan(gain) else float(gain) for gain in np.asarray(robot.drive_gain)]
    content = {
        "file": path.name,
        "not_in_file": [
            {
                "effect": e.effect,
                "joint": None if e.joint is None else robot.joints[e.joint],
                "other": None if e.other is None else robot.joints[e.other],
                "values": {name: float(value) for name, value in e.values.items()},
                "law": e.law.summary,
            }
            for e in left
        ],
        "drive_gain": gains,
        **beside,
    }
    side = path.with_name(path.name + ".json")
    xml.indent(root)
    try:
        path.write_bytes(xml.tostring(root, encoding="utf-8") + b"\n")
        side.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error}).") from error
    return side


def roll_pitch_yaw(rotation: ArrayLike) -> np.ndarray:
    """Return fixed-axis angles (3,) in rad of a rotation (3, 3), also where pitch is 90 degrees.

    >>> roll_pitch_yaw(np.eye(3)).tolist()
    [0.0, 0.0, 0.0]
    """
    r = np.asarray(rotation, float)
    across = np.hypot(r[0, 0], r[1, 0])
    pitch = np.arctan2(-r[2, 0], across)
    if across < 1e-12:  # yaw and roll turn about the same line: put all of it into roll
        return np.array([np.arctan2(-r[1, 2], r[1, 1]), pitch, 0.0])
    return np.array([np.arctan2(r[2, 1], r[2, 2]), pitch, np.arctan2(r[1, 0], r[0, 0])]) + 0.0


def quaternion(rotation: ArrayLike) -> np.ndarray:
    """Return the unit quaternion (w, x, y, z) of a rotation (3, 3).

    The eigenvector of largest eigenvalue of a symmetric 4 x 4 matrix (Bar-Itzhack 2000): exact for
    every rotation, half turns included.

    >>> quaternion(np.eye(3)).round(9).tolist()
    [1.0, 0.0, 0.0, 0.0]
    """
    r = np.asarray(rotation, float)
    k = np.empty((4, 4))
    k[1:, 1:] = r + r.T - np.trace(r) * np.eye(3)
    k[0, 0] = np.trace(r)
    k[0, 1:] = k[1:, 0] = [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]
    q = np.linalg.eigh(k)[1][:, -1]
    return (q if q[0] >= 0.0 else -q) + 0.0


def numbers_text(values: Iterable[float]) -> str:
    """Numbers parted by blanks, with all their digits."""
    return " ".join(f"{float(value):.17g}" for value in values)
