r"""From a robot, declared terms and logs to an identified model: width, load, nonlinear parameters, weights.

Linear parameters are eliminated at every step; the nonlinear ones follow by Gauss-Newton on what remains
(variable projection, G. H. Golub, V. Pereyra, Inverse Problems 19 (2003)): the tangents
:math:`\partial W(\nu)/\partial\nu\;\theta` are further columns beside W, and solving for both gives the
step, and in the end the standard errors of linear and nonlinear parameters together.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.identify.assemble import assemble, moves_links, term_block, uses_load
from jaxswarm.identify.columns import Rigid, rigid_of
from jaxswarm.identify.least_squares import Fit, fit
from jaxswarm.identify.model import Model, linear_values
from jaxswarm.identify.nonlinear import Knob, knobs, read, tangents, write
from jaxswarm.identify.regression import Regression, build_regression
from jaxswarm.identify.terms import Term
from jaxswarm.logs.motion import Filtering, Motion
from jaxswarm.robot.model import Robot

# Rounds of refitting where the load or the lag of a soft joint depends on the fit itself.
_ROUNDS, _NEWTON_STEPS = 6, 8


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


def parameter_bounds(terms: tuple[Term, ...], joints: tuple[str, ...]) -> tuple:
    """Bounds of all columns: the rigid ones free, the laws' as their tables say."""
    rigid = 10 * len(joints)
    lower, upper = [-np.inf] * rigid, [np.inf] * rigid
    for term in terms:
        table = term.law.linear
        free = len(term.columns(joints)) - len(table)
        lower += [p.lower for p in table] + [-np.inf] * free
        upper += [p.upper for p in table] + [np.inf] * free
    return np.array(lower), np.array(upper)


