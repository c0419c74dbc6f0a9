"""Output error: the truth is found from positions, in open and closed loop, and lanes stay apart."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.identify.simulation_error.experiment import (
    Experiment,
    OutputProblem,
    free_names,
    start_names,
)
from jaxswarm.identify.simulation_error.levenberg_marquardt import refine_output
from jaxswarm.identify.simulation_error.output_error import output_fitness, output_residual
from jaxswarm.robot import Joint, build_robot
from jaxswarm.robot.placements import body_parameters, rotation_x
from jaxswarm.simulate import PD, Acting, Reference, make_plant, rest, simulate, track
from jaxswarm.swarm import Space, gpso, minimize

FREE = ("mx1", "Izz1", "b_joint1:viscous_friction")
TRUTH = dict(zip(FREE, (0.6, 0.5, 0.8), strict=True))
DT = 5e-3


@pytest.fixture(scope="module")
def plant():
    body = body_parameters(2.0, [0.3, 0.0, 0.0], np.diag([0.1, 0.1, 0.32]))
    robot = build_robot("arm", [Joint("joint1", rotation=rotation_x(np.pi / 2), parameters=body)])
    assert abs(robot.parameters[0, 9] - 0.5) < 1e-12
    return make_plant(robot, [Acting("viscous_friction", 0, values={"b": 0.8})])


def open_experiment(plant, start):
    tau = 6.0 * jnp.sin(4.0 * DT * jnp.arange(200))[:, None]
    motion = simulate(plant, rest(plant, jnp.array([start])), tau, dt=DT)
    return Experiment(tau, motion.q, jnp.array([start]), jnp.zeros(1))


@pytest.fixture(scope="module")
def experiments(plant):
    return (open_experiment(plant, 0.0), open_experiment(plant, -1.0))


@pytest.fixture(scope="module")
def problem(plant):
    return OutputProblem(plant, FREE, DT, sigma_q=np.array([1e-3]))


def test_fitness_is_zero_at_the_truth_and_infinite_for_lanes_that_diverge(problem, experiments):
    lanes = {name: jnp.array([value, 1.2 * value, value]) for name, value in TRUTH.items()}
    lanes["Izz1"] = lanes["Izz1"].at[2].set(-0.5)
    value = jax.jit(output_fitness(problem))(lanes, experiments)
    assert value[0] < 1e-18
    assert np.isfinite(value[1]) and value[1] > 100.0
    assert value[2] == np.inf


@pytest.mark.parametrize("effect", ["joint_elasticity", "hysteresis", "stribeck_friction"])
@pytest.mark.parametrize("closed", [False, True])
def test_whatever_acts_the_population_runs_in_blocks(plant, effect, closed):
    """An effect or a controller written with more than arithmetic would fall back to all lanes."""
    terms = [Acting(effect, 0), Acting("rotor_inertia", 0, values={"ia": 0.1})]
    t = jnp.zeros((4, 1))
    problem = OutputProblem(
        make_plant(plant.robot, terms),
        ("mx1",),
        DT,
        np.ones(1),
        controller=PD(kp=1.0, kd=1.0) if closed else None,
        free_start=True,
    )
    drive = Reference(t, t, t, t) if closed else t
    log = (Experiment(drive, t, jnp.zeros(1), jnp.zeros(1)),)
    lanes = {name: jnp.ones(70) for name in ("mx1", *start_names(problem, 1))}
    program = jax.jit(output_fitness(problem)).lower(lanes, log).as_text()
    assert "xla_cpu_small_call" in program


def test_residual_and_fitness_agree(problem, experiments):
    values = jnp.array([0.5, 0.6, 0.7])
    lanes = {name: v[None] for name, v in zip(FREE, values, strict=True)}
    fitness = output_fitness(problem)(lanes, experiments)[0]
    residual = output_residual(problem)(values, experiments)
    assert abs(residual @ residual / 2 - fitness) < 1e-9 * fitness


def test_refinement_from_a_swarm_finds_the_truth(problem, experiments):
    space = Space.from_arrays(FREE, [0.1, 0.1, 0.0], [2.0, 2.0, 3.0])
    fitness = output_fitness(problem)
    best = minimize(
        fitness, gpso(24), space, jax.random.key(1), experiments, num_steps=15, vectorized=True
    )
    start = {name: float(best.params[name]) for name in FREE}
    fit = refine_output(problem, experiments, start)
    assert fit.converged
    for name, value in TRUTH.items():
        assert abs(fit.values[name] - value) < 1e-6


def test_standard_errors_are_those_of_the_noise(problem, experiments):
    """Noise of 1 mrad on the positions: estimates within four standard errors, which are small."""
    rng = np.random.default_rng(0)
    noisy = tuple(e._replace(q=e.q + 1e-3 * rng.normal(size=e.q.shape)) for e in experiments)
    fit = refine_output(problem, noisy, TRUTH)
    for name, value in TRUTH.items():
        assert abs(fit.values[name] - value) < 4.0 * fit.std_error[name] < 0.02
    assert abs(fit.value - 2.0) < 0.3  # one for each experiment


def test_wrong_starts_of_several_logs_are_found_with_the_parameters(plant, experiments):
    """Two logs whose stated starts are off by their own error; fixed starts bias the parameters."""
    errors = {"q0_joint1@0": 0.05, "dq0_joint1@0": -0.2, "q0_joint1@1": -0.1, "dq0_joint1@1": 0.3}
    wrong = tuple(
        e._replace(
            start_q=e.start_q - errors[f"q0_joint1@{k}"],
            start_dq=e.start_dq - errors[f"dq0_joint1@{k}"],
        )
        for k, e in enumerate(experiments)
    )
    problem = OutputProblem(plant, FREE, DT, np.array([1e-3]), free_start=True)
    assert start_names(problem, 2) == tuple(errors)
    fit = refine_output(problem, wrong, {name: 1.1 * value for name, value in TRUTH.items()})
    for name, value in {**TRUTH, **errors}.items():
        assert abs(fit.values[name] - value) < 1e-6, name
    fixed = refine_output(dataclasses.replace(problem, free_start=False), wrong, TRUTH)
    assert max(abs(fixed.values[name] - TRUTH[name]) for name in FREE) > 0.01
    lanes = {name: jnp.full(3, value) for name, value in fit.values.items()}
    lanes["q0_joint1@1"] = lanes["q0_joint1@1"].at[1].add(0.01)
    value = jax.jit(output_fitness(problem))(lanes, wrong)
    assert value[0] < 1e-6 and value[1] > 1.0 and value[2] == value[0]


def test_closed_loop_through_the_known_controller(plant):
    t = DT * np.arange(300)[:, None]
    reference = Reference(np.sin(3 * t), 3 * np.cos(3 * t), 0 * t, 0 * t)
    controller = PD(kp=60.0, kd=6.0, limit=40.0)
    motion = track(plant, rest(plant, jnp.zeros(1)), controller, reference, dt=DT)
    e = Experiment(reference, motion.q, jnp.zeros(1), jnp.zeros(1), dq=motion.dq)
    problem = OutputProblem(
        plant, FREE, DT, np.array([1e-3]), sigma_dq=np.array([1e-2]), controller=controller
    )
    fit = refine_output(problem, (e,), {name: 1.3 * value for name, value in TRUTH.items()})
    for name, value in TRUTH.items():
        assert abs(fit.values[name] - value) < 1e-6


def test_bad_problems_are_refused(plant, experiments):
    assert "b_joint1:viscous_friction" in free_names(plant)
    with pytest.raises(InputError, match="Did you mean Izz1"):
        output_fitness(OutputProblem(plant, ("Izz",), DT, np.ones(1)))
    dead = OutputProblem(plant, (*FREE, "Ixx1"), DT, np.ones(1))
    with pytest.raises(InputError, match="Ixx1 changes nothing"):
        refine_output(dead, experiments, {**TRUTH, "Ixx1": 0.1})
    with pytest.raises(InputError, match="no start for mx1"):
        refine_output(OutputProblem(plant, FREE, DT, np.ones(1)), experiments, {"Izz1": 1.0})
