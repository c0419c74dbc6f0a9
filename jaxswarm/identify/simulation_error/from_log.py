r"""The estimators for noise in the motion, from logs as users have them, started from least squares.

*Instrumental variables* need a motion without that noise: the commanded one, channel ``q_ref`` of the log.
Columns along it are the instruments; the Durbin-Wu-Hausman test says whether they were needed.

*Output error* compares motions, and a motion under measured torques drifts away without a controller. The
simulation therefore gets the measured torque and a weak pull to the measured position, that of a fixed-gain
observer with :data:`OBSERVER` hertz; above that frequency nothing but the model moves the arm.

References: A. Janot, P.-O. Vandanjon, M. Gautier, IEEE TCST 22(1), 2014; L. Ljung, System Identification,
1999, section 7.2 (predictors with a fixed gain).
"""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.errors import InputError
from jaxswarm.identify.estimation.covariance import correlation_length
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import with_linear_values
from jaxswarm.identify.forward.regression import build_regression
from jaxswarm.identify.forward.uncertainty import Uncertainty
from jaxswarm.identify.simulation_error.exogeneity import exogeneity_test
from jaxswarm.identify.simulation_error.experiment import Experiment, OutputProblem
from jaxswarm.identify.simulation_error.instrumental import instrumental
from jaxswarm.identify.simulation_error.levenberg_marquardt import refine_output
from jaxswarm.identify.simulation_error.output_error import output_residual
from jaxswarm.logs.filtering import derivatives
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.smoothing import smooth
from jaxswarm.robot.mass import mass_matrix
from jaxswarm.simulate.controllers import PD, Reference
from jaxswarm.simulate.plant import make_plant
from jaxswarm.simulate.stability import stable_substeps

REFERENCE = "q_ref"
# Pull of the observer [Hz]: below the motion of an arm (its harmonics lie above), above what drifts.
OBSERVER = 1.0


def by_instruments(found: Estimate) -> tuple[Estimate, dict]:
    """Estimate again with columns along the commanded motion as instruments.

    Returns:
        The estimate, and what the test of least squares says.

    Raises:
        InputError: If a log has no ``q_ref``, or a term is no added torque.
    """
    model, solution = found.model, found.fit
    _refuse_other_kinds(found, "instrumental")
    pi = np.asarray(model.robot.parameters).ravel()
    commanded = [_along_reference(motion) for motion in found.motions]
    along = build_regression(model.robot, model.terms, commanded, model.width, pi)
    kept, size = solution.base.kept, solution.base.size
    sigma = solution.sigma[:, None]
    columns = (found.regression.columns[:, :, kept] / sigma).reshape(-1, size)
    instruments = (along.columns[:, :, kept] / sigma).reshape(-1, size)
    target = (found.regression.target / solution.sigma).ravel()
    new = instrumental(columns, target, instruments)
    test = exogeneity_test(
        columns, target, instruments, effective_samples=solution.effective_samples
    )
    inflation = target.size / solution.effective_samples
    told = {
        "name": "instrumental",
        "instruments": f"columns along {REFERENCE}",
        "least_squares_biased": test.biased,
        "p_value": test.p_value,
        "added_columns": test.num_added,
    }
    return _with(found, new.values, new.std_error * np.sqrt(inflation)), told


def by_output_error(found: Estimate) -> tuple[Estimate, dict]:
    """Estimate again by the difference of simulated and measured motion.

    Returns:
        The estimate, and how the search went.

    Raises:
        InputError: If a term is no added torque, rates of the logs differ, or a simulation diverges.
    """
    _refuse_other_kinds(found, "output_error")
    model, base = found.model, found.fit.base
    robot, motions = model.robot, found.motions
    dt = 1.0 / motions[0].rate
    if any(abs(m.rate * dt - 1.0) > 1e-6 for m in motions):
        raise InputError(
            "output_error needs logs of one rate; fit them one by one, or resample them alike"
        )
    free = tuple(base.names[k] for k in base.kept)
    plant = make_plant(robot, model.terms, width=model.width)
    middle = jnp.asarray(motions[0].q.mean(axis=0))
    inertia = np.diag(np.asarray(mass_matrix(robot, middle)))
    omega = 2.0 * np.pi * OBSERVER
    observer = PD(jnp.asarray(inertia * omega**2), jnp.asarray(2.0 * inertia * omega))
    problem = OutputProblem(
        plant, free, dt, np.ones(robot.num_joints), controller=observer,
        substeps=stable_substeps(plant, middle, dt),
    )  # fmt: skip
    experiments = tuple(_experiment(m) for m in motions)
    start = dict(zip(free, map(float, found.fit.values), strict=True))
    at_start = _residual(problem, start, experiments, motions)
    # Joints count by what least squares leaves of each.
    problem = replace(problem, sigma_q=np.maximum(np.sqrt(np.mean(at_start**2, axis=0)), 1e-9))
    fitted = refine_output(problem, experiments, start)
    left = _residual(problem, fitted.values, experiments, motions)
    log = np.repeat(np.arange(len(motions)), [len(m.t) for m in motions])
    inflation = np.sqrt(correlation_length(left, log))
    told = {
        "name": "output_error",
        "observer_hz": OBSERVER,
        "steps": fitted.num_steps,
        "converged": fitted.converged,
        "position_error_rms": {
            "least_squares": list(np.sqrt(np.mean(at_start**2, axis=0))),
            "output_error": list(np.sqrt(np.mean(left**2, axis=0)) * problem.sigma_q),
        },
    }
    values = np.array([fitted.values[name] for name in free])
    errors = np.array([fitted.std_error[name] for name in free]) * inflation
    return _with(found, values, errors), told


