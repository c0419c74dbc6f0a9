"""The RX60's three links through RK4: the general tree against a closed form written by hand.

Joint 1 turns about the vertical; joints 2 and 3 turn about parallel horizontal axes, so everything
depends on q2 and q2 + q3 only. With J the inertia of a link about its frame's origin and (x, y, z) the
first moment of link 3, rotated into the vertical plane as (X, Y), L = 0.29 m and d = 0.049 m:

    M11 = Jzz1 + P2(q2) + P3(q2 + q3) + m3 (d^2 + L^2 c2^2) + 2 (d z + L c2 X)
    M12 = Q2(q2) + Q3(q2 + q3) - m3 L d s2 - d Y - L s2 z,    M13 = Q3(q2 + q3) - d Y
    M22 = Jzz2 + Jzz3 + m3 L^2 + 2 k,   M23 = Jzz3 + k,   M33 = Jzz3,   k = L (x c3 - y s3)
    P = Jxx s^2 + 2 Jxy s c + Jyy c^2,   Q = Jxz s + Jyz c

and the Coriolis forces are their derivatives. Every particle has its own first moment and inertias of
link 3, both candidates the same ones; ``check`` compares their final states.
"""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.dynamics_two_link import rk4
from jaxswarm.identify.simulation_error.experiment import plant_with
from jaxswarm.robot import Robot, in_blocks
from jaxswarm.robot.spatial import settle
from jaxswarm.simulate import make_plant, open_loop, polynomial_sincos, rest

L, D, GRAVITY = 0.29, 0.049, 9.81
FREE = ("mx3", "my3", "Ixx3", "Izz3")
COLUMNS = (21, 22, 24, 29)  # of the free parameters among the 30


def closed_accelerations(parameters, q, w, tau):
    """Return the three accelerations from 30 link parameters (numbers or lanes) and the state."""
    (jzz1,) = parameters[9:10]
    _, x2, y2, _, xx2, xy2, yy2, xz2, yz2, zz2 = parameters[10:20]
    m3, x3, y3, z3, xx3, xy3, yy3, xz3, yz3, zz3 = parameters[20:30]
    w1, w2, w3 = w
    (s2, c2), (s, c) = polynomial_sincos(q[1]), polynomial_sincos(q[1] + q[2])
    cos3, sin3 = c * c2 + s * s2, s * c2 - c * s2
    x, y = x3 * c - y3 * s, x3 * s + y3 * c
    k, k3 = L * (x3 * cos3 - y3 * sin3), -L * (x3 * sin3 + y3 * cos3)
    p2 = xx2 * s2 * s2 + 2.0 * xy2 * s2 * c2 + yy2 * c2 * c2
    p3 = xx3 * s * s + 2.0 * xy3 * s * c + yy3 * c * c
    p2_slope = 2.0 * (xx2 - yy2) * s2 * c2 + 2.0 * xy2 * (c2 * c2 - s2 * s2)
    p3_slope = 2.0 * (xx3 - yy3) * s * c + 2.0 * xy3 * (c * c - s * s)
    q3, q3_slope = xz3 * s + yz3 * c, xz3 * c - yz3 * s
    # Settled like the general tree's: XLA would compute them again for each of the three rows.
    x, y, k, k3, p3_slope, q3_slope = settle((x, y, k, k3, p3_slope, q3_slope))
    m11 = jzz1 + p2 + p3 + m3 * (D * D + L * L * c2 * c2) + 2.0 * (D * z3 + L * c2 * x)
    m13 = q3 - D * y
    m12 = xz2 * s2 + yz2 * c2 + m13 - L * s2 * (m3 * D + z3)
    m22, m23, m33 = zz2 + zz3 + m3 * L * L + 2.0 * k, zz3 + k, zz3
    a3 = p3_slope - 2.0 * L * c2 * y
    a2 = p2_slope + a3 - 2.0 * L * s2 * (m3 * L * c2 + x)
    b3 = q3_slope - D * x
    b2 = xz2 * c2 - yz2 * s2 + b3 - L * c2 * (m3 * D + z3)
    weight = GRAVITY * x
    n1 = tau[0] - (a2 * w2 + a3 * w3) * w1 - (b2 * w2 + b3 * w3) * w2 - b3 * (w2 + w3) * w3
    n2 = tau[1] - k3 * w3 * (2.0 * w2 + w3) + 0.5 * a2 * w1 * w1
    n2 = n2 - GRAVITY * (x2 * c2 - y2 * s2 + m3 * L * c2) - weight
    n3 = tau[2] + 0.5 * a3 * w1 * w1 + k3 * w2 * w2 - weight
    m11, m12, m13, m22, m23, n1, n2, n3 = settle((m11, m12, m13, m22, m23, n1, n2, n3))
    # M = L D L^T, from the last joint to the first.
    inverse3 = 1.0 / m33
    l2, l1 = m23 * inverse3, m13 * inverse3
    d2 = 1.0 / (m22 - l2 * m23)
    e12 = m12 - l1 * m23
    l12 = e12 * d2
    d1 = 1.0 / (m11 - l1 * m13 - l12 * e12)
    r2 = n2 - l2 * n3
    acceleration1 = (n1 - l1 * n3 - l12 * r2) * d1
    acceleration2 = r2 * d2 - l12 * acceleration1
    acceleration3 = n3 * inverse3 - l2 * acceleration2 - l1 * acceleration1
    return settle((acceleration1, acceleration2, acceleration3))


def rx60_candidates(
    robot: Robot, dt: float, steps: int, particles: int
) -> dict[str, tuple[Callable[[], object], int]]:
    """Return name -> (call, particle-steps of one call); the general tree first."""
    rng = np.random.default_rng(0)
    scale = jnp.asarray(1.0 + 0.2 * rng.random(particles))
    tau = jnp.asarray(0.1 * rng.normal(size=(steps, 3)))
    nominal = [float(x) for x in np.ravel(robot.parameters)]
    plant = make_plant(robot)

    def general(scale, tau):
        lanes = plant_with(plant, FREE, [nominal[i] * scale for i in COLUMNS])
        loop = open_loop(tau, dt=dt)
        begin = loop.begin(rest(plant, jnp.zeros((3, scale.shape[0]))))
        end, _ = jax.lax.scan(lambda x, u: (loop.advance(lanes, x, u)[0], None), begin, loop.inputs)
        return jnp.stack([*end[0].q, *end[0].dq])

    def closed(scale, tau):
        parameters = [x * scale if i in COLUMNS else x for i, x in enumerate(nominal)]

        def step(x, u):
            def flow(x):
                return (*x[3:], *closed_accelerations(parameters, x[:3], x[3:], u))

            return rk4(flow, x, dt), None

        return jnp.stack(jax.lax.scan(step, (jnp.zeros_like(scale),) * 6, tau)[0])

    calls = {}
    for name, function in (("general tree", general), ("closed form", closed)):
        run = jax.jit(lambda scale, tau, f=function: in_blocks(f, scale, tau))
        calls[f"RX60, {name}"] = (lambda run=run: run(scale, tau), particles * steps)
    return calls


def check(calls: dict[str, tuple[Callable[[], object], int]]) -> float:
    """Return the largest difference of the candidates' final states."""
    ends = [np.asarray(call()) for call, _ in calls.values()]
    return float(max(np.abs(end - ends[0]).max() for end in ends))
