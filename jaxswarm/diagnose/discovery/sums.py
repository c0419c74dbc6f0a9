"""Sums of programs: a term more where it pays, constants of all terms refined together."""

import dataclasses
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import scipy

from jaxswarm.diagnose.discovery.grammar import factors
from jaxswarm.diagnose.discovery.moving_load import (
    REFINING,
    Together,
    fitted_together,
    goes_by_load,
)
from jaxswarm.diagnose.discovery.pieces import Piece, numbered
from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.screening import Trial
from jaxswarm.diagnose.folds.free_parts import coefficients
from jaxswarm.diagnose.folds.partial_out import Fold
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.postfix import Program, evaluate

# The part of a load's variation by which it has to move to be seen otherwise.
_MOVED = 0.1
# A factor that varies by less than this part of itself is a constant: what it does is below any noise.
_IDLE = 1e-3


class Sum(NamedTuple):
    """A formula without its linear constants.

    Attributes:
        pieces: The terms, their constants named apart.
        values: Of all constants.
    """

    pieces: tuple[Piece, ...]
    values: dict[str, float]

    @property
    def programs(self) -> tuple[Program, ...]:
        """The terms as programs."""
        return tuple(one.program for one in self.pieces)

    @property
    def constants(self) -> tuple[Parameter, ...]:
        """The inner constants of all terms."""
        return tuple(p for one in self.pieces for p in one.constants)


def joined(first: Sum | None, trial: Trial) -> Sum:
    """A sum with one more term."""
    old = first.pieces if first else ()
    pieces = numbered((*old, trial.piece))
    given = [*(first.values[p.name] for p in first.constants)] if first else []
    given += [trial.values[p.name] for p in trial.piece.constants]
    names = [p.name for one in pieces for p in one.constants]
    return Sum(pieces, dict(zip(names, given, strict=True)))


def without_term(formula: Sum, k: int) -> Sum:
    """The sum without its k-th term, counted from zero."""
    kept = [piece for i, piece in enumerate(formula.pieces) if i != k]
    given = [formula.values[p.name] for one in kept for p in one.constants]
    pieces = numbered(tuple(kept))
    names = [p.name for one in pieces for p in one.constants]
    return Sum(pieces, dict(zip(names, given, strict=True)))


def without_idle(problem: Joint, formula: Sum) -> Sum:
    """The sum without factors that are constants on all rows, such as a sign of what never changes it.

    Of 1 million pairs thousands say the same so, and only the best are refined: drag by the square of the speed
    came with a hyperbolic tangent of a load that was never below 27 times its scale.
    """
    known = {**problem.data, **formula.values}
    pieces = []
    for one in formula.pieces:
        parts = factors(one.program)
        moving = [p for p in parts if _moves(evaluate(p, known, np))]
        if 0 < len(moving) < len(parts):
            program = moving[0] + tuple(token for p in moving[1:] for token in (*p, "*"))
            left = tuple(p for p in one.constants if p.name in program)
            one = one._replace(program=program, constants=left)
        pieces.append(one)
    given = [formula.values[p.name] for one in pieces for p in one.constants]
    kept = numbered(tuple(pieces))
    names = [p.name for one in kept for p in one.constants]
    return Sum(kept, dict(zip(names, given, strict=True)))


def _moves(x: np.ndarray) -> bool:
    return not np.isfinite(x).all() or bool(np.ptp(x) > _IDLE * np.abs(x).max())


def polished(problem: Joint, formula: Sum, fold: Fold, steps: int = REFINING) -> Sum:
    """The formula with all inner constants refined on the rows that a fold was trained on."""
    table = formula.constants
    if not table:
        return formula
    if goes_by_load(problem, formula.programs):
        args = (problem, formula.programs, table, formula.values, fold, steps)
        return replaced(formula, fitted_together(*args).values)
    start = np.array([np.clip(p.encode(formula.values[p.name]), 0.0, 1.0) for p in table])

    def left(u: np.ndarray) -> np.ndarray:
        values = {p.name: float(p.decode(x)) for p, x in zip(table, u, strict=True)}
        return unexplained(problem, replaced(formula, values), fold)

    found = scipy.optimize.least_squares(left, start, bounds=(0.0, 1.0), max_nfev=steps)
    values = {p.name: float(p.decode(x)) for p, x in zip(table, found.x, strict=True)}
    return replaced(formula, values)


def replaced(formula: Sum, values: Mapping[str, float]) -> Sum:
    """The formula with other values for its inner constants."""
    return formula._replace(values=dict(values))


def free_columns(problem: Joint, formula: Sum, fold: Fold) -> np.ndarray:
    """What the model cannot imitate of the terms on the joint's rows, (T, k)."""
    columns = problem.columns(formula.programs, formula.values)[:, problem.joint]
    # A program may leave the finite numbers beyond the constants at which it was found.
    columns = np.nan_to_num(columns, nan=0.0, posinf=0.0, neginf=0.0)
    return fold.free_rows(columns, problem.joint)


def held_together(problem: Joint, formula: Sum, fold: Fold) -> Together:
    """The model and its load fitted with a formula at its inner constants to the rows of a fold."""
    return fitted_together(problem, formula.programs, (), formula.values, fold)


def seen_beside(problem: Joint, formula: Sum) -> Joint | None:
    """The joint with the loads of the model that holds a formula; None: they are as they were.

    What stands in for a law takes it out of the arm's parameters: of a law by the square of the load that was
    larger than it the load seemed to go the other way (its correlation with the true one was -0.71), and beside
    a product of positions that left 0.03 of the squared error it was 0.96.
    """
    lin = problem.lin
    told = held_together(problem, formula, lin.crossfit.whole)
    moved = [np.std(x - problem.data[name]) > _MOVED * np.std(x) for name, x in told.loads.items()]
    if not any(moved):
        return None
    beside = lin.changed_by(lin.found.fit.base.expand(told.change))
    return dataclasses.replace(problem, lin=beside, data={**problem.data, **told.loads})


def linear(problem: Joint, formula: Sum, fold: Fold, free: np.ndarray) -> np.ndarray:
    """Linear constants (k,) on the rows that a fold was trained on."""
    if goes_by_load(problem, formula.programs):
        return held_together(problem, formula, fold).factors
    own = fold.residual[:, [problem.joint]]
    return coefficients(free[:, None, :], fold, own)


def unexplained(problem: Joint, formula: Sum, fold: Fold) -> np.ndarray:
    """Residual of the training rows with the linear constants eliminated."""
    free = free_columns(problem, formula, fold)
    a = linear(problem, formula, fold, free)
    left = fold.residual[:, problem.joint] - free @ a
    return np.where(fold.train, left, 0.0)


def said(problem: Joint, formula: Sum, fold: Fold) -> np.ndarray:
    """What a formula fitted to a fold says of all rows of the joint, weighted, (T,)."""
    if goes_by_load(problem, formula.programs):
        return fold.residual[:, problem.joint] - held_together(problem, formula, fold).left
    free = free_columns(problem, formula, fold)
    return free @ linear(problem, formula, fold, free)
