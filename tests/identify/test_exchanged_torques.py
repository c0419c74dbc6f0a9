"""Exchanged torques of joints that move alike and are far apart in size: each guess has weights of its own."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.identify.checks.channels import wrong_channels
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import fine_samples, samples_of
from jaxswarm.identify.synthetic import random_links
from jaxswarm.logs import Log, log_from_arrays
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.robot.load import load_robot
from jaxswarm.robot.logged import rigid_columns

ARM = load_robot("ur10e")
SECONDS = 10.0


def log_of(light: float, seed: int) -> Log:
    """A log of an arm whose last link is light and moves as the one before it."""
    rng = np.random.default_rng(seed)
    links = random_links(ARM, np.random.default_rng(0), mass=20.0)
    links[5:] *= light
    t = np.arange(0.0, SECONDS, 0.01)[:, None, None]
    rate = 2.0 * np.pi * np.array([0.2, 0.3, 0.5])
    size, phase = rng.uniform(0.2, 0.6, (6, 3)), rng.uniform(0.0, 6.3, (6, 3))
    size[5], phase[5] = 1.3 * size[4], phase[4]
    angle = rate * t + phase
    q, dq, ddq = (
        (size * x).sum(axis=2)
        for x in (np.sin(angle), rate * np.cos(angle), -(rate**2) * np.sin(angle))
    )
    friction = np.array([4.0, 4.0, 3.0, 2.0, 1.0, light])
    tau = rigid_columns(ARM, q, dq, ddq) @ links.ravel() + friction * (np.tanh(dq / 0.02) + dq)
    tau += 0.01 * tau.std(axis=0) * rng.normal(size=tau.shape)
    q += 2e-5 * rng.normal(size=q.shape)
    return log_from_arrays(t.ravel(), q, tau, joints=ARM.joints)


@pytest.mark.parametrize(("light", "seed"), [(1e-2, 1), (1e-3, 0), (1e-3, 1)])
def test_a_weak_joint_does_not_hide_an_exchange(light, seed):
    log, order = log_of(light, seed), [0, 1, 2, 3, 5, 4]
    for tau, expected in ((log.tau[:, order], "swapped_channels"), (log.tau, None)):
        _, motions = prepare_segments(replace(log, tau=tau), Filtering(torque_cutoff=5.0))
        rough, fine = (Rough(ARM, made(motions)) for made in (samples_of, fine_samples))
        found = wrong_channels(ARM, rough, lambda fine=fine: fine)
        assert (found and found.check) == expected
        assert found is None or "the torques of joint5 and joint6 are exchanged" in found.what
