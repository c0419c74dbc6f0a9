r"""How the torques along a log change when a joint sits elsewhere on its parent, to first order.

The recursions of :mod:`jaxswarm.robot.kinematics` and :mod:`jaxswarm.robot.dynamics` with their derivatives
carried along: with a shift :math:`\rho` and a turn :math:`\theta` of the joint's frame in its parent's, the
joint's rotation R turns what the parent hands on by :math:`\delta(R^T x) = R^T (\delta x + x \times \theta)`.
Links before the joint move as before, so that only those from it on are looked at, and all joints feel them.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.robot import spatial as sp
from jaxswarm.robot.dynamics import link_wrench
from jaxswarm.robot.kinematics import LinkMotion, Transform
from jaxswarm.robot.logged import BLOCK, links_along
from jaxswarm.robot.model import Robot

_STILL = LinkMotion(sp.ZERO, sp.ZERO, sp.ZERO)


def displacement_slopes(
    robot: Robot,
    q: np.ndarray,
    dq: np.ndarray,
    ddq: np.ndarray,
    joint: int,
    moves: np.ndarray,
) -> np.ndarray:
    """Return the derivatives of the torques of every sample by moves of a joint on its parent.

    Args:
        robot: The robot with its parameters.
        q: (T, n), joint positions in rad or m.
        dq: (T, n), velocities in rad/s or m/s.
        ddq: (T, n), accelerations in rad/s^2 or m/s^2.
        joint: The joint that sits elsewhere.
        moves: (m, 2, 3), shift [m] and turn [rad] of its frame in its parent's.

    Returns:
        (T, n, m), torque per unit of every move.

    >>> from jaxswarm.robot.builtin import rx60
    >>> displacement_slopes(rx60(), *np.zeros((3, 5, 3)), 1, np.ones((2, 2, 3))).shape
    (5, 3, 2)
    """
    slopes = np.zeros((*q.shape, len(moves)))
    known = sp.entries(np.asarray(robot.parameters, float), 2)
    given = [sp.entries(np.asarray(move, float), 2) for move in moves]
    for start in range(0, len(q), BLOCK):
        part = slice(start, start + BLOCK)
        links = links_along(robot, q[part], dq[part], ddq[part])
        for number, move in enumerate(given):
            told = _torques(robot, known, *links, dq[part].T, joint, move)
            for own, entry in enumerate(told):
                if not sp.is_zero(entry):
                    slopes[part, own, number] = entry
    return slopes


def _torques(
    robot: Robot,
    parameters: tuple[sp.Vector, ...],
    transforms: list[Transform],
    motions: list[LinkMotion],
    dq: np.ndarray,
    joint: int,
    move: tuple[sp.Vector, sp.Vector],
) -> list[sp.Entry]:
    """Derivatives of all torques by one move."""
    axes = sp.entries(np.asarray(robot.axis, float), 2)
    shift, turn = move
    here = transforms[joint].translation
    placed = sp.entries(np.asarray(robot.translation[joint], float), 1)
    # What a slide has carried on from its place turns with it.
    shift = sp.add(shift, sp.cross(turn, sp.subtract(here, placed)))
    moved = {joint: _at(robot, transforms, motions, dq, axes, joint, (shift, turn))}
    for link in range(joint + 1, robot.num_joints):
        parent = robot.parents[link]
        if parent in moved:
            before = moved[parent], motions[parent]
            moved[link] = _after(robot, transforms[link], *before, dq[link], axes[link], link)
    return _felt(robot, parameters, transforms, motions, moved, axes, joint, (shift, turn))


def _at(
    robot: Robot,
    transforms: list[Transform],
    motions: list[LinkMotion],
    dq: np.ndarray,
    axes: Sequence[sp.Vector],
    joint: int,
    move: tuple[sp.Vector, sp.Vector],
) -> LinkMotion:
    """Change of the motion of the link that is moved itself."""
    (rotation, translation), (shift, turn) = transforms[joint], move
    parent = robot.parents[joint]
    lift = sp.scale(-1.0, sp.entries(np.asarray(robot.gravity, float), 1))
    w, alpha, a = motions[parent] if parent >= 0 else _STILL._replace(acceleration=lift)
    felt = sp.add(a, _swing(w, alpha, translation))
    change = sp.add(sp.cross(felt, turn), _swing(w, alpha, shift))
    carried = sp.rotate_back(rotation, sp.cross(w, turn))
    turning = sp.rotate_back(rotation, sp.cross(alpha, turn))
    acceleration = sp.rotate_back(rotation, change)
    speed = sp.scale(dq[joint], axes[joint])
    return _driven(robot.kinds[joint], carried, turning, acceleration, speed)


def _after(
    robot: Robot,
    transform: Transform,
    change: LinkMotion,
    parent: LinkMotion,
    dq: np.ndarray,
    axis: sp.Vector,
    link: int,
) -> LinkMotion:
    """Change of the motion of a link whose parent's changes."""
    rotation, translation = transform
    w, turning, felt = change
    before = parent.angular_velocity
    around = sp.add(
        sp.cross(w, sp.cross(before, translation)), sp.cross(before, sp.cross(w, translation))
    )
    felt = sp.add(felt, sp.add(sp.cross(turning, translation), around))
    w, turning, felt = (sp.rotate_back(rotation, x) for x in (w, turning, felt))
    return _driven(robot.kinds[link], w, turning, felt, sp.scale(dq, axis))


