r"""Gauss-Newton on what the columns depend on: nonlinear parameters and the width of the smooth sign.

Linear parameters are eliminated at every step (variable projection, G. H. Golub, V. Pereyra, Inverse
Problems 19 (2003)): the tangents :math:`\partial W(\nu)/\partial\nu\;\theta` are further columns beside W,
and solving for both gives the step, and in the end the standard errors of all parameters together.
"""

from dataclasses import dataclass

import numpy as np

from jaxswarm.identify.estimation.factors import compress, triangular_factor
from jaxswarm.identify.estimation.free_parameters import (
    FreeParameter,
    Place,
    read,
    tangents,
    with_values,
    write,
)
from jaxswarm.identify.estimation.least_squares import Solved, weighted_cost
from jaxswarm.identify.estimation.measured_start import measured_start
from jaxswarm.identify.estimation.newton_step import step_within
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.forward.body import moves_links
from jaxswarm.identify.forward.finite_columns import Diverged
from jaxswarm.identify.forward.measuring_chain import uses_load
from jaxswarm.identify.forward.regression import Regression

# Rounds of refitting where the load or the lag of a soft joint depends on the fit itself.
_ROUNDS, _STEPS = 6, 8
# Part of the cost that a further round has to promise, a tenth of what ends the search for the free ones: half
# the rounds of a backlash promised nothing, and each built the model three times to find no less.
_PROMISED = 1e-6


@dataclass(frozen=True)
class Settled:
    """A fit at a place.

    Attributes:
        place: Nonlinear parameters and widths.
        solution: The linear ones.
        regression: The rows that they solve.
        theta: Linear parameters of the model, (p,): where its columns bend, those that they were built with and
            not those of the solution, which may be a step too far.
        residual: What the model leaves, (T, n), with these.
    """

    place: Place
    solution: Solved
    regression: Regression
    theta: np.ndarray
    residual: np.ndarray

    @property
    def pi(self) -> np.ndarray:
        """The rigid ones of the linear parameters, (10 n,)."""
        return self.theta[: 10 * self.regression.torque.shape[1]]


def settle(
    problem: Problem, place: Place, start: np.ndarray, near: np.ndarray | None = None
) -> Settled:
    """Fit, and fit again where columns depend on the rigid parameters, until those stand still.

    Where a drive distorts its torque that leads nowhere from a model whose torque crosses zero elsewhere: then
    it is done from the measured torque too, and what leaves less stays.

    Args:
        problem: What is fitted.
        place: Nonlinear parameters and widths.
        start: Linear parameters to start from: all of a model near by, (p,), or the rigid ones, (10 n,).
        near: Weights of a fit near by, (n,).
    """
    rigid = 10 * problem.robot.num_joints
    pi = start[:rigid]
    regression = problem.build(place, pi)
    solution = problem.solve(place.terms, regression, near)
    if not uses_load(place.terms) and not moves_links(place.terms):
        return Settled(place, solution, regression, solution.theta, solution.residual)
    stand = np.concatenate([start, solution.theta[len(start) :]])
    found = _settled(problem, Settled(place, solution, regression, stand, solution.residual), stand)
    begin = measured_start(problem, place, pi)
    if begin is None:
        return found
    sigma, told = solution.sigma, with_values(place, begin[rigid:], problem.robot.joints)
    there = _attempt(problem.build, told, begin[:rigid])
    if there is None:
        return found
    solution = problem.solve(told.terms, there, sigma)
    other = Settled(told, solution, there, begin, solution.residual)
    other = _settled(problem, other, begin)
    costs = [weighted_cost(one.residual, sigma) for one in (found, other)]
    return other if costs[1] < costs[0] else found


