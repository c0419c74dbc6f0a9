"""What single elements of SDF hold: numbers, poses, the inertia of a link."""

from xml.etree.ElementTree import Element

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.robot.checks import LARGEST, shown
from jaxswarm.robot.placements import (
    body_parameters,
    move_parameters,
    rotation_quaternion,
    rotation_rpy,
)

Pose = tuple[np.ndarray, np.ndarray]


def link_parameters(link: Element, notes: list[str], place: str) -> np.ndarray:
    """Inertial parameters of a link in its own frame; SDF's own values where it gives none."""
    inertial = link.find("inertial")
    if inertial is None:
        notes.append(
            f"{place.rpartition(': ')[2]} has no inertia: SDF means 1 kg, here it has none"
        )
        return np.zeros(10)
    given = inertial.find("mass")
    mass = 1.0 if given is None else float(numbers_in(given, 1, f"{place}: mass")[0])
    if mass < 0.0:
        raise InputError(f"{place}: mass = {mass:g} kg is below zero: correct it.")
    tensor, element = np.eye(3), inertial.find("inertia")
    if element is not None:
        for r, c in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
            entry = element.find(f"i{'xyz'[r]}{'xyz'[c]}")
            if entry is not None:
                tensor[r, c] = tensor[c, r] = numbers_in(entry, 1, f"{place}: inertia")[0]
    pose = pose_in(inertial.find("pose"), place)
    return move_parameters(body_parameters(mass, np.zeros(3), tensor), *pose)


def pose_in(element: Element | None, place: str) -> Pose:
    """The pose that an element holds: position, then angles or a quaternion (x, y, z, w)."""
    if element is None or not (element.text or "").strip():
        return np.eye(3), np.zeros(3)
    if element.get("rotation_format") == "quat_xyzw":
        values = numbers_in(element, 7, f"{place}: pose")
        length = np.linalg.norm(values[3:])
        if not length > 0.0:
            raise InputError(f"{place}: pose has the quaternion 0 0 0 0: give a rotation.")
        return rotation_quaternion(values[[6, 3, 4, 5]] / length), values[:3]
    values = numbers_in(element, 6, f"{place}: pose")
    degrees = element.get("degrees") in ("1", "true")
    return rotation_rpy(np.deg2rad(values[3:]) if degrees else values[3:]), values[:3]


def numbers_in(element: Element, count: int, place: str, most: float = LARGEST) -> np.ndarray:
    """The numbers in the text of an element, shape (count,).

    Raises:
        InputError: If it holds anything but ``count`` numbers up to ``most``.
    """
    text = element.text or ""
    try:
        if "_" in text:  # Python reads 1_0 as ten
            raise ValueError
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.array([])
    if values.shape != (count,) or not (np.abs(values) <= most).all():
        raise InputError(f"{place} = {shown(text.strip())}: {count} finite numbers are needed.")
    return values