def _swing(w: sp.Vector, alpha: sp.Vector, arm: sp.Vector) -> sp.Vector:
    """Acceleration of a point of a body beside that of its origin."""
    return sp.add(sp.cross(alpha, arm), sp.cross(w, sp.cross(w, arm)))


def _driven(
    kind: str, carried: sp.Vector, turning: sp.Vector, acceleration: sp.Vector, speed: sp.Vector
) -> LinkMotion:
    """The change of a link's motion with what its own joint's speed makes of it."""
    if kind == "revolute":
        turning = sp.add(turning, sp.cross(carried, speed))
    else:
        acceleration = sp.add(acceleration, sp.scale(2.0, sp.cross(carried, speed)))
    return LinkMotion(carried, turning, acceleration)


def _felt(
    robot: Robot,
    parameters: tuple[sp.Vector, ...],
    transforms: list[Transform],
    motions: list[LinkMotion],
    moved: dict[int, LinkMotion],
    axes: Sequence[sp.Vector],
    joint: int,
    move: tuple[sp.Vector, sp.Vector],
) -> list[sp.Entry]:
    """Derivatives of all torques by the changes of motions, and by what the moved joint hands on."""
    still = (sp.ZERO, sp.ZERO)
    changes = [still] * robot.num_joints
    whole = [still] * robot.num_joints
    for link, change in moved.items():
        whole[link] = link_wrench(parameters[link], motions[link])
        changes[link] = _wrench_slope(parameters[link], motions[link], change)
    torques: list[sp.Entry] = [0.0] * robot.num_joints
    for link in reversed(range(robot.num_joints)):
        force, moment = changes[link]
        torques[link] = sp.dot(axes[link], moment if robot.kinds[link] == "revolute" else force)
        parent = robot.parents[link]
        if parent < 0:
            continue
        told = _handed(transforms[link], changes[link])
        if link in moved:
            own = _handed(transforms[link], whole[link])
            if link == joint:
                told = _turned(transforms[link], told, own, move)
            else:
                whole[parent] = _sum(whole[parent], own)
        changes[parent] = _sum(changes[parent], told)
    return torques


def _wrench_slope(
    parameters: sp.Vector, motion: LinkMotion, change: LinkMotion
) -> tuple[sp.Vector, sp.Vector]:
    """Change of the force and moment that a link needs, of :func:`jaxswarm.robot.dynamics.link_wrench`."""
    w, (turned, alpha, a) = motion.angular_velocity, change
    mass, first, inertia = parameters[0], parameters[1:4], sp.symmetric(*parameters[4:])
    force = sp.add(sp.scale(mass, a), sp.cross(alpha, first))
    force = sp.add(force, sp.cross(turned, sp.cross(w, first)))
    force = sp.add(force, sp.cross(w, sp.cross(turned, first)))
    moment = sp.add(sp.rotate(inertia, alpha), sp.cross(turned, sp.rotate(inertia, w)))
    moment = sp.add(moment, sp.cross(w, sp.rotate(inertia, turned)))
    return force, sp.add(moment, sp.cross(first, a))


def _handed(
    transform: Transform, wrench: tuple[sp.Vector, sp.Vector]
) -> tuple[sp.Vector, sp.Vector]:
    """A link's force and moment as its parent feels them."""
    force, moment = (sp.rotate(transform.rotation, x) for x in wrench)
    return force, sp.add(moment, sp.cross(transform.translation, force))


def _turned(
    transform: Transform,
    told: tuple[sp.Vector, sp.Vector],
    own: tuple[sp.Vector, sp.Vector],
    move: tuple[sp.Vector, sp.Vector],
) -> tuple[sp.Vector, sp.Vector]:
    """The change that a parent feels where the force and moment ``own`` come from elsewhere."""
    (force, moment), (shift, turn) = own, move
    about = sp.subtract(moment, sp.cross(transform.translation, force))
    pushed = sp.cross(turn, force)
    bent = sp.add(sp.cross(turn, about), sp.cross(shift, force))
    bent = sp.add(bent, sp.cross(transform.translation, pushed))
    return _sum(told, (pushed, bent))


def _sum(
    one: tuple[sp.Vector, sp.Vector], other: tuple[sp.Vector, sp.Vector]
) -> tuple[sp.Vector, sp.Vector]:
    return sp.add(one[0], other[0]), sp.add(one[1], other[1])
