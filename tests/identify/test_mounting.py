"""A base on a wall or under a ceiling that is declared on the floor is told, with the gravity to pass."""

from types import SimpleNamespace

import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.identify.checks import mounting
from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.identify.checks.mounting import MOUNTING, mounting_guesses
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import samples_of
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.robot.load import load_robot
from jaxswarm.robot.options import RobotOptions

WALL, CEILING, EDGE = (9.81, 0.0, 0.0), (0.0, 0.0, 9.81), (0.0, -6.937, -6.937)


def motions(robot):
    log = synthetic_log(robot, (), 3, noise=Noise(2e-5, 0.05), duration=20.0, rate=125.0)
    return prepare_segments(log, Filtering(torque_cutoff=5.0))[1]


@pytest.mark.parametrize("gravity", [WALL, CEILING, EDGE])
def test_how_the_base_is_mounted_is_told_with_the_gravity_to_pass(arm, gravity):
    (found,) = against_robot(arm, motions(arm.replace(gravity=jnp.array(gravity))))
    assert found.check == MOUNTING and found.refused
    told = found.remedy.removeprefix("Pass --gravity ").split(", or")[0].split(",")
    np.testing.assert_allclose([float(x) for x in told], gravity, atol=0.01)


@pytest.mark.parametrize("gravity", [WALL, CEILING, EDGE])
def test_a_base_that_is_mounted_as_declared_is_not(arm, gravity):
    declared = arm.replace(gravity=jnp.array(gravity))
    assert against_robot(declared, motions(declared)) == []


def test_where_gravity_as_declared_turns_no_joint_the_log_is_not_refused():
    """A law of the positions may pull on a level arm as another gravity would."""
    bare = load_robot("ur10e", RobotOptions(joints=("joint1",)))
    level = bare.replace(parameters=random_links(bare, np.random.default_rng(0), mass=20.0))
    upright = level.replace(gravity=jnp.array(WALL))
    (found,) = against_robot(level, motions(upright))
    assert found.check == MOUNTING and not found.refused


def test_without_gravity_nothing_is_asked(arm):
    afloat = arm.replace(gravity=jnp.zeros(3))
    rough = Rough(afloat, samples_of(motions(afloat)))
    assert list(mounting_guesses(afloat, rough, rough.as_logged()[0])) == []


@pytest.mark.parametrize(
    ("change", "told"),
    [((-1.5, -0.5, 0.1), True), ((-1.0, -0.4, 0.5), False), ((-1.0, 0.0, 0.0), True)],
)
def test_a_direction_by_which_other_joints_lose_is_none(arm, monkeypatch, change, told):
    """Friction that was missing about an upright axis was told as a base on its edge, 2.6 % being left."""
    logged = Tried(np.array([0.07, 0.02, 0.04]), np.ones(3))

    def rough(robot, samples):
        other = robot.gravity[0] > 9.0
        left = logged.left * np.exp(change) if other else logged.left
        return SimpleNamespace(as_logged=lambda: (Tried(left, logged.braking), None))

    monkeypatch.setattr(mounting, "Rough", rough)
    samples = samples_of(motions(arm))
    found = list(mounting_guesses(arm, SimpleNamespace(samples=samples), logged))
    assert bool(found) is told
