"""A filter that all torques pass makes no joint's torque late by itself, however noisy the other's is."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.effects.term import Term
from jaxswarm.effects.torque_lag import lag
from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.identify.checks.late import _WITHOUT_NOISE, _apart
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import samples_of
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.robot.load import load_robot

RATE, TC, LATE, NOISE = 100.0, 0.03, 0.02, (6.0, 0.01)
FRICTION = tuple(
    Term(effect, joint, values={name: value})
    for joint, size in enumerate((4.0, 1.0))
    for effect, name, value in (
        ("viscous_friction", "b", size),
        ("coulomb_friction", "fc", size),
    )
)
TWO = """
name = "two"
[[joint]]
name = "first"
[[joint]]
name = "second"
xyz = [0.4, 0.0, 0.0]
rpy = [1.5707963267948966, 0.0, 0.0]
"""


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "two.toml"
    path.write_text(TWO)
    bare = load_robot(path)
    return bare.replace(parameters=random_links(bare, np.random.default_rng(0)))


def written(arm, change):
    """A log whose torques without noise are changed before the first joint's large noise is added."""
    log = synthetic_log(arm, FRICTION, 3, noise=Noise(2e-5, 0.0), rate=RATE, duration=50.0)
    rng = np.random.default_rng(5)
    return replace(log, tau=change(log) + rng.normal(size=log.tau.shape) * np.array(NOISE))


def filtered(log):
    return np.asarray(lag(log.tau, TC, 1.0 / RATE))


def second_late(log):
    return np.stack([log.tau[:, 0], np.interp(log.t - LATE, log.t, log.tau[:, 1])], axis=1)


@pytest.mark.parametrize(
    ("change", "told", "least", "most"),
    [(filtered, [], 0.0, _WITHOUT_NOISE), (second_late, ["late_torque"], 0.9, 1.3)],
)
def test_noise_hides_a_delay_of_one_joint_alone_from_its_own_derivative(
    arm, change, told, least, most
):
    """The first joint, mostly noise, tells 10 of the filter's 30 ms: the second one was refused as late."""
    motions = prepare_segments(written(arm, change), Filtering())[1]
    model = Rough(arm, samples_of(motions))
    sigma = model.as_logged()[1]
    apart, without = (
        _apart(model.lateness(sigma))[1],
        _apart(model.lateness_without_noise(sigma))[1],
    )
    assert apart > 0.012 and least < without / apart < most
    assert [one.check for one in against_robot(arm, motions)] == told
