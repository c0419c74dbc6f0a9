"""Noise in the regressors biases least squares; instruments and DIDIM are not, and the test tells."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.identify.simulation_error.exogeneity import exogeneity_test
from jaxswarm.identify.simulation_error.experiment import Experiment, OutputProblem
from jaxswarm.identify.simulation_error.instrumental import (
    didim,
    idim_iv,
    instrumental,
    simulated_columns,
)
from jaxswarm.robot import Joint, build_robot, regressor
from jaxswarm.robot.placements import body_parameters, rotation_x
from jaxswarm.simulate import PD, Acting, Reference, make_plant, rest, track

FREE = ("mx1", "Izz1", "b_joint1:viscous_friction")
TRUTH = np.array([0.6, 0.5, 0.8])
DT = 2e-3


class Log:
    """A closed-loop run whose encoder noise also passes through the controller."""

    def __init__(self, noise: float):
        rng = np.random.default_rng(0)
        body = body_parameters(2.0, [0.3, 0.0, 0.0], np.diag([0.1, 0.1, 0.32]))
        robot = build_robot(
            "arm", [Joint("joint1", rotation=rotation_x(np.pi / 2), parameters=body)]
        )
        plant = make_plant(robot, [Acting("viscous_friction", 0, values={"b": 0.8})])
        t = DT * np.arange(3000)[:, None]
        wave = np.sin(2 * t) + 0.3 * np.sin(5 * t)
        speed = 2 * np.cos(2 * t) + 1.5 * np.cos(5 * t)
        reference = Reference(wave, speed, 0 * t, 0 * t)
        controller = PD(kp=300.0, kd=25.0)
        start = (jnp.zeros(1), jnp.array(speed[0]))
        # Encoder noise enters the command as kp times itself.
        error = noise * rng.normal(size=t.shape)
        disturbed = reference._replace(q=reference.q - error)
        motion = jax.jit(lambda r: track(plant, rest(plant, *start), controller, r, dt=DT))(
            disturbed
        )
        q = np.asarray(motion.q) + error
        dq = np.gradient(q, DT, axis=0)
        ddq = np.gradient(dq, DT, axis=0)
        row = jax.jit(jax.vmap(lambda *s: regressor(robot, *s)))
        inner = slice(10, -10)

        def columns(q, dq, ddq):
            rigid = np.asarray(row(q, dq, ddq))[:, 0, :]
            return np.c_[rigid[:, [1, 9]], dq][inner]

        self.columns, self.target = columns(q, dq, ddq), np.asarray(motion.tau)[inner, 0]
        problem = OutputProblem(plant, FREE, DT, np.ones(1), controller=controller)
        drive = Experiment(reference, motion.q, *start)
        self.simulate = simulated_columns(problem, drive, columns)


@pytest.fixture(scope="module")
def noisy():
    return Log(noise=2e-4)


@pytest.fixture(scope="module")
def clean():
    return Log(noise=0.0)


def relative(values):
    return np.abs(np.asarray(values) / TRUTH - 1.0).max()


def test_instruments_remove_the_bias_of_least_squares(noisy):
    biased = np.linalg.lstsq(noisy.columns, noisy.target, rcond=None)[0]
    found = idim_iv(noisy.simulate, noisy.columns, noisy.target, 0.7 * TRUTH)
    assert found.converged and found.num_rounds <= 6
    assert relative(biased) > 0.1
    assert relative(found.values) < 0.03
    assert (np.abs(found.values - TRUTH) < 4.0 * found.std_error).all()


def test_didim_needs_no_positions(noisy):
    found = didim(noisy.simulate, noisy.target, 0.7 * TRUTH)
    assert found.converged
    assert relative(found.values) < 0.03


def test_exogeneity_is_rejected_with_noise_and_kept_without(noisy, clean):
    told = exogeneity_test(noisy.columns, noisy.target, noisy.simulate(TRUTH))
    assert told.biased and told.p_value < 1e-6
    rng = np.random.default_rng(1)
    torque = clean.target + 0.3 * rng.normal(size=clean.target.shape)
    told = exogeneity_test(clean.columns, torque, clean.simulate(TRUTH))
    assert not told.biased and told.num_added > 0


def test_false_alarms_are_as_rare_as_the_level(clean):
    rng = np.random.default_rng(2)
    instruments = clean.simulate(TRUTH)[::20]
    columns = instruments + 0.05 * rng.normal(size=instruments.shape)
    alarms = 0
    for _ in range(400):
        target = columns @ TRUTH + rng.normal(size=len(columns))
        alarms += exogeneity_test(columns, target, instruments, level=0.05).biased
    assert 6 <= alarms <= 36  # 20 expected


def test_shapes_and_dead_instruments_are_refused():
    w = np.ones((5, 2)) * [1.0, 2.0]
    with pytest.raises(InputError, match="undetermined"):
        instrumental(w, np.ones(5), w)
    with pytest.raises(InputError, match="do not belong together"):
        instrumental(w, np.ones(4), w)
