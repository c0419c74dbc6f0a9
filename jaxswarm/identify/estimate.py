"""From a robot, declared terms and logs to an identified model: width, load and weights iterated."""

from dataclasses import dataclass, replace

import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.identify.columns import rigid_columns
from jaxswarm.identify.least_squares import Fit, fit
from jaxswarm.identify.model import Model
from jaxswarm.identify.regression import Regression, build_regression
from jaxswarm.identify.terms import Term
from jaxswarm.logs.motion import Filtering, Motion
from jaxswarm.robot.model import Robot

_USES_DIRECTION = {
    "coulomb_friction",
    "asymmetric_friction",
    "stribeck_friction",
    "load_dependent_friction",
    "thermal_drift",
}


@dataclass(frozen=True)
class Estimate:
    """An identified model with the problem it solves.

    Attributes:
        model: Robot and terms with values.
        fit: The least-squares solution.
        regression: Its rows.
        motions: The logs, as used.
        rigids: Rigid-body columns of every log, kept because everything after needs them.
        loads: Rigid-body torque of the model along every log.
    """

    model: Model
    fit: Fit
    regression: Regression
    motions: tuple[Motion, ...]
    rigids: tuple[np.ndarray, ...]
    loads: tuple[np.ndarray, ...]


def parameter_bounds(terms: tuple[Term, ...], rigid: int) -> tuple[np.ndarray, np.ndarray]:
    """Bounds of all columns: the rigid ones free, the laws' as their tables say."""
    lower, upper = [-np.inf] * rigid, [np.inf] * rigid
    for term in terms:
        lower += [p.lower for p in term.law.linear]
        upper += [p.upper for p in term.law.linear]
    return np.array(lower), np.array(upper)


def estimate(
    robot: Robot,
    terms: tuple[Term, ...],
    motions: list[Motion],
    *,
    width: float | None = None,
    bounded: bool = True,
    rigids: list[np.ndarray] | None = None,
) -> Estimate:
    """Identify the rigid body and the linear parameters of ``terms`` on one or several logs.

    Args:
        robot: Kinematics; its parameters are not used.
        terms: Declared laws; nonlinear parameters stay at their values, else at the nominal ones.
        motions: Prepared logs with torque.
        width: Width of the smooth sign [rad/s]; None: the one that fits best.
        bounded: Whether physical bounds (friction not below zero) hold.
        rigids: Rigid-body columns of the logs where they are known.

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
        rigids = [rigid_columns(robot, m.q, m.dq, m.ddq) for m in motions]
    if width is None:
        width = _best_width(robot, terms, motions, rigids)
    lower, upper = parameter_bounds(terms, rigids[0].shape[2])
    bounds = (lower, upper) if bounded else (None, None)
    needs_load = any(t.effect == "load_dependent_friction" for t in terms)
    loads = [np.zeros(m.q.shape) for m in motions]
    for _ in range(6 if needs_load else 1):
        regression = build_regression(robot, terms, motions, width, loads, rigids)
        solution = fit(regression, *bounds)
        pi = solution.theta[: rigids[0].shape[2]]
        new = [r @ pi for r in rigids]
        moved = max(np.abs(a - b).max() for a, b in zip(new, loads, strict=True))
        loads = new
        if needs_load and moved < 1e-6 * max(np.abs(x).max() for x in loads):
            break
    model = _model(robot, terms, motions, width, solution)
    return Estimate(model, solution, regression, tuple(motions), tuple(rigids), tuple(loads))


def _model(robot, terms, motions, width, solution) -> Model:
    rigid = 10 * robot.num_joints
    theta, filled, k = solution.theta, [], rigid
    for term in terms:
        values = dict(term.values)
        for p in term.law.linear:
            values[p.name] = float(theta[k])
            k += 1
        filled.append(replace(term, values=values))
    identified = robot.replace(parameters=jnp.asarray(theta[:rigid].reshape(-1, 10)))
    filtering = Filtering(
        motion_cutoff=motions[0].motion_cutoff, torque_cutoff=motions[0].torque_cutoff
    )
    return Model(identified, tuple(filled), width, filtering, tuple(map(float, solution.sigma)))


def _best_width(robot, terms, motions, rigids) -> float:
    """The width of the smooth sign with the smallest weighted residual, from sharp to a fifth of the speed."""
    speed = float(np.median([np.sqrt(np.mean(m.dq**2)) for m in motions]))
    default = max(0.01 * speed, 1e-6)
    if not any(t.effect in _USES_DIRECTION for t in terms):
        return default
    grid = speed * np.concatenate([[1e-6], np.geomspace(1e-3, 0.2, 12)])
    costs, sigma = [], None
    for width in grid:
        regression = build_regression(robot, terms, motions, float(width), None, rigids)
        solution = fit(regression, sigma=sigma)
        sigma = solution.sigma if sigma is None else sigma
        costs.append(float(((solution.residual / sigma) ** 2).sum()))
    best = int(np.argmin(costs))
    if 1 < best < len(grid) - 1:
        # Vertex of the parabola through the three best points, in the logarithm of the width.
        x, y = np.log(grid[best - 1 : best + 2]), np.array(costs[best - 1 : best + 2])
        a, b, _ = np.polyfit(x - x[1], y, 2)
        return float(np.exp(x[1] - b / (2 * a))) if a > 0 else float(grid[best])
    return float(grid[best])
