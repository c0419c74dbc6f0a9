"""Robots from URDF: joints, placements, limits and, where given, inertias.

A link's frame is the frame of the joint that carries it; its inertial element holds the inertia
about the center of mass in axes of its own, which is moved to that frame. What does not concern
dynamics (looks, sensors, transmissions, tags of simulators) is passed over, whatever it holds, and told
in a note. The format is described at http://wiki.ros.org/urdf/XML.
"""

from collections import Counter
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.robot.build import build_description
from jaxswarm.robot.checks import SHORTEST_AXIS, shown
from jaxswarm.robot.joints import DOWN, Description, Joint, Limits, Mimic
from jaxswarm.robot.model import Robot
from jaxswarm.robot.options import RobotOptions, apply_options
from jaxswarm.robot.placements import body_parameters, move_parameters, rotation_rpy
from jaxswarm.robot.urdf_shapes import link_shapes
from jaxswarm.robot.xacro import refuse_xacro
from jaxswarm.robot.xmltree import attribute, numbers, parse_xml, read_bytes

_KINDS = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
    "floating": "floating",
    "planar": "planar",
}
# What there is no need to tell that it was passed over: it says how a robot looks or what it may collide with.
_LOOKS = ("material", "visual", "collision")
# Moments of inertia may miss the triangle inequality by rounding.
_TRIANGLE = 1e-6


def read_urdf(path: str | Path) -> Description:
    """Read what a URDF file says.

    Raises:
        InputError: If the file cannot be read or does not describe a robot.
    """
    return describe_urdf(read_bytes(path), str(path))


def load_urdf(path: str | Path) -> Robot:
    """Read a robot from a URDF file, mimicking joints locked.

    Raises:
        InputError: If the file cannot be read or does not describe a robot.
    """
    return robot_from_urdf(read_bytes(path), source=str(path))


def robot_from_urdf(
    text: str | bytes,
    *,
    source: str = "URDF",
    gravity: tuple[float, float, float] = DOWN,
) -> Robot:
    """Build a robot from the text of a URDF file, mimicking joints locked.

    Args:
        text: The XML.
        source: What error messages call it.
        gravity: Acceleration of free fall in base axes, in m/s^2; URDF does not hold it.

    Raises:
        InputError: If it does not parse, has floating or planar joints, or is no tree.

    >>> xml = '''<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="continuous">
    ...   <parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>'''
    >>> robot_from_urdf(xml).joints
    ('j',)
    """
    options = RobotOptions(gravity=tuple(gravity))
    try:
        return build_description(apply_options(describe_urdf(text, source), options))
    except InputError as error:
        raise InputError(str(error) if source in str(error) else f"{source}: {error}") from error


def describe_urdf(text: str | bytes, source: str) -> Description:
    """Return what the text of a URDF file says; see :func:`robot_from_urdf`."""
    root = parse_xml(text, source)
    if root.tag != "robot":
        raise InputError(f"{source}: its root is <{root.tag}>: a URDF starts with <robot>.")
    refuse_xacro(root, source)
    links = _links(root, source)
    elements = [element for element in root if element.tag == "joint"]
    above: dict[str, str] = {}
    ends = [_ends(k, element, links, above, source) for k, element in enumerate(elements)]
    roots = [link for link in links if link not in above]
    if len(roots) > 1:
        raise InputError(
            f"{source}: the links {', '.join(map(shown, roots[:5]))} hang on no joint: one link is the "
            "base, join or delete the others."
        )
    notes: list[str] = _passed_over(root)
    joints = tuple(
        _joint(element, name, above.get(parent), links[child], notes, source)
        for element, (name, parent, child) in zip(elements, ends, strict=True)
    )
    for link in roots:  # the base has no dynamics; what it says has to be sound all the same
        _parameters(links[link], notes, source)
    shapes = tuple(shape for link in roots for shape in link_shapes(links[link]))
    name = root.get("name") or Path(source).stem
    return Description(name, joints, notes=tuple(notes), base_shapes=shapes)


def _links(root: Element, source: str) -> dict[str, Element]:
    links: dict[str, Element] = {}
    for k, element in enumerate(e for e in root if e.tag == "link"):
        name = attribute(element, "name", f"{source}: link number {k + 1}")
        if name in links:
            raise InputError(f"{source}: link name {shown(name)} occurs twice: rename one.")
        links[name] = element
    return links


