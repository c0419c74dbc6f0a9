"""Robots of many joints: the joints as lanes, so that the program stays the same size.

The recursions of the other modules are written out joint by joint: fast for an arm, but the compiler's
work grows with the square of the joints. Here every quantity of all joints is one entry of shape
(n, ...), what needs no neighbor is computed for all joints at once, and what is handed from link to link
runs in a loop over a table with one row a link (the base is the row after the last, which is where the
index -1 of a parent points). The equations are those of :mod:`jaxswarm.robot.kinematics`,
:mod:`jaxswarm.robot.dynamics` and :mod:`jaxswarm.robot.mass`; the mass matrix is formed in base axes,

    M_ij = s_i . (sum of I_k over the links k that j carries) s_j    for joints i that carry j,

with s the joint axes and I the link inertias, both about the base's origin.
"""

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.robot import spatial as sp
from jaxswarm.robot.model import Robot

# As loops, 20 joints compile seven times faster and run 1.1 (regressor) to 1.7 times (inverse dynamics) as
# long; an arm of seven gains little and loses the same (benchmarks/dynamics_joints.py).
MANY = 14
# The mass matrix has a number for each pair and its factors feed on each other: 7 joints compile in 1 s,
# 20 in 200 s.
MANY_IN_PAIRS = 10


def is_many(robot: Robot) -> bool:
    """Tell whether a robot has so many joints that loops serve it better than written-out code."""
    return robot.num_joints > MANY


def is_many_in_pairs(robot: Robot) -> bool:
    """Tell the same of the mass matrix and its factors."""
    return robot.num_joints > MANY_IN_PAIRS


def turning(robot: Robot) -> np.ndarray:
    """Return the mask (n,) of the revolute joints."""
    return np.array([kind == "revolute" for kind in robot.kinds])


def ancestors(robot: Robot) -> np.ndarray:
    """Return the (n, n) mask whose entry (j, i) tells whether joint j moves link i."""
    mask = np.eye(robot.num_joints, dtype=bool)
    for i, parent in enumerate(robot.parents):
        if parent >= 0:
            mask[:, i] |= mask[:, parent]
    return mask


def of_joints(array, rank: int, like: jax.Array):
    """Unpack axes 1 to ``rank`` of an array (n, ...) into nested tuples of entries (n, lanes).

    Args:
        array: (n, ...), with or without lanes at the end.
        rank: Number of axes to unpack.
        like: (n, ...), whose lanes and type the entries take.
    """
    array = jnp.asarray(array, like.dtype if isinstance(array, np.ndarray) else None)
    if rank:
        return tuple(of_joints(array[:, k], rank - 1, like) for k in range(array.shape[1]))
    return array.reshape(array.shape + (1,) * (like.ndim - array.ndim))


def transforms(robot: Robot, q: jax.Array, sincos) -> tuple[sp.Matrix, sp.Vector]:
    """Return the poses of all links in their parents' frames as entries (n, ...)."""
    axis, place = of_joints(robot.axis, 1, q), of_joints(robot.rotation, 2, q)
    turns = of_joints(turning(robot), 0, q)
    sine, cosine = sincos(q)
    turn = sp.rotation_about(axis, jnp.where(turns, sine, 0.0), jnp.where(turns, cosine, 1.0))
    shift = sp.scale(jnp.where(turns, 0.0, q), sp.rotate(place, axis))
    translation = sp.add(of_joints(robot.translation, 1, q), shift)
    return sp.settle((sp.product(place, turn), translation))


def _outwards(robot: Robot, step, base: list[jax.Array], given) -> list[jax.Array]:
    """Return rows (n, ...) of step(row of the parent, what is given for the joint), base first."""
    n = robot.num_joints
    table = [jnp.broadcast_to(x, (n + 1, *x.shape)) for x in base]

    def body(table, now):
        i, parent, here = now
        rows = step([jax.lax.dynamic_index_in_dim(x, parent, 0, False) for x in table], here)
        update = jax.lax.dynamic_update_index_in_dim
        return [
            update(x, jnp.broadcast_to(row, x.shape[1:]), i, 0)
            for x, row in zip(table, rows, strict=True)
        ], None

    order = (np.arange(n), np.array(robot.parents) % (n + 1), given)
    return [x[:n] for x in jax.lax.scan(body, table, order)[0]]


