"""Robots from URDF: joints, placements and, where given, inertias.

A link's frame is the frame of the joint that carries it; its inertial element holds the inertia
about the center of mass in axes of its own, which is moved to that frame. Fixed joints are lumped.
The file itself is read by ``urdf_parser_py``, the ROS project's own reader.
"""

from pathlib import Path

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.robot.model import STANDARD_GRAVITY, Joint, Robot, build_robot
from jaxswarm.robot.placements import body_parameters, move_parameters, rotation_rpy

_KINDS = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
}


def load_urdf(path: str | Path) -> Robot:
    """Read a robot from a URDF file.

    Raises:
        InputError: If the file cannot be read or does not describe a robot.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as text ({error}).") from error
    return robot_from_urdf(text, source=str(path))


def robot_from_urdf(
    text: str,
    *,
    source: str = "URDF",
    gravity: tuple[float, float, float] = (0.0, 0.0, -STANDARD_GRAVITY),
) -> Robot:
    """Build a robot from the text of a URDF file.

    Args:
        text: The XML.
        source: What error messages call it.
        gravity: Acceleration of free fall in base axes, in m/s^2; URDF does not hold it.

    Raises:
        InputError: If it does not parse, has joint types other than revolute, continuous, prismatic
            and fixed, has mimic joints, or is no tree.

    >>> xml = '''<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="continuous">
    ...   <parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>'''
    >>> robot_from_urdf(xml).joints
    ('j',)
    """
    description = _parse(text, source)
    links = {link.name: link for link in description.links}
    above: dict[str, str] = {}
    for joint in description.joints:
        for link in (joint.parent, joint.child):
            if link not in links:
                raise InputError(
                    f"{source}: joint {joint.name!r} names link {link!r}, which is not there: "
                    "add the link or correct the name."
                )
        if joint.child in above:
            raise InputError(
                f"{source}: link {joint.child!r} hangs on two joints, {above[joint.child]!r} and "
                f"{joint.name!r}: a tree is needed."
            )
        above[joint.child] = joint.name
    joints = [
        _joint(joint, above.get(joint.parent), links[joint.child], source)
        for joint in description.joints
    ]
    return build_robot(description.name or Path(source).stem, joints, gravity=gravity)


def _parse(text: str, source: str):
    try:
        from urdf_parser_py import urdf
        from urdf_parser_py.xml_reflection import core
    except ImportError as error:
        raise InputError(
            f"{source}: reading URDF needs the package urdf-parser-py: pip install urdf-parser-py."
        ) from error
    # The reader reports unknown tags (gazebo, sensors) by printing; they do not concern us.
    told, core.on_error = core.on_error, lambda message: None
    try:
        return urdf.URDF.from_xml_string(text.encode())
    except Exception as error:  # the reader raises whatever its XML layer raises
        reason = " ".join(str(error).split())
        raise InputError(f"{source}: not a readable URDF ({reason}): correct the file.") from error
    finally:
        core.on_error = told


def _joint(joint, parent: str | None, link, source: str) -> Joint:
    if joint.type not in _KINDS:
        raise InputError(
            f"{source}: joint {joint.name!r} is of type {joint.type!r}: "
            f"only {', '.join(_KINDS)} are supported."
        )
    if joint.mimic is not None:
        raise InputError(
            f"{source}: joint {joint.name!r} mimics {joint.mimic.joint!r}: coupled joints are not "
            "supported; make it fixed or free."
        )
    rotation, translation = _pose(joint.origin)
    axis = (1.0, 0.0, 0.0) if joint.axis is None else joint.axis  # the default of URDF
    return Joint(
        name=joint.name,
        kind=_KINDS[joint.type],
        parent=parent,
        rotation=rotation,
        translation=translation,
        axis=np.array(axis, dtype=float),
        parameters=_parameters(link.inertial),
    )


def _pose(origin) -> tuple[np.ndarray, np.ndarray]:
    if origin is None:
        return np.eye(3), np.zeros(3)
    rotation = np.eye(3) if origin.rpy is None else rotation_rpy(origin.rpy)
    translation = np.zeros(3) if origin.xyz is None else np.array(origin.xyz, dtype=float)
    return rotation, translation


def _parameters(inertial) -> np.ndarray:
    if inertial is None or inertial.mass is None:
        return np.zeros(10)
    tensor = np.zeros((3, 3)) if inertial.inertia is None else inertial.inertia.to_matrix()
    rotation, center = _pose(inertial.origin)
    about_center = body_parameters(float(inertial.mass), np.zeros(3), np.array(tensor, dtype=float))
    return move_parameters(about_center, rotation, center)