def estimate(
    robot: Robot,
    terms: tuple[Term, ...],
    motions: Sequence[Motion],
    *,
    width: float | None = None,
    bounded: bool = True,
    rigids: Sequence[Rigid] | None = None,
    start: np.ndarray | None = None,
) -> Estimate:
    """Identify the rigid body and the parameters of ``terms`` on one or several logs.

    Args:
        robot: Kinematics; its parameters are not used.
        terms: Declared laws; nonlinear parameters start at their values, else at the nominal ones.
        motions: Prepared logs with torque.
        width: Width of the smooth sign [rad/s]; None: the one that fits best.
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
    if width is None:
        width = best_width(robot, terms, motions, rigids)
    problem = _Problem(robot, tuple(motions), tuple(rigids), width, bounded)
    pi = np.zeros(10 * robot.num_joints) if start is None else start
    solution, regression, pi = _settle(problem, terms, pi)
    moving = knobs(terms)
    if moving:
        terms, solution, regression, pi = _newton(problem, terms, moving, solution, regression, pi)
    return _finish(problem, terms, solution, regression, pi, moving)


@dataclass(frozen=True)
class _Problem:
    robot: Robot
    motions: tuple[Motion, ...]
    rigids: tuple[Rigid, ...]
    width: float
    bounded: bool

    def build(self, terms, pi) -> Regression:
        return build_regression(self.robot, terms, self.motions, self.width, pi, self.rigids)

    def solve(self, terms, regression, **options) -> Fit:
        bounds = parameter_bounds(terms, self.robot.joints) if self.bounded else (None, None)
        return fit(regression, *bounds, **options)

    def output(self, terms, pi, theta) -> np.ndarray:
        """Decimated torque of a model, (T, n)."""
        parts = []
        for motion, rigid in zip(self.motions, self.rigids, strict=True):
            low = assemble(self.robot, terms, motion, self.width, pi, rigid, decimate=True)
            parts.append(low @ theta)
        return np.concatenate(parts)


def _settle(problem: _Problem, terms, pi) -> tuple[Fit, Regression, np.ndarray]:
    """Fit, and fit again where columns depend on the rigid parameters, until those stand still."""
    depends = uses_load(terms) or moves_links(terms)
    rigid = 10 * problem.robot.num_joints
    for _ in range(_ROUNDS if depends else 1):
        regression = problem.build(terms, pi)
        solution = problem.solve(terms, regression)
        new = solution.theta[:rigid]
        change = regression.columns[:, :, :rigid] @ (new - pi)
        pi = new
        if np.abs(change).max() < 1e-6 * np.abs(regression.torque).max():
            break
    return solution, regression, pi


def _newton(problem: _Problem, terms, moving: list[Knob], solution, regression, pi):
    """Gauss-Newton on the nonlinear parameters, halving a step that does not pay."""
    cost = _cost(solution, solution.sigma)
    for _ in range(_NEWTON_STEPS):
        sigma = solution.sigma
        here = read(terms, moving)
        slopes = tangents(lambda t: problem.output(t, pi, solution.theta), terms, moving)  # noqa: B023
        columns = np.concatenate([regression.columns[:, :, solution.base.kept], slopes], axis=2)
        weighted = (columns / sigma[:, None]).reshape(-1, columns.shape[2])
        scale = np.linalg.norm(weighted, axis=0)
        scale[scale == 0] = 1.0
        target = (solution.residual / sigma).ravel()
        step = np.linalg.lstsq(weighted / scale, target, rcond=1e-8)[0] / scale
        step = np.clip(step[-len(moving) :], -0.2, 0.2)
        better = False
        for shrink in (1.0, 0.3, 0.1):
            trial = write(terms, moving, np.clip(here + shrink * step, 0.0, 1.0))
            found, rows, settled = _settle(problem, trial, pi)
            new = _cost(found, sigma)
            if new < cost * (1 - 1e-7):
                better = True
                break
        if not better:
            break
        gain = 1 - new / cost
        terms, solution, regression, pi = trial, found, rows, settled
        cost = _cost(solution, solution.sigma)
        if gain < 1e-5:
            break
    return terms, solution, regression, pi


def _cost(solution: Fit, sigma: np.ndarray) -> float:
    return float(((solution.residual / sigma) ** 2).sum())


def _finish(problem, terms, solution, regression, pi, moving) -> Estimate:
    robot = problem.robot
    theta, filled, k = solution.theta, [], 10 * robot.num_joints
    for term in terms:
        values = dict(term.values)
        for name in term.columns(robot.joints):
            key = name.split(":")[0] if term.law.warp == "window" else None
            table = term.law.linear
            values[key or table[k - _first(terms, term, robot)].name] = float(theta[k])
            k += 1
        filled.append(replace(term, values=values))
    filled = tuple(filled)
    first = problem.motions[0]
    filtering = Filtering(first.motion_cutoff, first.torque_cutoff, skew=first.skew)
    model = Model(
        robot.replace(parameters=jnp.asarray(pi.reshape(-1, 10))),
        filled,
        problem.width,
        filtering,
        tuple(map(float, solution.sigma)),
    )
    errors = _std_errors(problem, model, solution, regression, moving)
    return Estimate(model, solution, regression, problem.motions, problem.rigids, errors)


def _first(terms, term, robot) -> int:
    """Index of the first column of a term."""
    k = 10 * robot.num_joints
    for other in terms:
        if other is term:
            return k
        k += len(other.columns(robot.joints))
    raise ValueError("term is not of these terms")


def _std_errors(problem, model: Model, solution: Fit, regression, moving) -> tuple[dict, ...]:
    """Standard errors of all term parameters, nonlinear ones through their tangents."""
    joints = model.robot.joints
    theta = linear_values(model)
    pi = theta[: 10 * len(joints)]
    if moving:
        slopes = tangents(lambda t: problem.output(t, pi, theta), model.terms, moving)
        wide = Regression(
            (*regression.names, *(f"{m.name}:{m.term}" for m in moving)),
            np.concatenate([regression.columns, slopes], axis=2),
            solution.residual,
            regression.moving,
            regression.t,
            regression.log,
            regression.step,
        )
        solution = fit(wide, sigma=solution.sigma)
    errors = np.full(len(solution.base.names), np.nan)
    errors[solution.base.kept] = solution.std_error
    tables, k = [], 10 * len(joints)
    for number, term in enumerate(model.terms):
        table = {}
        for name in term.columns(joints):
            table[name.split(":")[0] if term.law.warp == "window" else ""] = errors[k]
            k += 1
        if term.law.linear:
            own = errors[k - len(term.law.linear) : k]
            table = {p.name: float(e) for p, e in zip(term.law.linear, own, strict=True)}
        for m, knob in enumerate(moving):
            if knob.term == number:
                slope = knob.slope(term.values[knob.name])
                table[knob.name] = float(errors[len(regression.names) + m] * slope)
        tables.append(table)
    return tuple(tables)


def best_width(robot, terms, motions, rigids, pi=None) -> float:
    """The width of the smooth sign with the smallest weighted residual, from sharp to a fifth of the speed."""
    speed = float(np.median([np.sqrt(np.mean(m.dq**2)) for m in motions]))
    if not any(t.law.uses_direction for t in terms):
        return max(0.01 * speed, 1e-6)
    speed_grid = speed * np.concatenate([[1e-6], np.geomspace(1e-3, 0.2, 12)])
    pi = np.zeros(10 * robot.num_joints) if pi is None else pi
    regression = build_regression(robot, terms, motions, 0.01 * speed, pi, rigids)
    costs, sigma = [], None
    for width in speed_grid:
        columns = regression.columns.copy()
        k = 10 * robot.num_joints
        for term in terms:
            size = len(term.columns(robot.joints))
            if term.law.uses_direction:
                columns[:, :, k : k + size] = np.concatenate(
                    [
                        term_block(robot, terms, term, m, float(width), pi, r)
                        for m, r in zip(motions, rigids, strict=True)
                    ]
                )
            k += size
        solution = fit(replace(regression, columns=columns), sigma=sigma)
        sigma = solution.sigma if sigma is None else sigma
        costs.append(_cost(solution, sigma))
    grid = speed_grid
    best = int(np.argmin(costs))
    if 1 < best < len(grid) - 1:
        # Vertex of the parabola through the three best points, in the logarithm of the width.
        x, y = np.log(grid[best - 1 : best + 2]), np.array(costs[best - 1 : best + 2])
        a, b, _ = np.polyfit(x - x[1], y, 2)
        return float(np.exp(x[1] - b / (2 * a))) if a > 0 else float(grid[best])
    return float(grid[best])
