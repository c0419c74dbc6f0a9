"""Torques of motors before their gears are told with the scale that leaves least."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.effects.term import Term
from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.robot import robot_from_dh


def found(arm, log):
    bare = arm.replace(parameters=np.zeros((6, 10)))  # masses alone would tell the unit
    return against_robot(bare, prepare_segments(log, Filtering(torque_cutoff=5.0))[1])


@pytest.mark.parametrize("gear", [30.0, 160.0])
def test_a_gear_between_powers_of_ten_is_told(arm, log, gear):
    finding, *_ = found(arm, replace(log, tau=log.tau / np.array([1, 1, gear, 1, 1, 1])))
    assert finding.check == "torque_scale" and finding.refused
    told = finding.what.removeprefix("the torque of joint3 is ").split(" times")[0]
    assert float(told) == pytest.approx(gear, rel=0.15)


def test_scales_of_several_torques_are_told_at_once(arm, log):
    scales = np.array([1.0, 1.0, 1.0, 40.0, 9.0, 0.1])
    finding, *_ = found(arm, replace(log, tau=log.tau / scales))
    assert finding.check == "torque_scale" and "and all times one number" in finding.what
    told = finding.what.split("about ")[1].split(", and all")[0].split(", ")
    ratio = np.array([float(one.split()[1]) for one in told]) / scales
    np.testing.assert_allclose(ratio[:5] / ratio[0], 1.0, rtol=0.4)


@pytest.mark.parametrize("friction", [3.0, 10.0])
def test_joints_that_move_together_trade_what_one_lacks_until_that_has_settled(friction):
    """Friction by the position was refused as a torque of twice what is logged, and as a late one."""
    bare = robot_from_dh(
        "small", convention="modified", alpha=[np.pi / 2, 0.3], a=[0.0, 0.35], d=[0.0, 0.1]
    )
    links = random_links(bare, np.random.default_rng(0), mass=6.0)
    small = bare.replace(parameters=jnp.asarray(links))
    worn = {"sine": friction, "cosine": 0.3 * friction, "n": 1.9}
    terms = [Term("position_dependent_friction", 1, values=worn)]
    for joint, size in enumerate((3.0, 1.5)):
        terms.append(Term("viscous_friction", joint, values={"b": size}))
        terms.append(Term("coulomb_friction", joint, values={"fc": size}))
    t = np.arange(0.0, 12.0, 1.0 / 125.0)
    wave = 0.5 * np.stack([np.sin(t), np.cos(t), -np.sin(t)])
    q, dq, ddq = np.repeat(wave[:, :, None], 2, axis=2)
    q[:, 0] += 0.6 * t
    dq[:, 0] += 0.6
    moved = (t, q, dq, ddq)
    log = synthetic_log(small, tuple(terms), 1, noise=Noise(2e-5, 1e-2), moved=moved)
    assert against_robot(small, prepare_segments(log, Filtering(20.0, 10.0))[1]) == []
