"""A planar two-link arm through RK4 in several ways: candidates of ``benchmarks/dynamics.py``.

H11 = a + 2 e cos q2, H12 = b + e cos q2, H22 = b, with Coriolis terms of e sin q2 and gravity; every
particle has its own a, b, e. The general tree gets the same arm as link parameters. For output error
the value of a particle is the mean squared difference of its joint angles from measured ones.
"""

import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.identify.physical.export import export_mjcf
from jaxswarm.identify.simulation_error.experiment import Experiment, OutputProblem, plant_with
from jaxswarm.identify.simulation_error.output_error import output_fitness
from jaxswarm.robot import Joint, Robot, build_robot, in_blocks
from jaxswarm.robot.placements import body_parameters
from jaxswarm.robot.spatial import settle
from jaxswarm.simulate import make_plant, open_loop, polynomial_sincos, rest

PARTICLES = 5000
GRAVITY = 9.81
LENGTH = 1.0


def arm() -> Robot:
    """Return the arm in a vertical plane: z axes horizontal, gravity along -y."""
    body = body_parameters(2.0, [0.5, 0.0, 0.0], np.diag([0.0, 0.15, 0.15]) + 1e-3 * np.eye(3))
    place = np.array([LENGTH, 0.0, 0.0])
    joints = [
        Joint("joint1", parameters=body),
        Joint("joint2", parent="joint1", translation=place, parameters=body),
    ]
    return build_robot("two_link", joints, gravity=(0.0, -GRAVITY, 0.0))


def two_link_candidates(dt: float, steps: int) -> dict[str, tuple[Callable[[], object], int]]:
    """Return name -> (call, particle-steps of one call); ours first."""
    rng = np.random.default_rng(0)
    scale = jnp.asarray(1.0 + 0.2 * rng.random(PARTICLES))
    tau = jnp.asarray(0.1 * rng.normal(size=(steps, 2)))
    few = PARTICLES // 10
    work = PARTICLES * steps
    calls: dict[str, tuple[Callable[[], object], int]] = {
        "general tree, blocks": (_general(scale, tau, dt, blocks=True), work),
        "general tree, all lanes": (_general(scale, tau, dt, blocks=False), work),
        "closed form, blocks": (_closed(scale, tau, dt), work),
        "plain vmap, solve, jnp.sin": (_plain(scale, tau, dt), work),
        "mujoco rollout": (_mujoco(few, steps, dt), few * steps),
    }
    try:
        calls["diffrax, same stages"] = (_diffrax(scale, tau, dt), work)
    except ImportError:
        print("diffrax is not installed: its rows are left out")
    return calls


def output_error_candidates(dt: float, steps: int) -> dict[str, tuple[Callable[[], object], int]]:
    """Return name -> (call that gives the values, particle-steps of one call); ours first."""
    rng = np.random.default_rng(0)
    scale = jnp.asarray(1.0 + 0.2 * rng.random(PARTICLES))
    tau = jnp.asarray(0.1 * rng.normal(size=(steps, 2)))
    measured = jnp.asarray(0.01 * rng.normal(size=(steps, 2)))
    plant = make_plant(arm())
    problem = OutputProblem(plant, FREE, dt, sigma_q=np.ones(2))
    fitness = jax.jit(output_fitness(problem))
    params = {name: value * scale for name, value in zip(FREE, _nominal(plant), strict=True)}
    log = (Experiment(tau, measured, jnp.zeros(2), jnp.zeros(2)),)
    calls = {"output error": (lambda: fitness(params, log), PARTICLES * steps)}
    try:
        calls["diffrax output error"] = (_diffrax(scale, tau, dt, measured), PARTICLES * steps)
    except ImportError:
        pass
    return calls


FREE = ("mx2", "Izz2", "Izz1")


def _nominal(plant) -> list[float]:
    return [float(plant.robot.parameters[i, k]) for i, k in ((1, 1), (1, 9), (0, 9))]


def _general(scale, tau, dt, blocks):
    plant = make_plant(arm())

    def run(scale, tau):
        lanes = plant_with(plant, FREE, [value * scale for value in _nominal(plant)])
        loop = open_loop(tau, dt=dt)
        start = loop.begin(rest(plant, jnp.zeros((2, scale.shape[0]))))

        def body(carry, sample):
            return loop.advance(lanes, carry, sample)[0], None

        return jnp.stack([*jax.lax.scan(body, start, loop.inputs)[0][0].q])

    call = jax.jit(lambda scale, tau: in_blocks(run, scale, tau) if blocks else run(scale, tau))
    return lambda: call(scale, tau)


def _constants(scale):
    m2x, i2, i1, m2 = 1.0 * scale, 0.651 * scale, 0.651 * scale, 2.0
    e = m2x * LENGTH
    return i1 + i2 + m2 * LENGTH**2, i2, e, (1.0 + m2 * LENGTH) * GRAVITY, m2x * GRAVITY


