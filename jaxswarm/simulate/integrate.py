r"""One step of the classical fourth-order Runge-Kutta method, with memories carried exponentially.

Positions and velocities follow RK4. The state of a law with memory (a Dahl bristle) can be far
stiffer than the mechanics, so at every stage it is advanced from the start of the step by an
exponential formula with that stage's motion,

.. math:: z(c h) = z_0 + c h\, \varphi_1(c h a)\, \dot z(z_0), \qquad a = \partial \dot z / \partial z,

which is exact for a rate linear in z at constant velocity and stable for every step.

Reference: E. Hairer, S. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 1993, section
II.1; M. Hochbruck, A. Ostermann, Acta Numerica 2010, eq. 2.17.
"""

from collections.abc import Callable

import jax
import jax.numpy as jnp

from jaxswarm.effects.series import grown
from jaxswarm.robot.kinematics import SinCos
from jaxswarm.simulate.acceleration import Drive, State, accelerations, motor_side
from jaxswarm.simulate.forces import own_memory, sample_of
from jaxswarm.simulate.plant import Plant


def rk4_step(
    plant: Plant,
    state: State,
    drive: Callable[[float], Drive],
    t,
    h,
    sincos: SinCos,
) -> State:
    """Return the state after one step of length h.

    Args:
        plant: The plant.
        state: Tuples of entries.
        drive: What acts at the fraction c of the step, 0 <= c <= 1.
        t: Time at the start in s.
        h: Length of the step in s.
        sincos: Function that gives sine and cosine of an angle.
    """

    def stage(carry, numbers):
        before, total = carry
        c, weight = numbers
        at = _ahead(plant, state, before, drive(c), t, c * h)
        ddq, motor_ddq = accelerations(plant, at, drive(c), t + c * h, sincos)
        now = (at.dq, tuple(ddq), at.motor_dq, tuple(motor_ddq))
        now = jax.tree.map(lambda a, b: jnp.broadcast_to(a, b.shape), now, total)
        return (now, jax.tree.map(lambda a, b: a + weight * b, total, now)), None

    # A loop over the four stages: one copy of the dynamics to compile instead of four.
    still = jax.tree.map(jnp.zeros_like, tuple(state[:4]))
    numbers = (jnp.array([0.0, 0.5, 0.5, 1.0]), jnp.array([1.0, 2.0, 2.0, 1.0]) / 6.0)
    numbers = jax.tree.map(lambda x: x.astype(state.q[0].dtype), numbers)
    (_, mean), _ = jax.lax.scan(stage, (still, still), numbers)
    return _ahead(plant, state, mean, drive(1.0), t, h)


def _ahead(plant: Plant, start: State, slopes: tuple, drive: Drive, t, h) -> State:
    """State a time h after the start of the step, moving with these slopes."""
    moved = jax.tree.map(lambda x, dx: x + h * dx, tuple(start[:4]), slopes)
    now = start._replace(**dict(zip(State._fields[:4], moved, strict=True)), memory=())
    return now._replace(memory=_memory(plant, start, now, drive, t, h))


def _memory(plant: Plant, start: State, now: State, drive: Drive, t, h) -> tuple:
    """Memories a time h after the start of the step, with the mean motion since then."""
    if not plant.remembering:
        return ()
    q0, dq0 = motor_side(plant, start)
    q1, dq1 = motor_side(plant, now)
    q = [0.5 * (a + b) for a, b in zip(q0, q1, strict=True)]
    dq = [0.5 * (a + b) for a, b in zip(dq0, dq1, strict=True)]
    result = []
    entries = iter(start.memory)
    for acting in plant.remembering:
        law, values = acting.law, acting.values
        z = own_memory(law, entries)
        sample = sample_of(plant, acting, q, dq, t, drive.temperature)

        def rate(z, law=law, values=values, sample=sample):
            return law.rate(values, sample._replace(state=z))

        result += jax.tree.leaves(grown(law, rate, z, h))
    return tuple(result)
