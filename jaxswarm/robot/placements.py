"""Numbers that place joints and move link parameters between frames (numpy, at build time).

A link's ten parameters are (m, m c, I) with I about the frame's origin. Seen from a frame in which
the old one has rotation R and origin p:

    m' = m,  (m c)' = R m c + m p,  I' = R I R^T + (2 p.h 1 - h p^T - p h^T) + m (p.p 1 - p p^T),

with h = R m c. Reference: J. Wittenburg, Dynamics of Multibody Systems, 2008, section 3.1.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike


def snap(array: np.ndarray) -> np.ndarray:
    """Return the array with entries within 1e-15 of -1, 0 or 1 set to them.

    A cosine of 90 degrees is 6e-17 in floating point; as an exact zero it drops out of the
    dynamics.
    """
    array = np.asarray(array, dtype=float)
    nearest = np.clip(np.round(array), -1.0, 1.0)
    return np.where(np.abs(array - nearest) < 1e-15, nearest, array) + 0.0


def rotation_x(angle: float) -> np.ndarray:
    """Return the rotation about x by an angle in rad, shape (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    return snap(np.array([[1, 0, 0], [0, c, -s], [0, s, c]]))


def rotation_y(angle: float) -> np.ndarray:
    """Return the rotation about y by an angle in rad, shape (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    return snap(np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]))


def rotation_z(angle: float) -> np.ndarray:
    """Return the rotation about z by an angle in rad, shape (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    return snap(np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]))


def rotation_rpy(rpy: Sequence[float] | np.ndarray) -> np.ndarray:
    """Return Rz(yaw) Ry(pitch) Rx(roll) for roll, pitch, yaw in rad (the convention of URDF).

    >>> rotation_rpy([0.0, 0.0, np.pi / 2]).astype(int).tolist()
    [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    """
    roll, pitch, yaw = (float(angle) for angle in rpy)
    return snap(rotation_z(yaw) @ rotation_y(pitch) @ rotation_x(roll))


def rotation_about(axis: np.ndarray, angle: float) -> np.ndarray:
    """Return the rotation by an angle in rad about a unit axis (3,), shape (3, 3)."""
    x, y, z = (float(v) for v in axis)
    turn = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return snap(np.eye(3) + np.sin(angle) * turn + (1.0 - np.cos(angle)) * (turn @ turn))


def rotation_quaternion(quaternion: np.ndarray) -> np.ndarray:
    """Return the rotation (3, 3) of a unit quaternion (w, x, y, z)."""
    w, x, y, z = (float(v) for v in quaternion)
    turn = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return snap(np.eye(3) + 2.0 * w * turn + 2.0 * (turn @ turn))


def inertia_matrix(parameters: ArrayLike) -> np.ndarray:
    """Return the (3, 3) inertia of ten link parameters, about the frame's origin, in kg m^2."""
    xx, xy, yy, xz, yz, zz = np.asarray(parameters, dtype=float)[4:]
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def pack_parameters(mass: float, first_moment: np.ndarray, inertia: np.ndarray) -> np.ndarray:
    """Return the ten link parameters of a mass, a first moment (3,) and an inertia (3, 3).

    Args:
        mass: In kg.
        first_moment: Mass times center of mass, in kg m.
        inertia: About the frame's origin, in kg m^2.
    """
    i = np.asarray(inertia, dtype=float)
    six = [i[0, 0], i[0, 1], i[1, 1], i[0, 2], i[1, 2], i[2, 2]]
    return np.concatenate([[float(mass)], np.asarray(first_moment, dtype=float), six])


def body_parameters(mass: float, center: np.ndarray, inertia: np.ndarray) -> np.ndarray:
    """Return the ten link parameters from the inertia about the center of mass.

    >>> body_parameters(2.0, [0.0, 0.0, 0.5], np.eye(3)).tolist()
    [2.0, 0.0, 0.0, 1.0, 1.5, 0.0, 1.5, 0.0, 0.0, 1.0]
    """
    c = np.asarray(center, dtype=float)
    return pack_parameters(mass, mass * c, inertia + mass * (c @ c * np.eye(3) - np.outer(c, c)))


def move_parameters(
    parameters: np.ndarray, rotation: np.ndarray, translation: np.ndarray
) -> np.ndarray:
    """Return link parameters (10,) seen from the frame in which theirs has this pose."""
    mass = float(parameters[0])
    h = rotation @ np.asarray(parameters[1:4], dtype=float)
    p = np.asarray(translation, dtype=float)
    inertia = rotation @ inertia_matrix(parameters) @ rotation.T
    inertia = inertia + 2.0 * (p @ h) * np.eye(3) - np.outer(h, p) - np.outer(p, h)
    inertia = inertia + mass * (p @ p * np.eye(3) - np.outer(p, p))
    return pack_parameters(mass, h + mass * p, inertia)


def about_center(parameters: ArrayLike) -> tuple[float, np.ndarray, np.ndarray]:
    """Return mass, center of mass (3,) and inertia about it (3, 3) of ten link parameters.

    >>> about_center(body_parameters(2.0, [0.0, 0.0, 0.5], np.eye(3)))[1].tolist()
    [0.0, 0.0, 0.5]
    """
    ten = np.asarray(parameters, dtype=float)
    mass = float(ten[0])
    center = ten[1:4] / mass
    shift = mass * (center @ center * np.eye(3) - np.outer(center, center))
    return mass, center, inertia_matrix(ten) - shift
