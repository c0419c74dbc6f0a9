"""From a robot, declared terms and logs to an identified model: rigid body, laws, width of the sign."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.events import with_event_torques
from jaxswarm.identify.estimation.free_parameters import (
    FreeParameter,
    Place,
    free_parameters,
    width_parameter,
)
from jaxswarm.identify.estimation.gauss_newton import (
    Problem,
    Settled,
    newton,
    settle,
    standard_errors,
    widths_apart,
)
from jaxswarm.identify.estimation.least_squares import Fit, weighted_cost
from jaxswarm.identify.estimation.own_widths import apart, told_by_the_others
from jaxswarm.identify.estimation.sign_width import best_widths, width_groups, width_range
from jaxswarm.identify.estimation.usable import check_usable
from jaxswarm.identify.forward.body import tilted
from jaxswarm.identify.forward.columns import Rigid, rigid_of
from jaxswarm.identify.forward.link_lag import flank_compression
from jaxswarm.identify.forward.model import Model, linear_values
from jaxswarm.identify.forward.regression import Regression
from jaxswarm.identify.forward.uncertainty import Uncertainty
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot

# What a log tells of a width by less than two standard errors it hardly tells: their square over the rows.
_HARDLY_TOLD = 4.0


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
    width: float | tuple[float, ...] | None = None,
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
        width: Width of every joint's smooth sign [rad/s or m/s], one or one per joint; None: those that
            fit best.
        refine_width: Whether the widths are fitted with the rest; None: where they are not given.
        bounded: Whether physical bounds (friction not below zero) hold.
        rigids: Rigid-body columns of the logs where they are known.
        start: Rigid parameters to start from, (10 n,), where loads or soft joints need some.

    Raises:
        InputError: If the logs cannot be used for these terms, or there are too few samples.
        Diverged: If the model's torque is not finite along a log, as where a link runs away.
    """
    check_usable(terms, motions)
    terms = tuple(
        replace(t, values={**{p.name: p.nominal for p in t.law.nonlinear}, **t.values})
        for t in terms
    )
    if rigids is None:
        rigids = [rigid_of(robot, m) for m in motions]
    if refine_width is None:
        refine_width = width is None
    if width is None:
        width = best_widths(robot, terms, motions, rigids)
    width = tuple(map(float, np.broadcast_to(width, robot.num_joints)))
    problem = Problem(robot, tuple(motions), tuple(rigids), bounded)
    pi = np.zeros(10 * robot.num_joints) if start is None else start
    groups = width_groups(robot, terms) if refine_width else []
    moving = free_parameters(terms, _free_widths(motions, groups, width))
    # Nobody but the search holds where it starts: the columns of a long log are as large as all else.
    here = newton(problem, moving, settle(problem, Place(terms, width), pi))
    split, doubt = _own_widths(problem, here, groups) if groups else (groups, {})
    if split != groups:
        moving = free_parameters(terms, _free_widths(motions, split, here.place.width))
        here = newton(problem, moving, here)
        here, moving = _leaning(problem, here, moving, groups, split, doubt)
    return _finish(problem, here, moving)


def _leaning(problem: Problem, here: Settled, moving, groups, split, doubt):
    """The fit with widths that lean on each other, unless the log denies it; and what is free there."""
    told = told_by_the_others(groups, split, here.place.width, doubt)
    known = [g for g in split if all(told[j] == here.place.width[j] for j in g)]
    if len(known) == len(split):
        return here, moving
    free = free_parameters(here.place.terms, _free_widths(problem.motions, known, told))
    there = newton(problem, free, settle(problem, here.place._replace(width=told), here.pi))
    sigma = here.solution.sigma
    one, two = (weighted_cost(x.solution.residual, sigma) for x in (here, there))
    denied = two > (1.0 + _HARDLY_TOLD / len(here.solution.residual)) * one
    return (here, moving) if denied else (there, free)


def _free_widths(motions: Sequence[Motion], groups, width) -> list[FreeParameter]:
    """The widths to fit; a sign that is sharper than any sample shows has none."""
    ranges = [width_range(motions, group) for group in groups]
    return [
        width_parameter(group, limits)
        for group, limits in zip(groups, ranges, strict=True)
        if limits[0] < width[group[0]] < limits[1]
    ]


def _own_widths(
    problem: Problem, here: Settled, groups
) -> tuple[list[tuple[int, ...]], dict[int, float]]:
    """The groups without the joints whose sign is another than their group's, and what joints' widths are
    doubted by (logarithms).
    """
    alone = [
        width_parameter((j,), width_range(problem.motions, group))
        for group in groups
        if len(group) > 1
        for j in group
    ]
    alone = [one for one in alone if one.lower < here.place.width[one.joints[0]] < one.upper]
    if not alone:
        return groups, {}
    change, doubt = widths_apart(problem, alone, here)
    scale = np.array([np.log(one.upper / one.lower) for one in alone])
    joints = [one.joints[0] for one in alone]
    ratio, error = (dict(zip(joints, x * scale, strict=True)) for x in (change, doubt))
    own = set()
    for group in groups:
        rows = [j for j in group if j in ratio]
        found = apart(np.array([ratio[j] for j in rows]), np.array([error[j] for j in rows]))
        own |= {rows[k] for k in found}
    rest = [tuple(j for j in group if j not in own) for group in groups]
    return [*(group for group in rest if group), *((j,) for j in sorted(own))], error


def _uncertainty(solution: Fit) -> Uncertainty:
    """The covariance of a fit by the names of its columns."""
    base = solution.base
    return Uncertainty(tuple(base.names[k] for k in base.kept), solution.covariance)


def _finish(problem: Problem, here: Settled, moving: list[FreeParameter]) -> Estimate:
    """The estimate with values and standard errors by name."""
    robot, theta = problem.robot, here.solution.theta
    first = problem.motions[0]
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
        first.filtering,
        tuple(map(float, here.solution.sigma)),
        uncertainty=_uncertainty(here.solution),
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
    if any(t.law.recurring for t in terms):
        model, errors = with_event_torques(
            model, here.solution, here.regression, problem.motions, problem.rigids, errors
        )
    return Estimate(
        model, here.solution, here.regression, problem.motions, problem.rigids, tuple(errors)
    )