def link_motions(robot: Robot, poses, q, dq, ddq, *, with_gravity: bool = True):
    """Return angular velocity, angular acceleration and acceleration of all links, entries (n, ...)."""
    axis, turns = of_joints(robot.axis, 1, q), of_joints(turning(robot), 0, q)
    none = jnp.zeros_like(q)
    speed = sp.scale(none if dq is None else dq, axis)
    push = sp.scale(none if ddq is None else ddq, axis)
    turned = [tuple(jnp.where(turns, x, 0.0) for x in part) for part in (speed, push)]
    slid = [tuple(jnp.where(turns, 0.0, x) for x in part) for part in (speed, push)]
    given = (poses, turned, None if turning(robot).all() else slid)

    def step(before, here):
        velocity, acceleration, linear = before[:3], before[3:6], before[6:]
        (rotation, translation), (turn, turn_push), slides = here
        slide, slide_push = (sp.ZERO, sp.ZERO) if slides is None else slides
        around = sp.cross(velocity, sp.cross(velocity, translation))
        swing = sp.add(sp.cross(acceleration, translation), around)
        linear = sp.rotate_back(rotation, sp.add(linear, swing))
        carried = sp.rotate_back(rotation, velocity)
        acceleration = sp.rotate_back(rotation, acceleration)
        acceleration = sp.add(acceleration, sp.add(turn_push, sp.cross(carried, turn)))
        coriolis = sp.scale(2.0, sp.cross(carried, slide))
        linear = sp.add(linear, sp.add(slide_push, coriolis))
        return [*sp.add(carried, turn), *acceleration, *linear]

    lift = [0.0] * 6 + [-g if with_gravity else 0.0 * g for g in jnp.asarray(robot.gravity)]
    kind = jnp.result_type(q, *jax.tree.leaves(poses))
    base = [jnp.broadcast_to(jnp.asarray(x, kind), q.shape[1:]) for x in lift]
    moved = _outwards(robot, step, base, given)
    return tuple(moved[:3]), tuple(moved[3:6]), tuple(moved[6:])


def base_transforms(robot: Robot, poses, q) -> tuple[sp.Matrix, sp.Vector]:
    """Return the poses of all links in the base frame as entries (n, ...)."""

    def step(before, here):
        turn = tuple(tuple(before[3 * r : 3 * r + 3]) for r in range(3))
        rotation = sp.product(turn, here[0])
        origin = sp.add(tuple(before[9:]), sp.rotate(turn, here[1]))
        return [x for row in rotation for x in row] + list(origin)

    kind = jnp.result_type(q, *jax.tree.leaves(poses))
    base = [jnp.full(q.shape[1:], x, kind) for x in [1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0, 0, 0, 0]]
    table = _outwards(robot, step, base, poses)
    return tuple(tuple(table[3 * r : 3 * r + 3]) for r in range(3)), tuple(table[9:])


def torques(robot: Robot, poses, wrenches: tuple[sp.Vector, sp.Vector], q) -> jax.Array:
    """Return the joint torques (n, ...) that the wrenches of the links need, tips first."""
    n = robot.num_joints
    table = [jnp.concatenate([x, jnp.zeros_like(x[:1])]) for part in wrenches for x in part]

    def body(table, now):
        i, parent, (rotation, translation) = now
        rows = [jax.lax.dynamic_index_in_dim(x, i, 0, False) for x in table]
        force = sp.rotate(rotation, tuple(rows[:3]))
        moment = sp.add(sp.rotate(rotation, tuple(rows[3:])), sp.cross(translation, force))
        update = jax.lax.dynamic_update_index_in_dim
        take = jax.lax.dynamic_index_in_dim
        return [
            update(x, take(x, parent, 0, False) + more, parent, 0)
            for x, more in zip(table, (*force, *moment), strict=True)
        ], None

    order = (np.arange(n), np.array(robot.parents) % (n + 1), poses)
    summed = [x[:n] for x in jax.lax.scan(body, table, order, reverse=True)[0]]
    axis, turns = of_joints(robot.axis, 1, q), of_joints(turning(robot), 0, q)
    return jnp.where(turns, sp.dot(axis, summed[3:]), sp.dot(axis, summed[:3]))


