"""From a robot, declared terms and logs to an identified model: rigid body, laws, width of the sign."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.kinds import MeasurementLaw, TorqueLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.chosen import with_values_to_begin
from jaxswarm.identify.estimation.derived import derived_errors
from jaxswarm.identify.estimation.events import window_errors, with_event_torques
from jaxswarm.identify.estimation.fitted import Fitted, fitted, fitted_at_width, with_shapes
from jaxswarm.identify.estimation.free_covariance import covariance_of
from jaxswarm.identify.estimation.free_parameters import FreeParameter, Place
from jaxswarm.identify.estimation.gauss_newton import (
    Settled,
    newton,
    settle,
)
from jaxswarm.identify.estimation.held_rest import without_rest
from jaxswarm.identify.estimation.least_squares import Fit, with_doubt
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.estimation.sign_width import (
    best_widths,
    width_groups,
)
from jaxswarm.identify.estimation.swing_starts import with_swings
from jaxswarm.identify.estimation.usable import check_usable
from jaxswarm.identify.forward.body import arm_of
from jaxswarm.identify.forward.columns import Rigid, rigid_of
from jaxswarm.identify.forward.link_lag import flank_compression
from jaxswarm.identify.forward.model import Model, linear_values
from jaxswarm.identify.forward.regression import Regression
from jaxswarm.identify.forward.uncertainty import Uncertainty
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot

# Clocks that nobody delayed are apart by a part of a sample, by filters and by how long a drive holds a torque:
# evenly within half a sample on either side, which no log tells from a delay. Standard deviation, in samples.
CLOCKS_APART = 12.0**-0.5
# What shows a nonlinear parameter is told from zero beyond so many standard errors. Of 66 fits to pairs of
# elements that slip, one of a tenth of the other's level or none, the ways whose levels are beyond four are
# within two of their standard errors in 88 %, and within 4.7 always; those whose levels are not in 33 %, and up
# to 208 off: such a way is where it explains noise best. At two the one 208 off is among those that are told.
TOLD = 4.0


@dataclass(frozen=True)
class Estimate:
    """An identified model with the problem it solves.

    Attributes:
        model: Robot and terms with values.
        fit: The least-squares solution, tangents of nonlinear parameters included in its covariance.
        regression: Its rows.
        motions: The logs, as used.
        rigids: Rigid-body columns of every log in nominal gravity and motion.
        std_errors: Standard error of every term parameter and derived value, one dictionary per term; NaN
            where one cannot be told from others.
        refits: What :mod:`jaxswarm.diagnose.selection.refit` fitted from it, by terms with their values.
    """

    model: Model
    fit: Fit
    regression: Regression
    motions: tuple[Motion, ...]
    rigids: tuple[Rigid, ...]
    std_errors: tuple[dict[str, float], ...]
    refits: dict = field(default_factory=dict, init=False, repr=False, compare=False)


def estimate(
    robot: Robot,
    terms: tuple[Term, ...],
    motions: Sequence[Motion],
    *,
    width: float | tuple[float, ...] | None = None,
    bounded: bool = True,
    rigids: Sequence[Rigid] | None = None,
    refine_width: bool | None = None,
    known_width: bool = True,
    start: np.ndarray | None = None,
    near: Sequence[Term] = (),
) -> Estimate:
    """Identify the rigid body and the parameters of ``terms`` on one or several logs.

    Args:
        robot: Kinematics; its parameters are not used.
        terms: Declared laws; nonlinear parameters start at their values, else at the nominal ones.
        motions: Prepared logs with torque.
        width: Width of every joint's smooth sign [rad/s or m/s], one or one per joint; None: those that
            fit best.
        refine_width: Whether the widths are fitted with the rest; None: where they are not given.
        known_width: Whether widths that are not fitted are known; else the standard errors hold their doubt.
        bounded: Whether physical bounds (friction not below zero) hold.
        rigids: Rigid-body columns of the logs where they are known.
        start: Rigid parameters to start from, (10 n,), where loads or soft joints need some.
        near: Terms of a fit near this one: shapes that it told are asked whether they are usual after all.

    Raises:
        InputError: If the logs cannot be used for these terms, or there are too few samples.
        Diverged: If the model's torque is not finite along a log, as where a link runs away.
    """
    check_usable(terms, motions)
    declared, terms = terms, with_values_to_begin(terms, motions)
    if rigids is None:
        rigids = [rigid_of(robot, m) for m in motions]
    if refine_width is None:
        refine_width = width is None
    if width is None:
        width = best_widths(robot, terms, motions, rigids)
    width = tuple(map(float, np.broadcast_to(width, robot.num_joints)))
    pi = np.zeros(10 * robot.num_joints) if start is None else start
    motions = without_rest(robot, terms, motions, rigids, width, pi)
    problem = Problem(robot, tuple(motions), tuple(rigids), bounded)
    groups = width_groups(robot, terms, motions) if refine_width or not known_width else []
    fit = fitted if refine_width else fitted_at_width

    def of(terms: tuple[Term, ...]) -> tuple[Problem, Fitted]:
        return with_shapes(problem, terms, near, width, pi, partial(fit, groups))

    problem, fits = with_swings(declared, terms, of)
    return _named(problem, *fits)


def untold(term: Term, errors: dict[str, float]) -> list[str]:
    """Nonlinear parameters that a fit moved where what shows them is not told from zero.

    Args:
        term: With its fitted values.
        errors: Standard errors of its parameters by name.
    """

    def told(name: str) -> bool:
        return bool(abs(term.values[name]) > TOLD * errors[name])

    return [p.name for p in term.law.nonlinear if not all(map(told, p.shown_by))]


def _named(
    problem: Problem, here: Settled, moving: list[FreeParameter], held_widths: list[FreeParameter]
) -> Estimate:
    """The estimate in which a part of a law that is there alone goes by the name of the first one.

    Either part could stand for it, and where the search began would decide what is told of it.
    """
    found = _finish(problem, here, moving, held_widths)
    alone = [_exchange(*own) for own in zip(found.model.terms, found.std_errors, strict=True)]
    if not any(alone):
        return found
    terms = tuple(
        t if change is None else replace(t, values=change(t.values))
        for t, change in zip(found.model.terms, alone, strict=True)
    )
    place, sigma = Place(terms, here.place.width), here.solution.sigma
    there = newton(problem, moving, settle(problem, place, here.pi, sigma))
    return _finish(problem, there, moving, held_widths)


def _exchange(term: Term, errors: dict[str, float]) -> Callable | None:
    """How two parts change places, where the second is told from zero and the first is not; else None."""
    if not isinstance(term.law, TorqueLaw) or term.law.exchanged is None:
        return None
    first, second = (abs(term.values[p.name]) > TOLD * errors[p.name] for p in term.law.linear)
    return term.law.exchanged if second and not first else None


def _finish(
    problem: Problem, here: Settled, moving: list[FreeParameter], held_widths: list[FreeParameter]
) -> Estimate:
    """The estimate with values and standard errors by name."""
    robot, theta = problem.robot, here.theta
    first, values = problem.motions[0], here.solution.base.reduce(theta)
    at_bound = here.solution.at_bound & np.isclose(values, here.solution.values)
    stood = here.solution._replace(values=values, residual=here.residual, at_bound=at_bound)
    solution = with_doubt(stood, here.regression)
    named = [t.linear_names(robot.joints) for t in here.place.terms]
    split = np.cumsum([10 * robot.num_joints, *(len(names) for names in named)])
    parts = np.split(theta, split)[1:]
    terms = tuple(
        t.with_linear(own, robot.joints) for t, own in zip(here.place.terms, parts, strict=False)
    )
    model = Model(
        robot.replace(parameters=jnp.asarray(here.pi.reshape(-1, 10))),
        terms,
        here.place.width,
        first.filtering,
        tuple(map(float, solution.sigma)),
        uncertainty=Uncertainty(
            tuple(solution.base.names[k] for k in solution.base.kept), solution.covariance
        ),
    )
    placed = replace(here, place=Place(terms, here.place.width))
    doubted = [*moving, *held_widths]
    covariance = covariance_of(problem, doubted, placed, linear_values(model))
    places = [
        dict(zip(n, range(k, k + len(n)), strict=True)) for n, k in zip(named, split, strict=False)
    ]
    scale = np.ones(len(covariance))
    for place, free in enumerate(doubted, len(here.regression.names)):
        if free.term is not None:
            places[free.term][free.name] = place
            scale[place] = free.parameter.slope(terms[free.term].values[free.name])
    covariance *= np.outer(scale, scale)
    deviation = np.sqrt(np.diag(covariance))
    errors = [{name: float(deviation[k]) for name, k in own.items()} for own in places]
    for term, own, at in zip(terms, errors, places, strict=True):
        own.update({p.name: np.nan for p in term.law.free(term.values) if p.name not in own})
        pressed = flank_compression(arm_of(robot, terms), term, first, here.pi, problem.rigids[0])
        if pressed:
            own["gap"] = float(np.hypot(own["gap"], pressed))
        logs = problem.motions, problem.rigids
        for edge, error in window_errors(term, model, solution, here.regression, *logs).items():
            own[edge] = float(np.fmax(own[edge], error))
        if isinstance(term.law, MeasurementLaw) and term.law.clock:
            apart = CLOCKS_APART * min(m.interval for m in problem.motions)
            own.update({p: float(np.hypot(value, apart)) for p, value in own.items()})
        own.update(dict.fromkeys(untold(term, own), np.nan))
        block = covariance[np.ix_([*at.values()], [*at.values()])]
        own.update(derived_errors(term, [*at], block, own))
    if any(t.law.recurring for t in terms):
        model, errors = with_event_torques(
            model, solution, here.regression, problem.motions, problem.rigids, errors
        )
    return Estimate(
        model, solution, here.regression, problem.motions, problem.rigids, tuple(errors)
    )
