"""The mass matrix by composite bodies, and accelerations from torques.

All links outside joint j, frozen, are one body; M_ij is the torque joint i supplies for a unit
acceleration of joint j moving that body. Forward dynamics solves

    M(q) ddq = tau - h(q, dq)

by M = L D L^T written out entry by entry. For the few joints of an arm that beats the
articulated-body recursion (which rotates a full 6 x 6 inertia at every joint) and every batched
solver; joints on different branches have known zeros in M, which drop out of the factors. A mass
matrix that is not positive definite gives NaN: :func:`check_mass_matrix` says so on the host.

Reference: Featherstone 2008, chapters 6 and 8.3.
"""

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.robot import many
from jaxswarm.robot import spatial as sp
from jaxswarm.robot.dynamics import many_torques, torques_of_motions
from jaxswarm.robot.kinematics import (
    SinCos,
    Transform,
    joint_transforms,
    link_motions,
    sincos,
)
from jaxswarm.robot.model import Robot

Entries = list[list[sp.Entry]]


def mass_matrix(robot: Robot, q: jax.Array | np.ndarray, *, sincos: SinCos = sincos) -> jax.Array:
    """Return the symmetric mass matrix (n, n) at joint positions q (n,), in kg m^2 or kg.

    >>> from jaxswarm.robot.builtin import rx60
    >>> mass_matrix(rx60(), jnp.zeros(3))[0, 0].round(4).item()
    8.7345
    """
    q = jnp.asarray(q)
    if many.is_many_in_pairs(robot):
        return many.mass_matrix(robot, many.transforms(robot, q, sincos), q)
    matrix = mass_entries(robot, joint_transforms(robot, q, sincos))
    return jnp.stack([sp.stack(row, q[0]) for row in matrix])


def forward_dynamics(
    robot: Robot, q: jax.Array, dq: jax.Array, tau: jax.Array, *, sincos: SinCos = sincos
) -> jax.Array:
    """Return the joint accelerations that torques cause, M(q)^-1 (tau - h(q, dq)).

    Args:
        robot: The robot.
        q: (n,), joint positions in rad or m.
        dq: (n,), velocities in rad/s or m/s.
        tau: (n,), torques in N m or forces in N.
        sincos: Function that gives sine and cosine of an angle.

    Returns:
        (n,), accelerations in rad/s^2 or m/s^2; NaN where the mass matrix is singular.

    >>> from jaxswarm.robot.builtin import rx60
    >>> q = jnp.zeros(3)
    >>> ddq = forward_dynamics(rx60(), q, q, jnp.array([8.7345, 0.0, 0.0]))
    >>> ddq.shape
    (3,)
    """
    q, dq, tau = jnp.asarray(q), jnp.asarray(dq), jnp.asarray(tau)
    if many.is_many_in_pairs(robot):
        poses = many.transforms(robot, q, sincos)
        rest = tau - many_torques(robot, poses, q, dq, None)
        return many.solve(many.mass_matrix(robot, poses, q), rest)
    matrix, bias = equations_of_motion(robot, q, dq, sincos=sincos)
    load = [sp.minus(tau[i], bias[i]) for i in range(robot.num_joints)]
    return sp.stack(solve_symmetric(matrix, load), q[0])


def equations_of_motion(
    robot: Robot, q, dq, *, sincos: SinCos = sincos
) -> tuple[Entries, list[sp.Entry]]:
    """Return mass matrix and bias forces as entries, from one pass over the kinematics.

    ``q`` and ``dq`` are sequences of n entries. The simulation adds effects to both, then solves.
    """
    if many.is_many_in_pairs(robot):
        q, dq = jnp.stack(list(q)), jnp.stack(list(dq))
        poses = many.transforms(robot, q, sincos)
        mass = many.mass_matrix(robot, poses, q)
        return [list(row) for row in mass], list(many_torques(robot, poses, q, dq, None))
    transforms = joint_transforms(robot, q, sincos)
    motions = link_motions(robot, transforms, dq, None)
    return mass_entries(robot, transforms), torques_of_motions(robot, transforms, motions)