def _settled(problem: Problem, here: Settled, stand: np.ndarray) -> Settled:
    """The fit from linear parameters (p,) with which the rows were built.

    A step that makes the model itself worse, not its linearization, is shortened.
    """
    rigid = len(here.pi)
    place, solution, regression = here.place, here.solution, here.regression
    theta = solution.theta
    small = 1e-6 * np.abs(regression.torque).max()
    for _ in range(_ROUNDS):
        sigma, step = solution.sigma, theta - stand
        if np.abs(regression.columns @ step).max() < small:
            return Settled(place, solution, regression, theta, solution.residual)
        before = _true_cost(regression, stand, sigma)
        if before - weighted_cost(solution.residual, sigma) < _PROMISED * before:
            break
        for part in (1.0, 0.3, 0.1):
            trial = stand + part * step
            told = with_values(place, trial[rigid:], problem.robot.joints)
            # Most are turned down, and columns take several times as long as the torque.
            if not _cost_of(problem.left(regression, told, trial), sigma) < before:
                continue
            there = _attempt(problem.build, told, trial[:rigid])
            if there is not None:
                break
        else:
            break
        place, regression, stand = told, there, trial
        solution = problem.solve(place.terms, regression, solution.sigma)
        theta = solution.theta
    # What the linearization promises further on is not what the model does.
    residual = regression.target - regression.columns @ stand
    return Settled(place, solution, regression, stand, residual)


def _attempt(build, *at):
    """What ``build(*at)`` gives; None where the model leaves the finite numbers: no place to go to."""
    try:
        return build(*at)
    except Diverged:
        return None


def _cost_of(left: np.ndarray, sigma: np.ndarray) -> float:
    """Weighted squares of what a model leaves (T, n); infinite where that is not finite, or NaN."""
    with np.errstate(over="ignore", invalid="ignore"):
        return weighted_cost(left, sigma)


def _true_cost(regression: Regression, theta: np.ndarray, sigma: np.ndarray) -> float:
    """Weighted squares that a model leaves whose rigid parameters the columns were made with."""
    return weighted_cost(regression.target - regression.columns @ theta, sigma)


def newton(problem: Problem, moving: list[FreeParameter], here: Settled) -> Settled:
    """Gauss-Newton steps of the free parameters, if any; a step that does not pay is shortened.

    A step stays within the parameters' bounds, and is the best there. Cut off at a bound afterwards, where
    others had been told to go with what was cut, a quarter of the steps led to a worse model: nine tenths of
    them came to nothing.
    """
    if not moving:
        return here
    cost = weighted_cost(here.residual, here.solution.sigma)
    for _ in range(_STEPS):
        sigma = here.solution.sigma
        position = read(here.place, moving)
        triangle = tangent_factor(problem, moving, here)
        step, promised = step_within(triangle, position)
        if promised < _PROMISED * cost:
            break
        for shrink in (1.0, 0.3, 0.1):
            trial = write(here.place, moving, position + shrink * step)
            there = None  # its columns go before others are made
            there = _attempt(settle, problem, trial, here.theta, sigma)
            new = np.inf if there is None else weighted_cost(there.residual, sigma)
            if new < cost * (1 - 1e-7):
                break
        else:
            break
        gain = 1 - new / cost
        here = there
        cost = weighted_cost(here.residual, here.solution.sigma)
        if gain < 1e-5:
            break
    return here


def tangent_factor(problem: Problem, moving: list[FreeParameter], here: Settled) -> np.ndarray:
    """Triangular factor of the weighted base columns, the free parameters' tangents and what is left."""
    solution, regression = here.solution, here.regression
    slopes = tangents(
        lambda place, free: problem.output(place, here.pi, here.theta, free),
        here.place,
        moving,
    )
    slopes = regression.counted(slopes)
    # Joint by joint, so that no weighted copy of all rows is made.
    factors = []
    for j, sigma in enumerate(solution.sigma):
        kept = regression.columns[:, j, solution.base.kept]
        factors.append(compress(np.hstack([kept, slopes[:, j]]), here.residual[:, j]) / sigma)
    # What is known before asks for no step: where the log tells a link's place from its masses by nothing, that
    # drew it to its bound.
    others = factors[0].shape[1] - solution.base.size
    known = np.pad(solution.prior, ((0, 0), (0, others)))
    return triangular_factor(np.concatenate([*factors, known]))
