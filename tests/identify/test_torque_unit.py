"""Torques in another unit are told by the masses of the robot's file where it has any."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.effects.examples import usual_friction
from jaxswarm.identify.checks.samples import Samples
from jaxswarm.identify.checks.torque_unit import wrong_unit
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import robot_from_dh


def small_arm(mass):
    """Two links of 0.1 m, as of a desktop arm, whose torques are a fraction of a newton meter."""
    bare = robot_from_dh(
        "desktop", convention="modified", alpha=[np.pi / 2, 0.0], a=[0.0, 0.1], d=[0.0, 0.05]
    )
    links = random_links(bare, np.random.default_rng(0), mass=mass)
    return bare.replace(parameters=jnp.asarray(links))


def samples_of(arm, factor):
    friction = tuple(
        replace(t, values={k: 0.02 * v for k, v in t.values.items()})
        for t in usual_friction(np.random.default_rng(1), 2)
    )
    log = synthetic_log(arm, friction, 0, noise=Noise(0.0, 0.0), duration=8.0, rate=125.0)
    motion = prepare(log)
    torque = factor * motion.tau
    return Samples(motion.t, motion.q, motion.dq, motion.ddq, torque, np.gradient(torque, axis=0))


@pytest.mark.parametrize("factor", [1.0, 1e3, 1e-3])
def test_millinewton_meters_on_a_small_arm(factor):
    arm = small_arm(0.3)
    told = wrong_unit(arm, samples_of(arm, factor))
    assert (told is None) == (factor == 1.0)
    if told is not None:
        assert "masses in the robot's file" in told.what and "N m" in told.remedy


def test_links_whose_axes_meet_move_no_tons():
    """A kilogram in each of their joints needs no torque at all."""
    bare = robot_from_dh(
        "wrist", convention="modified", alpha=[0.0, np.pi / 2], a=[0.0, 0.0], d=[0.6, 0.0]
    )
    links = random_links(bare, np.random.default_rng(2), mass=3.0)
    samples = samples_of(bare.replace(parameters=jnp.asarray(links)), 1.0)
    assert wrong_unit(bare, samples) is None
    told = wrong_unit(bare, replace(samples, tau=1e3 * samples.tau))
    assert told is not None and "links of" in told.what
