"""The built-in robots: published kinematics as numbers.

Link parameters are zero, because they are what one identifies, except for the RX60, whose paper
prints values. References: ``rx60`` the papers' three-link Staubli RX60; ``tx40`` Janot, Vandanjon,
Gautier, IEEE TCST 22(1), 2014; ``ur10e`` Mamedov and Mikhel, Front. Robot. AI 7:571574, 2020;
``emps`` Janot, Gautier, Brunot, Workshop on Nonlinear System Identification Benchmarks, 2019;
``kuka_kr300`` Weigand et al., nonlinearbenchmark.org, 2022.
"""

from collections.abc import Callable

import numpy as np

from jaxswarm.robot.build import build_robot
from jaxswarm.robot.dh import robot_from_dh
from jaxswarm.robot.joints import Joint
from jaxswarm.robot.model import Robot
from jaxswarm.robot.placements import body_parameters, move_parameters, rotation_rpy, rotation_x

RIGHT = np.pi / 2


def rx60() -> Robot:
    """Return the first three links of the Staubli RX60, with the parameters its paper prints.

    >>> rx60().joints
    ('joint1', 'joint2', 'joint3')
    """
    return robot_from_dh(
        "rx60",
        convention="modified",
        alpha=[0.0, RIGHT, 0.0],
        a=[0.0, 0.0, 0.29],
        d=[0.237, 0.0, 0.049],
        parameters=rx60_paper_parameters(),
    )


def rx60_paper_parameters() -> np.ndarray:
    """Return the RX60 paper's thirteen "true" values as link parameters, shape (3, 10).

    The paper's inertia of a link is [[A, -F, -E], [-F, B, -D], [-E, -D, C]] about the link frame;
    masses and first moments are not among its parameters, so gravity has no effect. F3 has the sign
    of the column of true values. Link 3 violates abs(A - B) <= C: no rigid body has these values.
    """
    links = np.zeros((3, 10))
    czz1 = 5.0091
    links[0, 9] = czz1
    for link, (a, b, c, d, e, f) in (
        (1, (1.279, 2.4129, 5.0991, -0.0405, -0.0498, 0.2143)),
        (2, (0.2394, 1.3125, 0.5472, 0.0057, -0.0066, -0.4939)),
    ):
        links[link, 4:] = (a, -f, b, -e, -d, c)
    return links


def tx40() -> Robot:
    """Return the six joints of the Staubli TX40."""
    return robot_from_dh(
        "tx40",
        convention="modified",
        alpha=[0.0, -RIGHT, 0.0, RIGHT, -RIGHT, RIGHT],
        a=[0.0, 0.0, 0.225, 0.0, 0.0, 0.0],
        d=[0.32, 0.0, 0.035, 0.225, 0.0, 0.0],
        theta=[0.0, 0.0, 0.0, 0.0, 0.0, np.pi],
    )


def ur10e() -> Robot:
    """Return the Universal Robots UR10e; drive gains in N m/A as quoted from De Luca's group.

    The authors' own estimate is 10.0, 10.6956, 8.4566, 9.0029, 9.48, 10.1232: unloaded motion
    cannot decide between the two scales.
    """
    places = (
        ((0.0, 0.0, 0.181), 0.0, "z"),
        ((0.0, 0.176, 0.0), RIGHT, "y"),
        ((0.0, -0.137, 0.613), 0.0, "y"),
        ((0.0, 0.0, 0.571), RIGHT, "y"),
        ((0.0, 0.135, 0.0), 0.0, "z"),
        ((0.0, 0.0, 0.12), 0.0, "y"),
    )
    return build_robot(
        "ur10e",
        [
            Joint(
                name=f"joint{j + 1}",
                parent=f"joint{j}" if j else None,
                rotation=rotation_rpy([0.0, pitch, 0.0]),
                translation=np.array(xyz),
                axis=np.eye(3)["xyz".index(axis)],
            )
            for j, (xyz, pitch, axis) in enumerate(places)
        ],
        drive_gain=[14.87, 13.26, 11.13, 10.62, 11.03, 11.47],
    )


def emps() -> Robot:
    """Return the electro-mechanical positioning system: one horizontal slide, drive gain in N/V.

    >>> emps().kinds
    ('prismatic',)
    """
    slide = Joint("slide", kind="prismatic", axis=np.array([1.0, 0.0, 0.0]))
    return build_robot("emps", [slide], drive_gain=[35.15065188248547])


_KUKA_ALPHA = (RIGHT, 0.0, -RIGHT, RIGHT, -RIGHT, np.pi)
_KUKA_A = (0.35, 1.15, 0.041, 0.0, 0.0, 0.0)
_KUKA_D = (-0.675, -0.189, 0.189, -1.0, 0.0, -0.24)


def kuka_kr300() -> Robot:
    """Return the KUKA KR300 R2500 ultra, whose table starts from an upside-down base frame."""
    return robot_from_dh(
        "kuka_kr300",
        convention="standard",
        alpha=_KUKA_ALPHA,
        a=_KUKA_A,
        d=_KUKA_D,
        theta=[0.0, 0.0, RIGHT, 0.0, 0.0, 0.0],
        base_rotation=rotation_x(np.pi),
    )


def kuka_kr300_cad_parameters() -> np.ndarray:
    """Return link parameters (6, 10) from the KR300's published masses and centers of mass.

    No inertias are published: each body counts as a point mass at its center of mass, the least
    inertia it can have. The published centers lie in the frames behind the links' DH rows.
    """
    bodies = (
        (395.4, (-0.353, 0.174, -0.004)),
        (339.12, (-0.709, -0.001, 0.023)),
        (105.21, (-0.018, -0.018, -0.076)),
        (35.8, (0.0, 0.236, 0.001)),
        (31.46, (0.0, -0.08, -0.009)),
        (17.78, (0.0, 0.0, -0.05)),
    )
    rows = []
    for (mass, center), twist, a, d in zip(bodies, _KUKA_ALPHA, _KUKA_A, _KUKA_D, strict=True):
        point = body_parameters(mass, np.array(center), np.zeros((3, 3)))
        rows.append(move_parameters(point, rotation_x(twist), np.array([a, 0.0, d])))
    return np.stack(rows)


BUILTIN_ROBOTS: dict[str, Callable[[], Robot]] = {
    "rx60": rx60,
    "tx40": tx40,
    "ur10e": ur10e,
    "emps": emps,
    "kuka_kr300": kuka_kr300,
}