def _accelerations(constants, q1, q2, w1, w2, tau, sincos):
    a, b, e, g1, g2 = constants
    s2, c2 = sincos(q2)
    h11, h12 = a + 2.0 * e * c2, b + e * c2
    weight = g2 * sincos(q1 + q2)[1]
    n1 = tau[0] + e * s2 * w2 * (2.0 * w1 + w2) - g1 * sincos(q1)[1] - weight
    n2 = tau[1] - e * s2 * w1 * w1 - weight
    scale = 1.0 / (h11 * b - h12 * h12)
    return (b * n1 - h12 * n2) * scale, (h11 * n2 - h12 * n1) * scale


def rk4(flow, x, dt):
    """Return the state after one step of the classical Runge-Kutta method."""

    def ahead(k, h):
        return jax.tree.map(lambda x, k: x + h * k, x, k)

    k1 = flow(x)
    k2 = flow(ahead(k1, 0.5 * dt))
    k3 = flow(ahead(k2, 0.5 * dt))
    k4 = flow(ahead(k3, dt))
    return jax.tree.map(
        lambda x, a, b, c, d: x + dt / 6.0 * (a + 2.0 * (b + c) + d), x, k1, k2, k3, k4
    )


def _closed(scale, tau, dt):
    def run(scale, tau):
        constants = _constants(scale)

        def step(x, u):
            def flow(x):
                return (x[2], x[3], *settle(_accelerations(constants, *x, u, polynomial_sincos)))

            return rk4(flow, x, dt), None

        return jnp.stack(jax.lax.scan(step, (jnp.zeros_like(scale),) * 4, tau)[0][:2])

    call = jax.jit(lambda scale, tau: in_blocks(run, scale, tau))
    return lambda: call(scale, tau)


def _vector_field(constants, x, u):
    """The textbook's matrices for one particle: state (4,), a linear solve, library sine."""
    a, b, e, g1, g2 = constants
    q1, q2, w1, w2 = x
    c2, s2 = jnp.cos(q2), jnp.sin(q2)
    mass = jnp.array([[a + 2.0 * e * c2, b + e * c2], [b + e * c2, b]])
    coriolis = jnp.array([-e * s2 * w2 * (2.0 * w1 + w2), e * s2 * w1 * w1])
    weight = g2 * jnp.cos(q1 + q2)
    gravity = jnp.array([g1 * jnp.cos(q1) + weight, weight])
    return jnp.concatenate([x[2:], jnp.linalg.solve(mass, u - coriolis - gravity)])


def _plain(scale, tau, dt):
    @jax.jit
    def run(scale, tau):
        def one(scale):
            constants = _constants(scale)

            def step(x, u):
                return rk4(lambda x: _vector_field(constants, x, u), x, dt), None

            return jax.lax.scan(step, jnp.zeros(4), tau)[0]

        return jax.vmap(one)(scale)

    return lambda: run(scale, tau)


def _diffrax(scale, tau, dt, measured=None):
    import diffrax

    class RK4(diffrax.AbstractERK):
        """The classical tableau, which diffrax does not ship."""

        tableau = diffrax.ButcherTableau(
            c=np.array([0.5, 0.5, 1.0]),
            a_lower=(np.array([0.5]), np.array([0.0, 0.5]), np.array([0.0, 0.0, 1.0])),
            b_sol=np.array([1.0, 2.0, 2.0, 1.0]) / 6.0,
            b_error=np.zeros(4),
        )
        interpolation_cls = diffrax.ThirdOrderHermitePolynomialInterpolation.from_k

        def order(self, terms):
            return 4

    @jax.jit
    def run(scale, tau):
        def one(scale):
            constants = _constants(scale)
            hold = (tau.shape[0] - 1) / (tau.shape[0] * dt)

            def field(t, x, args):
                return _vector_field(constants, x, tau[(t * hold).astype(int)])

            count = tau.shape[0]
            sampled = {} if measured is None else {"ts": jnp.arange(count) * dt}
            motion = diffrax.diffeqsolve(
                diffrax.ODETerm(field),
                RK4(),
                0.0,
                count * dt,
                dt,
                jnp.zeros(4),
                saveat=diffrax.SaveAt(**(sampled or {"t1": True})),
                max_steps=count + 1,
                adjoint=diffrax.ForwardMode(),
            ).ys
            return motion if measured is None else jnp.mean((motion[:, :2] - measured) ** 2)

        return jax.vmap(one)(scale)

    return lambda: run(scale, tau)


def _mujoco(particles: int, steps: int, dt: float):
    import mujoco
    from mujoco import rollout

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.xml"
        export_mjcf(arm(), path)
        model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.timestep = dt
    datas = [mujoco.MjData(model) for _ in range(os.cpu_count() or 1)]
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    start, control = np.zeros((particles, size)), np.zeros((particles, steps, model.nu))
    return lambda: rollout.rollout(model, datas, start, control)[0][:1]