def _residual(problem: OutputProblem, values: dict, experiments, motions) -> np.ndarray:
    """Position errors of all logs in units of ``sigma_q``, (T, n)."""
    x = jnp.asarray([values[name] for name in problem.free])
    flat = np.asarray(output_residual(problem)(x, experiments))
    parts, begin, joints = [], 0, problem.plant.robot.num_joints
    for motion in motions:
        count = len(motion.t) * joints
        part = flat[begin : begin + count].reshape(-1, joints) * np.sqrt(count)
        if not np.isfinite(part).all():
            raise InputError(f"{motion.source}: the simulation diverges; use least_squares")
        parts.append(part)
        begin += count
    return np.concatenate(parts)


def _experiment(motion: Motion) -> Experiment:
    # The simulation holds a torque from sample to sample: that of the middle, or it would be late.
    logged = motion.tau
    assert logged is not None  # without torques nothing is fitted
    held = np.concatenate([0.5 * (logged[1:] + logged[:-1]), logged[-1:]])
    q, dq, ddq, tau = map(jnp.asarray, (motion.q, motion.dq, motion.ddq, held))
    return Experiment(Reference(q, dq, ddq, tau), q, q[0], dq[0])


def _along_reference(motion: Motion) -> Motion:
    """The motion with the commanded one in its place, filtered alike."""
    q = motion.channels.get(REFERENCE)
    if q is None or q.shape != motion.q.shape or not np.isfinite(q).all():
        raise InputError(
            f"{motion.source}: the instrumental estimator needs the commanded positions, one "
            f"{REFERENCE}_<joint> [rad or m] for every joint; log them, or use another estimator"
        )
    q = smooth(q, motion.rate, np.asarray(motion.motion_cutoff))
    dq, ddq = derivatives(q, motion.rate, 2)
    return replace(motion, q=q, dq=dq, ddq=ddq)


def _refuse_other_kinds(found: Estimate, name: str) -> None:
    for term in found.model.terms:
        if not isinstance(term.law, TorqueLaw):
            raise InputError(
                f"{name} fits torques that are added: {term.label(found.model.robot.joints)} changes "
                "the motion or the measurement; use least_squares"
            )


def _with(found: Estimate, values: np.ndarray, std_error: np.ndarray) -> Estimate:
    """The estimate with other values and standard errors of its base parameters."""
    columns = found.regression.columns[:, :, found.fit.base.kept]
    solution = replace(
        found.fit,
        values=values,
        covariance=np.diag(std_error**2),
        residual=found.regression.target - columns @ values,
        at_bound=np.zeros(len(values), bool),
    )
    names = tuple(found.fit.base.names[k] for k in found.fit.base.kept)
    own = dict(zip(names, std_error, strict=True))
    errors = []
    joints = found.model.robot.joints
    for term, old in zip(found.model.terms, found.std_errors, strict=True):
        new = {
            name: float(own[column])
            for name, column in zip(term.linear_names(joints), term.columns(joints), strict=True)
            if column in own
        }
        # What is derived from them was told by the other errors.
        errors.append({n: e for n, e in old.items() if n in term.values} | new)
    model = with_linear_values(found.model, solution.theta)
    model = replace(model, uncertainty=Uncertainty(names, solution.covariance))
    return replace(found, fit=solution, model=model, std_errors=tuple(errors))
