"""Shapes of URDF links as capsules: boxes, cylinders, spheres and capsules that they cover.

Meshes are not read. A link of which one shape is a mesh has none here: half of a link is no link.
"""

from itertools import permutations
from xml.etree.ElementTree import Element

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.robot.joints import Capsule
from jaxswarm.robot.placements import rotation_rpy
from jaxswarm.robot.xmltree import numbers


def link_shapes(link: Element) -> tuple[Capsule, ...]:
    """Return capsules in the link's frame: of what it collides with, else of how it looks.

    Dynamics do without them, so that a damaged shape is none.
    """
    elements = link.findall("collision") or link.findall("visual")
    try:
        found = [_shape(element) for element in elements]
    except InputError:
        return ()
    return tuple(found)


def _shape(element: Element) -> Capsule:
    geometry = element.find("geometry")
    shape = None if geometry is None or len(geometry) == 0 else geometry[0]
    if shape is None or shape.tag not in _COVERS:
        raise InputError("only boxes, cylinders, spheres and capsules are covered")
    half, radius = _COVERS[shape.tag](shape)
    origin = element.find("origin")
    rotation = rotation_rpy(numbers(origin, "rpy", 3, (0.0, 0.0, 0.0), "shape"))
    place = numbers(origin, "xyz", 3, (0.0, 0.0, 0.0), "shape")
    along = rotation @ half
    return Capsule(place - along, place + along, radius)


def _length(shape: Element, name: str) -> float:
    value = float(numbers(shape, name, 1, None, "shape")[0])
    if value < 0.0:
        raise InputError(f"{name} = {value:g} is below zero")
    return value


def _round(shape: Element) -> tuple[np.ndarray, float]:
    """A cylinder, or a capsule: both have their length along z."""
    return np.array([0.0, 0.0, 0.5 * _length(shape, "length")]), _length(shape, "radius")


def _sphere(shape: Element) -> tuple[np.ndarray, float]:
    return np.zeros(3), _length(shape, "radius")


def _box(shape: Element) -> tuple[np.ndarray, float]:
    """Along the longest side, as thick as the diagonal of the other two."""
    half = 0.5 * np.abs(numbers(shape, "size", 3, None, "shape"))
    along, one, two = max(permutations(range(3)), key=lambda order: half[order[0]])
    return np.eye(3)[along] * half[along], float(np.hypot(half[one], half[two]))


_COVERS = {"box": _box, "cylinder": _round, "capsule": _round, "sphere": _sphere}
