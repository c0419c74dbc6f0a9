"""How certain a fit is of all columns and of its free parameters, and how far held ones would move."""

from dataclasses import replace

import numpy as np

from jaxswarm.identify.estimation.free_parameters import FreeParameter, tangents
from jaxswarm.identify.estimation.gauss_newton import Settled, tangent_factor
from jaxswarm.identify.estimation.least_squares import Fit, fit, with_doubt
from jaxswarm.identify.estimation.newton_step import REACH, step_anywhere
from jaxswarm.identify.estimation.problem import Problem


def apart_from(
    problem: Problem, held: list[FreeParameter], here: Settled
) -> tuple[np.ndarray, np.ndarray]:
    """How far parameters would move from where they are held, and the standard errors, (m,) each.

    Positions both, such as those of single joints' widths from the one that they share.
    """
    told = _fit_beside(problem, held, here, here.theta)
    error = np.sqrt(np.diag(_on_all(told))[-len(held) :])
    if any(one.stepwise for one in held):
        # What tells of the doubt looks beyond the steps, and leads nowhere.
        return step_anywhere(tangent_factor(problem, held, here), len(held)), error
    return np.clip(told.theta[-len(held) :], -REACH, REACH), error


def covariance_of(
    problem: Problem, moving: list[FreeParameter], here: Settled, theta: np.ndarray
) -> np.ndarray:
    """Covariance (p + m, p + m) of all columns and of free parameters' positions; NaN where inseparable."""
    if moving:
        return _on_all(_fit_beside(problem, moving, here, theta))
    return _on_all(with_doubt(here.solution, here.regression))


def _fit_beside(
    problem: Problem, moving: list[FreeParameter], here: Settled, theta: np.ndarray
) -> Fit:
    """What is left, fitted once more with the tangents of free parameters beside all columns (p + m)."""
    regression, pi = here.regression, theta[: len(here.pi)]
    slopes = tangents(
        lambda place, free: problem.output(place, pi, theta, free),
        here.place,
        moving,
        wide=True,
    )
    beside = replace(
        regression,
        names=(*regression.names, *(f"{m.name}:{m.term}:{m.joints}" for m in moving)),
        columns=np.concatenate([regression.columns, regression.counted(slopes)], axis=2),
        torque=here.residual,
        shift=None,
    )
    return fit(beside, sigma=here.solution.sigma)


def _on_all(told: Fit) -> np.ndarray:
    """Covariance of all columns; NaN of those that are not apart from others."""
    names, kept = told.base.names, told.base.kept
    covariance = np.full((len(names), len(names)), np.nan)
    covariance[np.ix_(kept, kept)] = told.covariance
    return covariance
