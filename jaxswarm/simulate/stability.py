"""Is the step short enough? The fastest mode of a plant against the stability region of RK4.

The motion equations are linearized at standstill, where the smooth sign of dry friction is steepest:
with a width w, friction fc on an inertia m decays at fc / (w m), often far faster than anything one
wants to see. RK4 is stable while abs(1 + x + x^2/2 + x^3/6 + x^4/24) <= 1 for x = eigenvalue times step.
"""

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.robot.kinematics import sincos
from jaxswarm.simulate.acceleration import AMBIENT, Drive, State, accelerations, rest
from jaxswarm.simulate.plant import Plant


def fastest_mode(plant: Plant, q: jax.Array) -> tuple[complex, float]:
    """Return the eigenvalue that limits the step at standstill in q (n,), and that step.

    Returns:
        The eigenvalue in 1/s and the longest stable RK4 step in s (infinite if nothing decays).

    Raises:
        InputError: If the mass matrix is singular there.
    """
    slopes, jacobian = map(np.asarray, _linearized(plant, jnp.asarray(q, float)))
    if not (np.isfinite(slopes).all() and np.isfinite(jacobian).all()):
        raise InputError(
            f"the plant of robot {plant.robot.name!r} has no finite motion at q = "
            f"{np.round(np.asarray(q, float), 4).tolist()}: its mass matrix is singular; give its "
            "links mass and inertia, or its joints a rotor inertia."
        )
    eigenvalues = np.linalg.eigvals(jacobian)
    steps = [longest_step(value) for value in eigenvalues]
    index = int(np.argmin(steps))
    return complex(eigenvalues[index]), steps[index]


@jax.jit
def _linearized(plant: Plant, q: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Slopes of the state and their Jacobian at standstill under a torque of 1 on every joint."""
    start = rest(plant, q)
    n, s = q.shape[0], start.motor_q.shape[0]
    drive = Drive((1.0,) * n, (0.0,) * n, (AMBIENT,) * n)

    def flow(x):
        parts = jnp.split(x, [n, 2 * n, 2 * n + s])
        state = State(*(tuple(part) for part in parts), tuple(start.memory))
        ddq, motor_ddq = accelerations(plant, state, drive, 0.0, sincos)
        return jnp.concatenate([parts[1], jnp.stack(ddq), parts[3], jnp.array(motor_ddq)])

    x = jnp.concatenate([start.q, start.dq, start.motor_q, start.motor_dq])
    return flow(x), jax.jacfwd(flow)(x)


def longest_step(eigenvalue: complex) -> float:
    """Return the longest step for which RK4 does not amplify a mode, infinite for one that rests.

    >>> round(longest_step(-100.0) * 100.0, 2)
    2.79
    """
    if abs(eigenvalue) < 1e-6:
        return np.inf
    if eigenvalue.real > -1e-9 * abs(eigenvalue):  # growing or undamped: follow it within accuracy
        return 1.0 / abs(eigenvalue)
    radii = np.linspace(0.0, 4.0, 4001)[1:]
    x = radii * (eigenvalue / abs(eigenvalue))
    growth = np.abs(1.0 + x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0))))
    outside = np.flatnonzero(growth > 1.0 + 1e-9)
    return float(radii[outside[0]] / abs(eigenvalue))


def check_step(plant: Plant, q: jax.Array, step: float) -> None:
    """Raise if an RK4 step is too long for the plant at standstill in q (n,).

    Raises:
        InputError: Naming the eigenvalue and the step that would do; also if the mass matrix is
            singular there.
    """
    eigenvalue, longest = fastest_mode(plant, q)
    if step > longest:
        raise InputError(
            f"a step of {step:g} s is too long: the plant has an eigenvalue of {eigenvalue:.4g} 1/s; "
            f"steps up to {longest:.3g} s are stable. Take shorter ones (substeps), or a wider "
            "smooth sign if the eigenvalue is dry friction's."
        )


def stable_substeps(plant: Plant, q: jax.Array, dt: float, *, margin: float = 0.7) -> int:
    """Return how many RK4 steps per sample of dt seconds keep the plant stable at q (n,).

    Args:
        plant: The plant.
        q: (n,), joint positions in rad or m.
        dt: Distance of the samples in s.
        margin: Fraction of the longest stable step to use, in (0, 1).

    Raises:
        InputError: If the mass matrix is singular there.
    """
    _, longest = fastest_mode(plant, q)
    return max(1, int(np.ceil(dt / (margin * longest))))
