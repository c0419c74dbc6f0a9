"""From a robot, declared terms and logs to an identified model: rigid body, laws, width of the sign."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.identify.estimation.free_parameters import FreeParameter, Place, free_parameters
from jaxswarm.identify.estimation.gauss_newton import (
    Problem,
    Settled,
    newton,
    settle,
    standard_errors,
)
from jaxswarm.identify.estimation.least_squares import Fit
from jaxswarm.identify.estimation.sign_width import best_width, width_range
from jaxswarm.identify.forward.columns import Rigid, rigid_of
from jaxswarm.identify.forward.link_lag import flank_compression
from jaxswarm.identify.forward.measuring_chain import tilted
from jaxswarm.identify.forward.model import Model, linear_values
from jaxswarm.identify.forward.regression import Regression
from jaxswarm.logs.motion import Filtering, Motion
from jaxswarm.robot.model import Robot


@dataclass(frozen=True)
class Estimate:
    """An identified model with the problem it solves.

    Attributes:
        model: Robot and terms with values.
        fit: The least-squares solution, tangents of nonlinear parameters included in its covariance.
        regression: Its rows.
        motions: The logs, as used.
        rigids: Rigid-body columns of every log in nominal gravity and motion.
        std_errors: Standard error of every term parameter, one dictionary per term; NaN where a
            parameter cannot be told from others.
    """

    model: Model
    fit: Fit
    regression: Regression
    motions: tuple[Motion, ...]
    rigids: tuple[Rigid, ...]
    std_errors: tuple[dict[str, float], ...]


def estimate(
    robot: Robot,
    terms: tuple[Term, ...],
    motions: Sequence[Motion],
    *,
    width: float | None = None,
    bounded: bool = True,
    rigids: Sequence[Rigid] | None = None,
    refine_width: bool | None = None,
    start: np.ndarray | None = None,
) -> Estimate:
    """Identify the rigid body and the parameters of ``terms`` on one or several logs.

    Args:
        robot: Kinematics; its parameters are not used.
        terms: Declared laws; nonlinear parameters start at their values, else at the nominal ones.
        motions: Prepared logs with torque.
        width: Width of the smooth sign [rad/s]; None: the one that fits best.
        refine_width: Whether the width is fitted with the rest; None: where it is not given.
        bounded: Whether physical bounds (friction not below zero) hold.
        rigids: Rigid-body columns of the logs where they are known.
        start: Rigid parameters to start from, (10 n,), where loads or soft joints need some.

    Raises:
        InputError: If a log lacks torque or there are too few samples.
    """
    for motion in motions:
        if motion.tau is None:
            raise InputError(
                f"{motion.source}: has no torque to identify from; add tau_<joint> or current_<joint>"
            )
    terms = tuple(
        replace(t, values={**{p.name: p.nominal for p in t.law.nonlinear}, **t.values})
        for t in terms
    )
    if rigids is None:
        rigids = [rigid_of(robot, m) for m in motions]
    if refine_width is None:
        refine_width = width is None
    if width is None:
        width = best_width(robot, terms, motions, rigids)
    lower, upper = width_range(motions)
    # A sign that is sharper than any sample shows has no width to fit.
    seen = any(t.law.uses_direction for t in terms) and lower < width < upper
    problem = Problem(robot, tuple(motions), tuple(rigids), bounded)
    pi = np.zeros(10 * robot.num_joints) if start is None else start
    here = settle(problem, Place(terms, width), pi)
    moving = free_parameters(terms, (lower, upper) if refine_width and seen else None)
    if moving:
        here = newton(problem, moving, here)
    return _finish(problem, here, moving)


def _finish(problem: Problem, here: Settled, moving: list[FreeParameter]) -> Estimate:
    """The estimate with values and standard errors by name."""
    robot, theta = problem.robot, here.solution.theta
    first = problem.motions[0]
    filtering = Filtering(first.motion_cutoff, first.torque_cutoff, skew=first.skew)
    named = [t.linear_names(robot.joints) for t in here.place.terms]
    split = np.cumsum([10 * robot.num_joints, *(len(names) for names in named)])
    parts = np.split(theta, split)[1:]
    terms = tuple(
        replace(t, values={**t.values, **dict(zip(names, map(float, own), strict=True))})
        for t, names, own in zip(here.place.terms, named, parts, strict=False)
    )
    model = Model(
        robot.replace(parameters=jnp.asarray(here.pi.reshape(-1, 10))),
        terms,
        here.place.width,
        filtering,
        tuple(map(float, here.solution.sigma)),
    )
    placed = replace(here, place=Place(terms, here.place.width))
    columns, positions = standard_errors(problem, moving, placed, linear_values(model))
    errors = [
        dict(zip(names, map(float, own), strict=True))
        for names, own in zip(named, np.split(columns, split)[1:], strict=False)
    ]
    for free, error in zip(moving, positions, strict=True):
        if free.term is not None:
            slope = free.parameter.slope(terms[free.term].values[free.name])
            errors[free.term][free.name] = float(error * slope)
    for term, own in zip(terms, errors, strict=True):
        pressed = flank_compression(tilted(robot, terms), term, first, here.pi, problem.rigids[0])
        if pressed:
            own["gap"] = float(np.hypot(own["gap"], pressed))
    return Estimate(
        model, here.solution, here.regression, problem.motions, problem.rigids, tuple(errors)
    )
