"""A formula by the load fitted together with the load: it goes by that of the model that holds it.

A model that lacks a law took up of it what it could, and has another load. Of a drawn law exp(k q) load load0
at 37 times the noise the true form left 0.038 of the squared error by that load, q cos load load0^2 half of it;
by the load that the model has beside each the true one left 0.0009 and the next 0.0017, the noise being 0.0005.
The torque is linear in the parameters of the arm and so is the load, so that these, a formula's factors and its
inner constants take a step of Gauss and Newton at once, in a few milliseconds.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.folds.partial_out import Fold
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.postfix import Program, evaluate, fields_of

# Steps of the refinement of all constants at once: it starts at a swarm's best.
REFINING = 40
# Step of a difference by a load, in parts of its largest value, and by a constant, in parts of its range.
_STEP = 1e-4
# Parts of the linear solution from which is started: seen with a wrong load a law seems larger or smaller.
_PARTS = (1.0, 0.5, 0.25)
# The part of the squared error that a step has to gain to be followed by another; dampings tried in one step,
# the first of them, by what they change, and that of a solution that has to be one.
_SETTLED, _TURNS, _DAMPING, _CHANGE, _LEAST = 1e-4, 6, 1e-3, 10.0, 1e-10


class Together(NamedTuple):
    """A formula fitted together with the load.

    Attributes:
        values: Of its inner constants.
        factors: Its linear constants, (k,).
        left: Weighted residual of the joint on all rows, trained on or not, (T,).
        loads: Every load among the variables as the model has it beside the formula, (T,).
        change: Of the base parameters, (b',).
        share: Share of the joint's squared error that it takes off those of all joints on the training rows.
    """

    values: dict[str, float]
    factors: np.ndarray
    left: np.ndarray
    loads: dict[str, np.ndarray]
    change: np.ndarray
    share: float


def goes_by_load(problem: Joint, programs: Sequence[Program]) -> bool:
    """Whether a formula reads a load."""
    return any(name in problem.by_load for p in programs for name in fields_of(p))


@np.errstate(all="ignore")  # a program may leave the finite numbers away from its constants
def fitted_together(
    problem: Joint,
    programs: Sequence[Program],
    constants: Sequence[Parameter],
    values: Mapping[str, float],
    fold: Fold,
    steps: int = REFINING,
) -> Together:
    """Fit a formula, the model and its load at once to the rows that a fold was trained on.

    Args:
        problem: The joint.
        programs: The terms.
        constants: Their inner constants; none: those stay.
        values: Of all constants, from which these begin.
        fold: The rows.
        steps: Steps at most.
    """
    fit = _Fit(problem, programs, constants, values, fold, fold.train)
    x = fit.start(np.clip([p.encode(values[p.name]) for p in constants], 0.0, 1.0))
    columns = fit.columns(x)
    left, damping = fit.left(x, columns), _DAMPING
    for _ in range(steps):
        slopes = fit.slopes(x, columns)
        for _ in range(_TURNS):
            there = fit.within(x + _solution(slopes, left, damping))
            columns = fit.columns(there)
            after = fit.left(there, columns)
            if after @ after < left @ left:
                break
            damping *= _CHANGE
        else:
            break
        gained = 1.0 - (after @ after) / (left @ left)
        x, left, damping = there, after, damping / _CHANGE
        if gained < _SETTLED:
            break
    alone = float(fit.residual @ fit.residual)
    share = (alone + float(fit.aim @ fit.aim) - float(left @ left)) / max(alone, 1e-300)
    everywhere = _Fit(problem, programs, constants, values, fold, slice(None))
    z, a, _ = fit.parts(x)
    told = everywhere.residual - everywhere.project @ z - everywhere.columns(x) @ a
    loads = everywhere.loads_at(z)
    return Together(fit.values_at(x), a, told, loads, fold.solve @ z, share)


def _solution(columns: np.ndarray, target: np.ndarray, damping: float) -> np.ndarray:
    """Damped least squares, every column of unit size."""
    scale = np.maximum(np.sqrt(np.einsum("tk,tk->k", columns, columns)), 1e-300)
    inner = columns.T @ columns / scale / scale[:, None]
    inner[np.diag_indices_from(inner)] += damping
    return np.linalg.solve(inner, columns.T @ target / scale) / scale


class _Fit:
    """What is left of a joint, by coordinates of the model, factors and inner constants of a formula: x."""

    def __init__(self, problem: Joint, programs, constants, values, fold: Fold, rows):
        self.programs, self.constants, self.values = programs, constants, values
        self.project = fold.project[rows, problem.joint]
        self.residual = fold.residual[rows, problem.joint]
        self.weight = problem.lin.crossfit.weight[rows, problem.joint, None]
        self.data = {name: x[rows] for name, x in problem.data.items()}
        loads, others = problem.moving(fold)
        self.read = {name for p in programs for name in fields_of(p)}
        self.loads = {n: (own[rows], along[rows]) for n, (own, along) in loads.items()}
        self.far, self.aim = others[:, :-1], others[:, -1]

    def parts(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Coordinates, factors, and places of the inner constants."""
        one = self.project.shape[1]
        two = one + len(self.programs)
        return x[:one], x[one:two], x[two:]

    def within(self, x: np.ndarray) -> np.ndarray:
        """The same with the inner constants within their ranges."""
        z, a, u = self.parts(x)
        return np.concatenate([z, a, np.clip(u, 0.0, 1.0)])

    def values_at(self, x: np.ndarray) -> dict[str, float]:
        """All constants of the formula."""
        places = zip(self.constants, self.parts(x)[2], strict=True)
        return {**self.values, **{p.name: float(p.decode(u)) for p, u in places}}

    def loads_at(self, z: np.ndarray) -> dict[str, np.ndarray]:
        """The loads of the model at its coordinates."""
        return {name: own + along @ z for name, (own, along) in self.loads.items()}

    def columns(self, x: np.ndarray, moved: str = "", by: float = 0.0) -> np.ndarray:
        """Weighted columns (T, k) of the terms by the loads of the model, one of them moved by so much."""
        known = {**self.data, **self.values_at(x), **self.loads_at(self.parts(x)[0])}
        if moved:
            known[moved] = known[moved] + by
        return self._weighted(known)

    def _weighted(self, known: Mapping) -> np.ndarray:
        own = np.empty((len(self.weight), len(self.programs)))
        for k, program in enumerate(self.programs):
            own[:, k] = evaluate(program, known, np)
        own *= self.weight
        return own if np.isfinite(own).all() else np.nan_to_num(own, posinf=0.0, neginf=0.0)

    def start(self, u: np.ndarray) -> np.ndarray:
        """The part of the solution by the loads as they are seen that leaves least by those that go with it."""
        seen = np.concatenate([np.zeros(self.project.shape[1] + len(self.programs)), u])
        columns = self._weighted({**self.data, **self.values_at(seen)})
        target = np.concatenate([self.residual, self.aim])
        x = _solution(self._stacked(columns), target, _LEAST)
        starts = [np.concatenate([part * x, u]) for part in _PARTS]
        return min(
            starts, key=lambda one: float(np.square(self.left(one, self.columns(one))).sum())
        )

    def left(self, x: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """What all joints are left with, by the columns there, the rows of the others reduced."""
        z, a, _ = self.parts(x)
        own = self.residual - self.project @ z - columns @ a
        return np.concatenate([own, self.aim - self.far @ z])

    def slopes(self, x: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """What is left by x, with the other sign."""
        _, a, u = self.parts(x)
        by = np.zeros_like(self.project)
        for name in self.read & self.loads.keys():
            along = self.loads[name][1]
            step = _STEP * float(np.abs(self.data[name]).max())
            by += ((self.columns(x, name, step) - columns) @ a / step)[:, None] * along
        inner = np.zeros((len(by), len(u)))
        for k in range(len(u)):
            step = _STEP * np.eye(len(x))[len(x) - len(u) + k]
            inner[:, k] = (self.columns(x + step) - columns) @ a / _STEP
        return self._stacked(np.column_stack([columns, inner]), by)

    def _stacked(self, own: np.ndarray, by: np.ndarray | float = 0.0) -> np.ndarray:
        """Slopes by the coordinates and by the joint's own columns, the other joints' rows below."""
        above = np.column_stack([self.project + by, own])
        return np.vstack([above, np.pad(self.far, ((0, 0), (0, own.shape[1])))])
