"""Small problems with known answers: regressions with drawn columns, and a simulated two-joint log."""

import numpy as np

from jaxswarm.identify.forward.regression import Regression
from jaxswarm.logs.filtering import Decimator
from jaxswarm.logs.motion import Motion
from jaxswarm.robot import inverse_dynamics, robot_from_dh


def make_regression(columns, torque, log=None) -> Regression:
    length, joints, size = columns.shape
    return Regression(
        names=tuple(f"c{k}" for k in range(size)),
        columns=columns,
        torque=torque,
        moving=np.ones((length, joints), bool),
        t=np.arange(length) * 0.01,
        log=np.zeros(length, int) if log is None else log,
        step=(0.01,),
    )


def waves(rng, length, joints, size):
    """Smooth columns, as those of a robot are, (T, n, p)."""
    t = np.arange(length)[:, None, None] * 0.01
    frequency, phase = rng.uniform(0.2, 5.0, (joints, size)), rng.uniform(0, 7, (joints, size))
    return np.sin(2 * np.pi * frequency * t + phase)


def planar_arm():
    """Two links in a vertical plane, with parameters of two slender bodies."""
    links = np.array(
        [
            [2.0, 0.5, 0.02, 0.0, 0.02, 0.0, 0.2, 0.0, 0.0, 0.22],
            [1.0, 0.2, 0.00, 0.0, 0.01, 0.0, 0.07, 0.0, 0.0, 0.08],
        ]
    )
    return robot_from_dh(
        "planar",
        convention="modified",
        alpha=[np.pi / 2, 0.0],
        a=[0.0, 0.4],
        d=[0.0, 0.0],
        parameters=links,
    )


def make_motion(robot, extra=None, length=600, noise=0.0, seed=0, scale=1.0) -> Motion:
    """Analytic motion with the torque of ``robot`` plus ``extra(q, dq, ddq)``, not decimated."""
    import jax

    rng = np.random.default_rng(seed)
    n, t = robot.num_joints, np.arange(length) * 0.01
    amplitude, phase = scale * rng.uniform(0.3, 0.8, (3, n)), rng.uniform(0, 7, (3, n))
    w = 2 * np.pi * np.array([0.31, 0.83, 1.57])[:, None] * rng.uniform(0.8, 1.2, (3, n))
    angle = w * t[:, None, None] + phase
    q = (amplitude * np.sin(angle)).sum(axis=1)
    dq = (amplitude * w * np.cos(angle)).sum(axis=1)
    ddq = -(amplitude * w**2 * np.sin(angle)).sum(axis=1)
    tau = np.array(jax.vmap(lambda *x: inverse_dynamics(robot, *x))(q, dq, ddq))
    tau += 0.0 if extra is None else extra(q, dq, ddq)
    tau += noise * rng.normal(size=tau.shape)
    return Motion(
        source="made",
        joints=robot.joints,
        t=t,
        q=q,
        dq=dq,
        ddq=ddq,
        tau=tau,
        channels={},
        decimator=Decimator(np.ones(1), 1),
        motion_cutoff=(20.0,),
        torque_cutoff=10.0,
        interval=0.01,
        torque_noise=np.full(n, noise),
    )
