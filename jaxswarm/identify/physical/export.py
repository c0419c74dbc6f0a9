"""An identified arm as URDF, MJCF or SDF, with a JSON side file for what the format cannot hold.

URDF holds mass, center of mass and inertia of each link, and damping and friction of each joint. MJCF
holds gravity as well, rotor inertia (armature) and a spring; SDF these two, for Drake. Everything else
(asymmetric or Stribeck friction, ripple, elasticity, drive gains, ...) goes to the side file, so that nothing
identified is lost in silence. Links that no rigid body can be are refused: a simulator would reject them or,
worse, quietly change them.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np

from jaxswarm.effects.advice import SDF_DYNAMICS, SDF_OF_DRAKE
from jaxswarm.identify.physical.consistency import check_physical
from jaxswarm.identify.physical.export_parts import (
    numbers_text,
    quaternion,
    roll_pitch_yaw,
    split_effects,
    write_with_side_file,
)
from jaxswarm.robot.model import Robot
from jaxswarm.robot.placements import about_center

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
    held, left = split_effects(effects, "urdf")
    for i, joint in enumerate(robot.joints):
        link = xml.SubElement(root, "link", name=f"{joint}_link")
        mass, center, inertia = about_center(robot.parameters[i])
        inertial = xml.SubElement(link, "inertial")
        xml.SubElement(inertial, "origin", xyz=numbers_text(center), rpy="0 0 0")
        xml.SubElement(inertial, "mass", value=numbers_text([mass]))
        entries = {f"i{'xyz'[r]}{'xyz'[c]}": inertia[r, c] for r in range(3) for c in range(r, 3)}
        xml.SubElement(inertial, "inertia", {k: numbers_text([v]) for k, v in entries.items()})
    for i, joint in enumerate(robot.joints):
        kind = "continuous" if robot.kinds[i] == "revolute" else "prismatic"
        element = xml.SubElement(root, "joint", name=joint, type=kind)
        rpy = numbers_text(roll_pitch_yaw(robot.rotation[i]))
        xml.SubElement(element, "origin", xyz=numbers_text(robot.translation[i]), rpy=rpy)
        parent = robot.parents[i]
        above = "base" if parent < 0 else f"{robot.joints[parent]}_link"
        xml.SubElement(element, "parent", link=above)
        xml.SubElement(element, "child", link=f"{joint}_link")
        xml.SubElement(element, "axis", xyz=numbers_text(robot.axis[i]))
        if kind == "prismatic":
            xml.SubElement(element, "limit", _FREE)
        if held.get(i):
            xml.SubElement(element, "dynamics", {k: numbers_text([v]) for k, v in held[i].items()})
    beside = {"gravity": np.asarray(robot.gravity).tolist()}
    return write_with_side_file(root, Path(path), robot, left, beside)


def export_mjcf(robot: Robot, path: str | Path, effects: Iterable[Any] = ()) -> Path:
    """Write a robot and its effects as MJCF with one motor a joint, and a side file ``PATH.json``.

    Arguments, result and errors are those of :func:`export_urdf`.
    """
    check_physical(robot)
    root = xml.Element("mujoco", model=robot.name)
    xml.SubElement(root, "compiler", angle="radian", autolimits="true")
    xml.SubElement(root, "option", gravity=numbers_text(robot.gravity), integrator="RK4")
    bodies = {-1: xml.SubElement(root, "worldbody")}
    motors = xml.SubElement(root, "actuator")
    held, left = split_effects(effects, "mjcf")
    for i, joint in enumerate(robot.joints):
        place: dict[str, Any] = {
            "pos": numbers_text(robot.translation[i]),
            "quat": numbers_text(quaternion(robot.rotation[i])),
        }
        body = xml.SubElement(bodies[robot.parents[i]], "body", name=f"{joint}_link", **place)
        bodies[i] = body
        kind = "hinge" if robot.kinds[i] == "revolute" else "slide"
        more: dict[str, Any] = {k: numbers_text([v]) for k, v in held.get(i, {}).items()}
        xml.SubElement(
            body, "joint", name=joint, type=kind, axis=numbers_text(robot.axis[i]), **more
        )
        mass, center, inertia = about_center(robot.parameters[i])
        six = [inertia[r, c] for r, c in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        body_text = {
            "pos": numbers_text(center),
            "mass": numbers_text([mass]),
            "fullinertia": numbers_text(six),
        }
        xml.SubElement(body, "inertial", body_text)
        xml.SubElement(motors, "motor", name=f"{joint}_motor", joint=joint)
    return write_with_side_file(root, Path(path), robot, left, {})


def export_sdf(robot: Robot, path: str | Path, effects: Iterable[Any] = ()) -> Path:
    """Write a robot and its effects as SDF for Gazebo and Drake, and a side file ``PATH.json``.

    Rotor inertia stands in Drake's own element. Drake passes dry friction over, Gazebo rotor inertia.
    Arguments, result and errors are those of :func:`export_urdf`.
    """
    check_physical(robot)
    root = xml.Element("sdf", {"version": "1.7", "xmlns:drake": "http://drake.mit.edu"})
    model = xml.SubElement(root, "model", name=robot.name)
    held, left = split_effects(effects, "mjcf")
    for i, joint in enumerate(robot.joints):
        link = xml.SubElement(model, "link", name=f"{joint}_link")
        xml.SubElement(link, "pose", relative_to=joint).text = numbers_text(np.zeros(6))
        mass, center, inertia = about_center(robot.parameters[i])
        inertial = xml.SubElement(link, "inertial")
        xml.SubElement(inertial, "pose").text = numbers_text([*center, 0.0, 0.0, 0.0])
        xml.SubElement(inertial, "mass").text = numbers_text([mass])
        element = xml.SubElement(inertial, "inertia")
        for r, c in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
            xml.SubElement(element, f"i{'xyz'[r]}{'xyz'[c]}").text = numbers_text([inertia[r, c]])
    for i, joint in enumerate(robot.joints):
        element = xml.SubElement(model, "joint", name=joint, type=robot.kinds[i])
        parent = robot.parents[i]
        above = "__model__" if parent < 0 else f"{robot.joints[parent]}_link"
        place = [*np.asarray(robot.translation[i]), *roll_pitch_yaw(robot.rotation[i])]
        xml.SubElement(element, "pose", relative_to=above).text = numbers_text(place)
        xml.SubElement(element, "parent").text = "world" if parent < 0 else above
        xml.SubElement(element, "child").text = f"{joint}_link"
        axis = xml.SubElement(element, "axis")
        xml.SubElement(axis, "xyz").text = numbers_text(robot.axis[i])
        dynamics = xml.SubElement(axis, "dynamics")
        for name, value in held.get(i, {}).items():
            if name in SDF_DYNAMICS:
                xml.SubElement(dynamics, SDF_DYNAMICS[name]).text = numbers_text([value])
            else:
                xml.SubElement(element, SDF_OF_DRAKE[name]).text = numbers_text([value])
                xml.SubElement(element, "drake:gear_ratio").text = "1"
    beside = {"gravity": np.asarray(robot.gravity).tolist()}
    return write_with_side_file(root, Path(path), robot, left, beside)
