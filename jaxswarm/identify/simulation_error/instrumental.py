r"""Estimators for noise in the regressors: instrumental variables and DIDIM.

Torque is linear in the parameters, y = W theta + e, but W is computed from measured positions and
their derivatives. In closed loop its errors correlate with e, and least squares is biased however long
the log. A simulation of the robot with the current parameters through its controller follows the same
reference without that noise; its columns Z are

* *instruments* for W (IDIM-IV):  solve :math:`Z^T W \theta = Z^T y`, simulate again, repeat;
* the regressor itself (DIDIM):  solve :math:`\min \|Z \theta - y\|`, simulate again, repeat; positions are
  then not needed at all.

Both converge in a few rounds, because high-gain control makes the simulated motion almost independent
of the parameters. Whether W needs them is asked by :mod:`jaxswarm.identify.simulation_error.exogeneity`.

References: A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental variable approach for
industrial robot identification", IEEE TCST 22(1), 2014; M. Gautier, A. Janot, P.-O. Vandanjon, IEEE TCST
21(2), 2013 (DIDIM).
"""

import dataclasses
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.decomposition import thin_svd
from jaxswarm.errors import InputError
from jaxswarm.identify.simulation_error.experiment import Experiment, OutputProblem, plant_with
from jaxswarm.simulate.acceleration import rest
from jaxswarm.simulate.controllers import Reference
from jaxswarm.simulate.rollout import simulate, track


@dataclasses.dataclass(frozen=True)
class LinearEstimate:
    """Linear parameters and how sure they are.

    Attributes:
        values: (p,), estimates.
        std_error: (p,), standard errors for white residuals.
        residual: (r,), y - W values.
        num_rounds: Simulations used.
        converged: Whether the last round changed no value by more than the tolerance allows.
    """

    values: np.ndarray
    std_error: np.ndarray
    residual: np.ndarray
    num_rounds: int = 0
    converged: bool = True


def check_shapes(columns, target, instruments) -> None:
    """Raise InputError unless W (r, p), y (r,) and Z (r, p) have these shapes."""
    if columns.shape != instruments.shape or target.shape != columns.shape[:1]:
        raise InputError(
            f"columns {columns.shape}, target {target.shape} and instruments {instruments.shape} "
            "do not belong together: give (r, p), (r,) and (r, p)."
        )


def instrumental(
    columns: np.ndarray, target: np.ndarray, instruments: np.ndarray
) -> LinearEstimate:
    """Solve Z^T W theta = Z^T y through an orthogonal basis of Z.

    Args:
        columns: W, (r, p), computed from the log; rows weighted like the target.
        target: y, (r,).
        instruments: Z, (r, p), the same columns from a simulation, weighted likewise.

    Raises:
        InputError: If shapes differ or the instruments leave a parameter undetermined.

    >>> w = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
    >>> instrumental(w, w @ [2.0, 3.0], w).values.round(9).tolist()
    [2.0, 3.0]
    """
    check_shapes(columns, target, instruments)
    basis = np.linalg.qr(instruments)[0]
    square = basis.T @ columns
    singular = thin_svd(square / np.linalg.norm(columns, axis=0))[1]
    if not singular[-1] > 1e-10:
        raise InputError(
            "the instruments leave a parameter undetermined: reduce the columns to base parameters "
            "or excite the joints more."
        )
    values = np.linalg.solve(square, basis.T @ target)
    residual = target - columns @ values
    sigma = np.linalg.norm(residual) / np.sqrt(max(len(target) - len(values), 1))
    spread = np.linalg.inv(square)
    return LinearEstimate(values, sigma * np.linalg.norm(spread, axis=1), residual)


def idim_iv(
    simulate: Callable[[np.ndarray], np.ndarray],
    columns: np.ndarray,
    target: np.ndarray,
    start: np.ndarray,
    *,
    num_rounds: int = 10,
    tolerance: float = 1e-4,
) -> LinearEstimate:
    """Estimate by instruments from simulations with the current parameters.

    Args:
        simulate: ``simulate(values (p,)) -> Z (r, p)``: simulates with these parameters and filters,
            decimates and weights the result as W and y were; see :func:`simulated_columns`.
        columns: W, (r, p).
        target: y, (r,).
        start: (p,), parameters of the first simulation; CAD values are safer than a biased fit, which may
            make the loop diverge.
        num_rounds: Largest number of simulations, >= 1.
        tolerance: Change between rounds, in units of the norm of the values, at which it stops.

    Raises:
        InputError: If a simulation diverges, or as :func:`instrumental`.
    """

    def estimate(instruments):
        return instrumental(columns, target, instruments)

    return _rounds(simulate, estimate, start, num_rounds, tolerance)


def didim(
    simulate: Callable[[np.ndarray], np.ndarray],
    target: np.ndarray,
    start: np.ndarray,
    *,
    num_rounds: int = 20,
    tolerance: float = 1e-4,
) -> LinearEstimate:
    """Estimate by least squares on the columns of the simulated motion; arguments of :func:`idim_iv`."""

    def estimate(instruments):
        return instrumental(instruments, target, instruments)

    return _rounds(simulate, estimate, start, num_rounds, tolerance)


def simulated_columns(
    problem: OutputProblem,
    experiment: Experiment,
    columns: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray],
) -> Callable[[np.ndarray], np.ndarray]:
    """Return the ``simulate`` that :func:`idim_iv` and :func:`didim` need, for one log.

    Args:
        problem: Plant, controller and rates; its free names are the p parameters, in column order.
        experiment: Reference (or torques) and start of the log.
        columns: ``columns(q, dq, ddq) -> (r, p)``, each (T, n); the treatment W had.
    """

    @jax.jit
    def follow(values):
        plant = plant_with(problem.plant, problem.free, list(values))
        start = rest(plant, experiment.start_q, experiment.start_dq)
        options = {"dt": problem.dt, "substeps": problem.substeps, "external": experiment.external}
        if problem.controller is None:
            return simulate(plant, start, experiment.drive, hold=problem.hold, **options)
        reference = Reference(*experiment.drive)
        options["control_dt"] = problem.control_dt
        return track(plant, start, problem.controller, reference, **options)

    def run(values):
        motion = follow(jnp.asarray(values))
        return np.asarray(columns(*(np.asarray(x) for x in (motion.q, motion.dq, motion.ddq))))

    return run


def _rounds(simulate, estimate, start, num_rounds, tolerance) -> LinearEstimate:
    values = np.asarray(start, float)
    for count in range(1, num_rounds + 1):
        instruments = np.asarray(simulate(values))
        if not np.isfinite(instruments).all():
            raise InputError(
                f"the simulation of round {count} diverges with values {np.round(values, 6).tolist()}"
                ": start closer, or check gains and sampling of the controller."
            )
        found = estimate(instruments)
        change = np.linalg.norm(found.values - values) / np.linalg.norm(found.values)
        values = found.values
        if change < tolerance:
            break
    return dataclasses.replace(found, num_rounds=count, converged=bool(change < tolerance))
