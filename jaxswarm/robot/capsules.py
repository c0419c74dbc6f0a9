"""The space a robot fills, as capsules: segments with a radius around them that move with its links.

Where a file has no shapes for a link, segments run through the joints that sit on it. What is fixed to a link
belongs to it. Distances are those of the capsules, so that boxes and cylinders come out a little thicker
than they are. Closest points of segments: C. Ericson, Real-Time Collision Detection, 2005, section 5.1.9.
"""

from collections import defaultdict
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.robot.build import parents_first
from jaxswarm.robot.joints import Capsule, Description
from jaxswarm.robot.kinematics import forward_kinematics
from jaxswarm.robot.model import Robot

# Shorter segments join two frames at one point.
_SHORTEST = 1e-6
# Below this share of the product of their squared lengths, two segments are parallel.
_PARALLEL = 1e-12

BASE = -1


@dataclass(frozen=True)
class Capsules:
    """Capsules of a robot.

    Attributes:
        link: Number of the link that carries each, ``BASE`` for the base, (c,).
        start, end: Ends of the segments in the link's frame [m], (c, 3).
        radius: [m], (c,).
        without: Numbers of the links that have none.
    """

    link: np.ndarray
    start: np.ndarray
    end: np.ndarray
    radius: np.ndarray
    without: tuple[int, ...]


def capsules_of(description: Description, radius: float | None = None) -> Capsules:
    """Return the capsules of a description, those of links without shapes by a radius.

    Args:
        description: Joints with their shapes.
        radius: Of segments from joint to joint [m], for links without shapes; None: they have none.
    """
    shapes: dict[int, list[Capsule]] = defaultdict(list)
    lines: dict[int, list[Capsule]] = defaultdict(list)
    carrier: dict[str | None, tuple[int, np.ndarray, np.ndarray]] = {
        None: (BASE, np.eye(3), np.zeros(3))
    }
    shapes[BASE] += description.base_shapes
    count = 0
    for joint in parents_first(description.name, description.joints):
        index, rotation, place = carrier[joint.parent]
        origin = rotation @ np.asarray(joint.translation, dtype=float) + place
        if np.linalg.norm(origin - place) > _SHORTEST:
            lines[index].append(Capsule(place, origin, 0.0))
        rotation, place = rotation @ np.asarray(joint.rotation, dtype=float), origin
        if joint.kind != "fixed":
            index, rotation, place, count = count, np.eye(3), np.zeros(3), count + 1
        carrier[joint.name] = (index, rotation, place)
        shapes[index] += [
            Capsule(rotation @ s.start + place, rotation @ s.end + place, s.radius)
            for s in joint.shapes
        ]
    point = Capsule(np.zeros(3), np.zeros(3), 0.0)
    found: list[tuple[int, Capsule]] = []
    without = []
    for index in range(BASE, count):
        if shapes[index]:
            found += [(index, shape) for shape in shapes[index]]
        elif radius is not None:
            # A base without a segment is a point nobody reaches; a last link is at least its joint.
            own = lines[index] or ([] if index == BASE else [point])
            found += [(index, line._replace(radius=radius)) for line in own]
        else:
            without.append(index)
    return Capsules(
        link=np.array([index for index, _ in found], dtype=int),
        start=np.array([shape.start for _, shape in found], dtype=float).reshape(-1, 3),
        end=np.array([shape.end for _, shape in found], dtype=float).reshape(-1, 3),
        radius=np.array([shape.radius for _, shape in found], dtype=float),
        without=tuple(without),
    )


def pairs_of_links(robot: Robot, capsules: Capsules) -> np.ndarray:
    """Return the pairs of capsules whose links are no neighbors, as numbers (P, 2)."""

    def apart(one: int, two: int) -> bool:
        low, high = sorted((one, two))
        return low != high and robot.parents[high] != low

    size = len(capsules.link)
    pairs = [
        (a, b)
        for a in range(size)
        for b in range(a + 1, size)
        if apart(int(capsules.link[a]), int(capsules.link[b]))
    ]
    return np.array(pairs, dtype=int).reshape(-1, 2)


def distances(robot: Robot, capsules: Capsules, pairs: np.ndarray, q: jax.Array) -> jax.Array:
    """Return the distance of each pair of capsules [m], (P,); below zero where they overlap.

    Args:
        robot: The robot they belong to.
        capsules: All of them.
        pairs: Numbers of those to look at, (P, 2).
        q: (n,), joint positions in rad or m.
    """
    turned, place = forward_kinematics(robot, q)
    # The base comes last, so that its number -1 finds it.
    turned = jnp.concatenate([turned, jnp.eye(3)[None]])[capsules.link]
    place = jnp.concatenate([place, jnp.zeros((1, 3))])[capsules.link]
    start = jnp.einsum("cij,cj->ci", turned, capsules.start) + place
    end = jnp.einsum("cij,cj->ci", turned, capsules.end) + place
    a, b = pairs[:, 0], pairs[:, 1]
    thick = capsules.radius[a] + capsules.radius[b]
    return segment_distance(start[a], end[a], start[b], end[b]) - thick


def segment_distance(a: jax.Array, b: jax.Array, c: jax.Array, d: jax.Array) -> jax.Array:
    """Return the distance (P,) of segments from a to b and from c to d, each end (P, 3).

    >>> at = [jnp.array([p]) for p in ([0.0, 0, 0], [2.0, 0, 0], [1.0, -1, 3], [1.0, 1, 3])]
    >>> segment_distance(*at).tolist()
    [3.0]
    """
    one, two, between = b - a, d - c, a - c
    aa, ee, ab = (jnp.sum(x * y, axis=1) for x, y in ((one, one), (two, two), (one, two)))
    f, g = jnp.sum(two * between, axis=1), jnp.sum(one * between, axis=1)

    def share(top: jax.Array, bottom: jax.Array) -> jax.Array:
        return jnp.where(bottom > 0, jnp.clip(top / jnp.where(bottom > 0, bottom, 1.0), 0, 1), 0.0)

    spread = aa * ee - ab * ab
    s = share(ab * f - g * ee, jnp.where(spread > _PARALLEL * aa * ee, spread, 0.0))
    t = share(ab * s + f, ee)
    s = share(ab * t - g, aa)  # the best place on the first, wherever the second one was cut off
    return jnp.linalg.norm(a + s[:, None] * one - c - t[:, None] * two, axis=1)
