"""An identified arm as URDF or MJCF, with a JSON side file for what the format cannot hold.

URDF holds mass, center of mass and inertia of each link, and damping and friction of each joint. MJCF
holds gravity as well, rotor inertia (armature) and a spring. Everything else (asymmetric or Stribeck
friction, ripple, elasticity, drive gains, ...) goes to the side file, so that nothing identified is
lost in silence. Links that no rigid body can be are refused: a simulator would reject them or, worse,
quietly change them.
"""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.identify.physical.consistency import check_physical
from jaxswarm.robot.model import Robot
from jaxswarm.robot.placements import inertia_matrix

_FREE = {"lower": "-1000", "upper": "1000", "effort": "1000000", "velocity": "1000"}


def export_urdf(robot: Robot, path: str | Path, effects: Iterable[Any] = ()) -> Path:
    """Write a robot and its effects as URDF, and a side file ``PATH.json`` beside it.

    Args:
        robot: Robot with physical link parameters.
        path: File to write.
        effects: Objects with ``effect``, ``joint``, ``other`` and ``values``, as in a model.

    Returns:
        Path of the side file.

    Raises:
        InputError: If a link is not physical or the file cannot be written.
    """
    check_physical(robot)
    root = xml.Element("robot", name=robot.name)
    xml.SubElement(root, "link", name="base")
    held, left = _split(effects, "urdf")
    for i, joint in enumerate(robot.joints):
        link = xml.SubElement(root, "link", name=f"{joint}_link")
        mass, center, inertia = _body(robot.parameters[i])
        inertial = xml.SubElement(link, "inertial")
        xml.SubElement(inertial, "origin", xyz=_text(center), rpy="0 0 0")
        xml.SubElement(inertial, "mass", value=_text([mass]))
        entries = {f"i{'xyz'[r]}{'xyz'[c]}": inertia[r, c] for r in range(3) for c in range(r, 3)}
        xml.SubElement(inertial, "inertia", {k: _text([v]) for k, v in entries.items()})
    for i, joint in enumerate(robot.joints):
        kind = "continuous" if robot.kinds[i] == "revolute" else "prismatic"
        element = xml.SubElement(root, "joint", name=joint, type=kind)
        rpy = _text(roll_pitch_yaw(robot.rotation[i]))
        xml.SubElement(element, "origin", xyz=_text(robot.translation[i]), rpy=rpy)
        parent = robot.parents[i]
        above = "base" if parent < 0 else f"{robot.joints[parent]}_link"
        xml.SubElement(element, "parent", link=above)
        xml.SubElement(element, "child", link=f"{joint}_link")
        xml.SubElement(element, "axis", xyz=_text(robot.axis[i]))
        if kind == "prismatic":
            xml.SubElement(element, "limit", _FREE)
        if held.get(i):
            xml.SubElement(element, "dynamics", {k: _text([v]) for k, v in held[i].items()})
    beside = {"gravity": np.asarray(robot.gravity).tolist()}
    return _write(root, Path(path), robot, left, beside)


def export_mjcf(robot: Robot, path: str | Path, effects: Iterable[Any] = ()) -> Path:
    """Write a robot and its effects as MJCF with one motor a joint, and a side file ``PATH.json``.

    Arguments, result and errors are those of :func:`export_urdf`.
    """
    check_physical(robot)
    root = xml.Element("mujoco", model=robot.name)
    xml.SubElement(root, "compiler", angle="radian", autolimits="true")
    xml.SubElement(root, "option", gravity=_text(robot.gravity), integrator="RK4")
    bodies = {-1: xml.SubElement(root, "worldbody")}
    motors = xml.SubElement(root, "actuator")
    held, left = _split(effects, "mjcf")
    for i, joint in enumerate(robot.joints):
        place = {"pos": _text(robot.translation[i]), "quat": _text(quaternion(robot.rotation[i]))}
        body = xml.SubElement(bodies[robot.parents[i]], "body", name=f"{joint}_link", **place)
        bodies[i] = body
        kind = "hinge" if robot.kinds[i] == "revolute" else "slide"
        more = {k: _text([v]) for k, v in held.get(i, {}).items()}
        xml.SubElement(body, "joint", name=joint, type=kind, axis=_text(robot.axis[i]), **more)
        mass, center, inertia = _body(robot.parameters[i])
        six = [inertia[r, c] for r, c in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        body_text = {"pos": _text(center), "mass": _text([mass]), "fullinertia": _text(six)}
        xml.SubElement(body, "inertial", body_text)
        xml.SubElement(motors, "motor", name=f"{joint}_motor", joint=joint)
    return _write(root, Path(path), robot, left, {})


def _split(effects: Iterable[Any], form: str) -> tuple[dict[int, dict[str, float]], list]:
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


def _write(root: xml.Element, path: Path, robot: Robot, left: list, beside: dict) -> Path:
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


def _body(parameters: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, center of mass and inertia about it."""
    mass, center = float(parameters[0]), np.asarray(parameters[1:4]) / float(parameters[0])
    shift = mass * (center @ center * np.eye(3) - np.outer(center, center))
    return mass, center, inertia_matrix(parameters) - shift


def roll_pitch_yaw(rotation: np.ndarray) -> np.ndarray:
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


def quaternion(rotation: np.ndarray) -> np.ndarray:
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


def _text(values: Iterable[float]) -> str:
    return " ".join(f"{float(value):.17g}" for value in values)
