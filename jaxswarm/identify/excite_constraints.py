"""Which torques and distances a planned motion has to keep, from limits, robot file and model; what is told."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.identify.excitation.columns import plannable
from jaxswarm.identify.excitation.constraints import Constraints, closest, dense, link_name
from jaxswarm.identify.excitation.fourier import Fourier
from jaxswarm.identify.excitation.limits import Limits
from jaxswarm.identify.forward.model import Model
from jaxswarm.robot.build import description_of
from jaxswarm.robot.capsules import Capsules, capsules_of, distances, pairs_of_links
from jaxswarm.robot.joints import Description
from jaxswarm.robot.model import Robot

# Poses at random within the limits that say which links overlap wherever the arm is.
_POSES = 400
# A pair that keeps its distance in fewer of them overlaps by its shapes, not by its motion: a wrist whose
# axes meet, or covers that overlap at a joint.
_SELDOM = 0.05


def refuse_joints(robot: Robot, given: Model | None) -> None:
    """Refuse the model of another robot.

    Raises:
        InputError: If its joints are not those of the robot.
    """
    if given is not None and given.robot.joints != robot.joints:
        raise InputError(
            f"--given: its model has the joints {', '.join(given.robot.joints)}, the robot "
            f"{', '.join(robot.joints)}; name the robot it was identified for"
        )


def constraints_of(
    robot: Robot, description: Description | None, limits: Limits, given: Model | None
) -> tuple[Constraints | None, list[str]]:
    """What a motion has to keep beside positions, speeds and accelerations, and what is told of it.

    Torques need masses: those of the model, else those of the robot. Distances need shapes, or a radius.

    Raises:
        InputError: If the limits ask for what cannot be computed.
    """
    notes: list[str] = []
    description = description or description_of(robot)
    body = robot if given is None else given.robot
    effort = _effort(body, description, limits, notes)
    terms: list = []
    if given is not None and np.isfinite(effort).any():
        terms = [t for t in given.terms if plannable(t, robot.joints, True)]
        left = [t.label(robot.joints) for t in given.terms if t not in terms]
        if left:
            notes.append(f"torques are those without {', '.join(left)}: not known of the motion")
    elif np.isfinite(effort).any():
        notes.append("torques are those of the rigid body; --given MODEL.json adds its effects")
    capsules, pairs = _shapes(robot, description, limits, notes)
    if capsules is None and not np.isfinite(effort).any():
        return None, notes
    arm = jax.tree.map(np.asarray, body)
    return Constraints(arm, effort, tuple(terms), capsules, pairs, limits.distance or 0.0), notes


def _effort(body: Robot, description: Description, limits: Limits, notes: list[str]) -> np.ndarray:
    """Largest torque of each joint, infinite where none is known or there are no masses."""
    n = body.num_joints
    asked = np.full(n, np.nan) if limits.effort is None else limits.effort
    file = {joint.name: joint.limits.effort for joint in description.joints}
    listed = np.array([file.get(joint, np.nan) for joint in body.joints])
    # An effort of zero is what writers of robot files leave where they know none.
    effort = np.where(np.isnan(asked), np.where(listed > 0, listed, np.nan), asked)
    if np.asarray(body.parameters).any():
        bare = [joint for joint, limit in zip(body.joints, effort, strict=True) if np.isnan(limit)]
        if bare:
            notes.append(
                f"torque is not limited on {', '.join(bare)}: give effort in the limits file"
            )
        return np.where(np.isnan(effort), np.inf, effort)
    if not np.isnan(asked).all():
        raise InputError(
            "effort in the limits file: the robot has no masses to tell torques by; give those of a "
            "model, --given MODEL.json"
        )
    notes.append("torques are not checked: masses are not known; give a model, --given MODEL.json")
    return np.full(n, np.inf)


def _shapes(
    robot: Robot, description: Description, limits: Limits, notes: list[str]
) -> tuple[Capsules | None, np.ndarray | None]:
    """Capsules and the pairs of them that have to stay apart; None where nothing is asked or known."""
    if limits.distance is None and limits.radius is None:
        if not any(joint.shapes for joint in description.joints):
            notes.append(
                "links may hit each other: give radius in the limits file to keep them apart"
            )
            return None, None
    capsules = capsules_of(description, limits.radius)
    if limits.distance is not None and not len(capsules.link):
        raise InputError(
            "distance in the limits file: the robot has no shapes to tell it by; give radius too, of the "
            "segments from joint to joint"
        )
    if capsules.without:
        names = ", ".join(link_name(robot, link) for link in capsules.without)
        notes.append(f"no shape, so that it may be hit: {names}; give radius in the limits file")
    pairs = pairs_of_links(robot, capsules)
    pairs, always = _apart_somewhere(robot, capsules, pairs, limits)
    if always:
        notes.append(f"overlap wherever the arm is, so not kept apart: {'; '.join(always)}")
    return (capsules, pairs) if len(pairs) else (None, None)


def _apart_somewhere(
    robot: Robot, capsules: Capsules, pairs: np.ndarray, limits: Limits
) -> tuple[np.ndarray, list[str]]:
    """The pairs that keep their distance in some poses, and the links of the others."""
    if not len(pairs):
        return pairs, []
    poses = np.random.default_rng(0).uniform(limits.lower, limits.upper, (_POSES, robot.num_joints))
    look = jax.jit(jax.vmap(lambda q: distances(robot, capsules, pairs, q)))
    free = (np.asarray(look(jnp.asarray(poses))) >= (limits.distance or 0.0)).mean(axis=0)
    kept = free >= _SELDOM
    names = [
        " and ".join(link_name(robot, capsules.link[k]) for k in pair) for pair in pairs[~kept]
    ]
    return pairs[kept], list(dict.fromkeys(names))


def told_constraints(
    constraints: Constraints | None, trajectory: Fourier, limits: Limits
) -> dict[str, Any]:
    """Torques and distances of a motion as plain data; null where they were not checked."""
    torque, distance = None, None
    if constraints is not None:
        motion, period = dense(trajectory, limits)
        joints = constraints.robot.joints
        if np.isfinite(constraints.effort).any():
            most = np.abs(np.asarray(constraints.torques(limits, motion, period))).max(axis=1)
            torque = {
                joint: {
                    "largest": float(top),
                    "limit": float(bound) if np.isfinite(bound) else None,
                }
                for joint, top, bound in zip(joints, most, constraints.effort, strict=True)
            }
        if constraints.capsules is not None:
            least, between = closest(constraints, motion[0])
            distance = {"least": least, "asked": constraints.distance, "between": list(between)}
    return {"torque": torque, "self_distance": distance}