def mass_entries(robot: Robot, transforms: list[Transform]) -> Entries:
    """Return the mass matrix as n rows of n entries; joints on different branches give 0.0."""
    n = robot.num_joints
    axes = sp.entries(robot.axis, 2)
    bodies = [(p[0], tuple(p[1:4]), sp.symmetric(*p[4:])) for p in sp.entries(robot.parameters, 2)]
    matrix: Entries = [[0.0] * n for _ in range(n)]
    for j in reversed(range(n)):
        mass, first, inertia = bodies[j] = sp.settle(bodies[j])
        if robot.kinds[j] == "revolute":
            force, moment = sp.cross(axes[j], first), sp.rotate(inertia, axes[j])
        else:
            force, moment = sp.scale(mass, axes[j]), sp.cross(first, axes[j])
        i = j
        while True:
            along = moment if robot.kinds[i] == "revolute" else force
            matrix[i][j] = matrix[j][i] = sp.dot(axes[i], along)
            parent = robot.parents[i]
            if parent < 0:
                break
            rotation, translation = transforms[i]
            force, moment = sp.rotate(rotation, force), sp.rotate(rotation, moment)
            moment = sp.add(moment, sp.cross(translation, force))
            force, moment = sp.settle((force, moment))
            i = parent
        if robot.parents[j] >= 0:
            moved = _seen_from_parent(bodies[j], transforms[j])
            bodies[robot.parents[j]] = _joined(bodies[robot.parents[j]], moved)
    return matrix


def _seen_from_parent(body, transform: Transform):
    """Mass, first moment and inertia of a body about the parent's origin, in its axes."""
    mass, first, inertia = body
    rotation, p = transform
    half = sp.product(rotation, inertia)
    h = sp.rotate(rotation, first)
    # I' = R I R^T + (2 p.h + m p.p) 1 - h p^T - p h^T - m p p^T, with k = h + m p / 2.
    k = sp.add(h, sp.scale(sp.times(0.5, mass), p))
    trace = sp.times(2.0, sp.dot(p, k))
    rows = [[0.0] * 3 for _ in range(3)]
    for r in range(3):
        for c in range(r, 3):
            turned = sp.dot(half[r], rotation[c])
            outer = sp.plus(sp.times(k[r], p[c]), sp.times(p[r], k[c]))
            entry = sp.minus(turned, outer)
            rows[r][c] = rows[c][r] = sp.plus(entry, trace) if r == c else entry
    return mass, sp.add(h, sp.scale(mass, p)), tuple(tuple(row) for row in rows)


def _joined(a, b):
    return sp.plus(a[0], b[0]), sp.add(a[1], b[1]), sp.add_matrices(a[2], b[2])


def solve_symmetric(matrix: Entries, right: list[sp.Entry]) -> list[sp.Entry]:
    """Solve A x = b for a symmetric positive definite A given as entries, by A = L D L^T."""
    n = len(right)
    if n > many.MANY_IN_PAIRS:
        return many.solve_symmetric(matrix, right)
    lower: Entries = [[0.0] * n for _ in range(n)]
    inverse: list[sp.Entry] = [0.0] * n
    scaled: Entries = [[0.0] * n for _ in range(n)]  # L D
    for j in range(n):
        pivot = matrix[j][j]
        for k in range(j):
            pivot = sp.minus(pivot, sp.times(scaled[j][k], lower[j][k]))
        pivot = jnp.asarray(pivot, float) if isinstance(pivot, float) else pivot
        # A pivot that is not positive means the matrix is not a mass matrix: say NaN, not nonsense.
        inverse[j] = jnp.where(pivot > 0.0, 1.0 / pivot, jnp.nan)
        for i in range(j + 1, n):
            entry = matrix[i][j]
            for k in range(j):
                entry = sp.minus(entry, sp.times(scaled[i][k], lower[j][k]))
            scaled[i][j] = entry
            lower[i][j] = sp.times(entry, inverse[j])
    x = list(right)
    for i in range(n):
        for k in range(i):
            x[i] = sp.minus(x[i], sp.times(lower[i][k], x[k]))
    x = [sp.times(value, d) for value, d in zip(x, inverse, strict=True)]
    for i in reversed(range(n)):
        for k in range(i + 1, n):
            x[i] = sp.minus(x[i], sp.times(lower[k][i], x[k]))
    return x


def check_mass_matrix(robot: Robot, q: np.ndarray) -> None:
    """Raise if the mass matrix at q (n,) is not positive definite.

    Raises:
        InputError: With the smallest eigenvalue and the joint that takes most part in it.
    """
    matrix = np.asarray(mass_matrix(robot, q))
    values, directions = np.linalg.eigh(matrix)
    if not values[0] > 1e-12 * max(values[-1], 0.0) or not np.isfinite(values).all():
        joint = robot.joints[int(np.argmax(np.abs(directions[:, 0])))]
        raise InputError(
            f"robot {robot.name!r}: its mass matrix at q = {np.round(q, 4).tolist()} is singular "
            f"or negative (smallest eigenvalue {values[0]:.3g}, mostly {joint}): give its links "
            "mass and inertia, or the joint a rotor inertia."
        )