def _ends(k: int, element: Element, links, above: dict[str, str], source: str):
    """Return a joint's name, parent link and child link, and record whom the child hangs on."""
    name = attribute(element, "name", f"{source}: joint number {k + 1}")
    place = f"{source}: joint {shown(name)}"
    ends = []
    for tag in ("parent", "child"):
        end = element.find(tag)
        if end is None:
            raise InputError(f"{place} has no <{tag}>: name the link.")
        link = attribute(end, "link", place)
        if link not in links:
            raise InputError(
                f"{place} names link {shown(link)}, which is not there: add the link or correct the name."
            )
        ends.append(link)
    parent, child = ends
    if child in above:
        raise InputError(
            f"{source}: link {shown(child)} hangs on two joints, {shown(above[child])} and "
            f"{shown(name)}: a tree is needed."
        )
    above[child] = name
    return name, parent, child


def _passed_over(root: Element) -> list[str]:
    """Return a note on the elements that were not read."""
    tags = Counter(e.tag for e in root if e.tag not in ("link", "joint", *_LOOKS))
    return [f"not read: {', '.join(f'{n} <{tag}>' for tag, n in tags.items())}"] if tags else []


def _joint(element: Element, name: str, parent: str | None, link: Element, notes, source) -> Joint:
    place = f"{source}: joint {shown(name)}"
    kind = attribute(element, "type", place)
    if kind not in _KINDS:
        raise InputError(f"{place} is of type {shown(kind)}: {', '.join(_KINDS)} are known.")
    rotation, translation = _pose(element.find("origin"), place)
    # URDF's default axis is x. A fixed joint needs none, and some files give it zeros.
    axis = numbers(element.find("axis"), "xyz", 3, (1.0, 0.0, 0.0), place)
    if kind != "fixed" and np.linalg.norm(axis) < SHORTEST_AXIS:
        raise InputError(f"{place}: axis xyz = {axis.tolist()} is no direction: give one.")
    followed, mimic = element.find("mimic"), None
    if followed is not None:
        factor, offset = (
            float(numbers(followed, key, 1, (default,), place)[0])
            for key, default in (("multiplier", 1.0), ("offset", 0.0))
        )
        mimic = Mimic(attribute(followed, "joint", place), factor, offset)
    return Joint(
        name=name,
        kind=_KINDS[kind],
        parent=parent,
        rotation=rotation,
        translation=translation,
        axis=axis,
        parameters=_parameters(link, notes, source),
        limits=_limits(element.find("limit"), kind, place, notes),
        mimic=mimic,
        shapes=link_shapes(link),
    )


def _limits(element: Element | None, kind: str, place: str, notes: list[str]) -> Limits:
    """Return the limits; dynamics do without them, so that damaged ones end in a note."""
    if element is None:
        return Limits()
    keys = ("velocity", "effort") if kind == "continuous" else Limits._fields
    try:
        values = {
            key: float(numbers(element, key, 1, None, place)[0])
            for key in keys
            if key in element.attrib
        }
    except InputError as error:
        notes.append(f"limits not read: {error}")
        return Limits()
    return Limits(**values)


def _pose(origin: Element | None, place: str) -> tuple[np.ndarray, np.ndarray]:
    rpy = numbers(origin, "rpy", 3, (0.0, 0.0, 0.0), place)
    return rotation_rpy(rpy), numbers(origin, "xyz", 3, (0.0, 0.0, 0.0), place)


def _parameters(link: Element, notes: list[str], source: str) -> np.ndarray:
    name = link.get("name")
    inertial = link.find("inertial")
    if inertial is None or inertial.find("mass") is None:
        return np.zeros(10)
    place = f"{source}: link {shown(name)}"
    mass = float(numbers(inertial.find("mass"), "value", 1, None, place)[0])
    if mass < 0.0:
        raise InputError(f"{place}: mass value = {mass:g} kg is below zero: correct it.")
    tensor, element = np.zeros((3, 3)), inertial.find("inertia")
    if element is not None:
        for r, c in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
            key = f"i{'xyz'[r]}{'xyz'[c]}"
            tensor[r, c] = tensor[c, r] = numbers(element, key, 1, (0.0,), place)[0]
    rotation, center = _pose(inertial.find("origin"), place)
    moments = np.linalg.eigvalsh(tensor)
    if moments[0] < 0.0 or moments[0] + moments[1] < (1.0 - _TRIANGLE) * moments[2]:
        listed = ", ".join(f"{m:.4g}" for m in moments)
        notes.append(
            f"link {shown(name)} has principal moments {listed} kg m^2: no body can have them"
        )
    return move_parameters(body_parameters(mass, np.zeros(3), tensor), rotation, center)