def mass_matrix(robot: Robot, poses, q) -> jax.Array:
    """Return the mass matrix (n, n, ...)."""
    rotation, p = base_transforms(robot, poses, q)
    link = of_joints(robot.parameters, 1, q)
    mass, first = link[0], sp.rotate(rotation, link[1:4])
    inertia = sp.product(sp.product(rotation, sp.symmetric(*link[4:])), sp.transpose(rotation))
    # About the base's origin: h' = h + m p, I' = I + (2 p.h + m p.p) 1 - h p^T - p h^T - m p p^T.
    trace = 2.0 * sp.dot(p, first) + mass * sp.dot(p, p)
    moved = sp.add(first, sp.scale(mass, p))

    def entry(r: int, c: int):
        outer = first[r] * p[c] + p[r] * first[c] + mass * p[r] * p[c]
        return inertia[r][c] - outer + (trace if r == c else 0.0)

    six = [entry(r, c) for r, c in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))]
    carries = jnp.asarray(ancestors(robot), q.dtype)
    full = [jnp.broadcast_to(x, p[0].shape) for x in (mass, *moved, *six)]
    body = [jnp.tensordot(carries, x, 1) for x in full]  # the links that each joint carries, as one
    axis = sp.rotate(rotation, of_joints(robot.axis, 1, q))
    turns = of_joints(turning(robot), 0, q)
    spin = tuple(jnp.where(turns, x, 0.0) for x in axis)
    slide = tuple(jnp.where(turns, y, x) for x, y in zip(axis, sp.cross(p, spin), strict=True))
    force = sp.add(sp.scale(body[0], slide), sp.cross(spin, tuple(body[1:4])))
    moment = sp.add(sp.rotate(sp.symmetric(*body[4:]), spin), sp.cross(tuple(body[1:4]), slide))
    pairs = sp.dot([x[:, None] for x in (*spin, *slide)], [x[None] for x in (*moment, *force)])
    mask = ancestors(robot)
    upper = jnp.where(mask.reshape(mask.shape + (1,) * (q.ndim - 1)), pairs, 0.0)
    below = (mask & ~mask.T).T
    return jnp.where(
        below.reshape(mask.shape + (1,) * (q.ndim - 1)), jnp.swapaxes(upper, 0, 1), upper
    )


def solve(matrix: jax.Array, right: jax.Array) -> jax.Array:
    """Solve A x = b, A (n, n, ...) symmetric positive definite, b (n, ...), by Cholesky's factor."""
    a, b = jnp.moveaxis(matrix, (0, 1), (-2, -1)), jnp.moveaxis(right, 0, -1)
    lower = jnp.linalg.cholesky(a, symmetrize_input=False)
    return jnp.moveaxis(jax.scipy.linalg.cho_solve((lower, True), b[..., None])[..., 0], -1, 0)


def solve_symmetric(matrix: list[list], right: list) -> list:
    """Solve the same for entries."""
    leaves = jax.tree.leaves((matrix, right))
    kind, shape = jnp.result_type(*leaves), jnp.broadcast_shapes(*map(jnp.shape, leaves))
    like = jnp.zeros(shape, kind)
    rows = jnp.stack([sp.stack(row, like) for row in matrix])
    return list(solve(rows, sp.stack(right, like)))
