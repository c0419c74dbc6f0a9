r"""Logs with a known truth: an arm with random physical links, a random Fourier motion, effects and noise.

The motion is prescribed and the torque follows from the inverse dynamics and the laws, so a log costs
milliseconds. Joint j moves as :math:`q_j = q_{0j} + \sum_l a_l \sin(2\pi l f t) + b_l \cos(2\pi l f t)`
(J. Swevers et al., IEEE T-RO 13 (1997)). Effects that move the links (joint elasticity, backlash) need the
forward simulation of :mod:`jaxswarm.simulate` and are left to it.
"""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.examples import one_of_each, usual_friction
from jaxswarm.effects.kinds import TransmissionLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.logs.filtering import Decimator
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import Filtering, Motion
from jaxswarm.robot.model import Robot


@dataclass(frozen=True)
class Noise:
    """Standard deviations of white noise on position [rad] and torque [N m], per joint or one for all."""

    position: float = 2e-5
    torque: float | tuple[float, ...] = 0.2


def random_links(robot: Robot, rng: np.random.Generator, mass: float = 10.0) -> np.ndarray:
    """Physical inertial parameters (n, 10): each link a cloud of ten point masses."""
    links = []
    for k in range(robot.num_joints):
        m = rng.uniform(0.2, 1.0, 10)
        m *= mass * 0.6**k / m.sum()
        x = rng.normal(size=(10, 3)) * 0.08 + rng.uniform(-0.15, 0.25, 3)
        first = m @ x
        second = np.einsum("p,pi,pj->ij", m, x, x)
        inertia = np.trace(second) * np.eye(3) - second
        links.append([m.sum(), *first, *inertia[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]])
    return np.array(links)


def fourier_motion(
    joints: int,
    rng: np.random.Generator,
    duration: float = 20.0,
    rate: float = 250.0,
    speed: float = 2.0,
    harmonics: int = 8,
    base: float = 0.1,
) -> tuple[np.ndarray, ...]:
    """Random Fourier motion: t (T,), q, dq, ddq (T, n), with the given top speed [rad/s] per joint."""
    t = np.arange(int(duration * rate)) / rate
    omega = 2 * np.pi * base * np.arange(1, harmonics + 1)
    wave, slope = np.sin(np.outer(t, omega)), np.cos(np.outer(t, omega))
    a, b = rng.normal(size=(2, harmonics, joints)) / np.sqrt(omega)[:, None]
    dq = (slope * omega) @ a - (wave * omega) @ b
    size = speed / np.abs(dq).max(axis=0)
    a, b = a * size, b * size
    q = wave @ a + slope @ b + rng.uniform(-0.5, 0.5, joints)
    dq = (slope * omega) @ a - (wave * omega) @ b
    ddq = -(wave * omega**2) @ a - (slope * omega**2) @ b
    return t, q, dq, ddq


def synthetic_log(
    robot: Robot,
    terms: tuple[Term, ...],
    seed: int,
    *,
    noise: Noise | None = None,
    width: float = 0.01,
    duration: float = 20.0,
    motion_seed: int | None = None,
    rate: float = 250.0,
    moved: tuple[np.ndarray, ...] | None = None,
) -> Log:
    """A log of ``robot`` (with its parameters) and ``terms`` (with values).

    Args:
        robot: With link parameters.
        terms: Effects in the log; none that moves the links apart from the motors.
        seed: Seed of the noise, and of the motion if that has none of its own.
        noise: Sensor noise.
        width: Width of the smooth sign [rad/s].
        duration: Length [s].
        motion_seed: Seed of the motion.
        rate: Sampling rate [Hz].
        moved: The motion itself, as :func:`fourier_motion` gives one at that rate; None: one is drawn.

    Returns:
        The log; channel ``tau_clean`` is the torque without noise.

    Raises:
        ValueError: If a term moves the links.
    """
    if of_kind(terms, TransmissionLaw):
        raise ValueError(
            "links behind their motors need the forward simulation of jaxswarm.simulate"
        )
    noise = noise or Noise()
    rng = np.random.default_rng(seed)
    moving = rng if motion_seed is None else np.random.default_rng(motion_seed)
    t, q, dq, ddq = moved or fourier_motion(robot.num_joints, moving, duration, rate)
    motion = _exact_motion(robot, f"synthetic {robot.name}, seed {seed}", rate, t, q, dq, ddq)
    model = Model(robot, terms, (width,) * robot.num_joints, Filtering(), (1.0,) * robot.num_joints)
    clean = model_torque(model, motion)
    return Log(
        source=motion.source,
        joints=robot.joints,
        t=t,
        q=q + rng.normal(size=q.shape) * noise.position,
        tau=clean + rng.normal(size=q.shape) * np.asarray(noise.torque),
        channels={"tau_clean": clean},
    )


def demo_case(robot: Robot, seed: int) -> tuple[Robot, tuple[Term, ...], tuple[Term, ...]]:
    """An arm, what is declared, and an undeclared effect drawn from the catalog by the seed."""
    rng = np.random.default_rng(seed)
    n = robot.num_joints
    arm = robot.replace(parameters=jnp.asarray(random_links(robot, rng)))
    declared = usual_friction(rng, n)
    joint = int(rng.integers(n))
    catalog = one_of_each(joint, (joint + 1) % n)
    hidden = catalog[int(rng.integers(len(catalog)))]
    # Joint 1 of an upright arm carries no gravity: what depends on the load is put elsewhere.
    if hidden.law.uses_load and joint == 0:
        hidden = Term(hidden.effect, 1, values=hidden.values)
    return arm, declared, (hidden,)


def _exact_motion(robot: Robot, source: str, rate: float, t, q, dq, ddq) -> Motion:
    """A motion (T,), (T, n) at a rate [Hz] that nothing was measured of and no filter has changed."""
    return Motion(
        source=source,
        joints=robot.joints,
        t=t,
        q=q,
        dq=dq,
        ddq=ddq,
        tau=None,
        channels={},
        decimator=Decimator(np.ones(1), 1),
        motion_cutoff=(np.inf,) * robot.num_joints,
        torque_cutoff=np.inf,
        interval=1.0 / rate,
        torque_noise=None,
    )
