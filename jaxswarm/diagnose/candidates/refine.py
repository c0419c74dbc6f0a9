"""Nonlinear parameters of a law brought from where a search ended to where the residual is least.

A search of a few swarm steps ends near the minimum, not in it. What it leaves is enough for another law,
whose columns are exact, to look as if it explained something that this one does not.
"""

from dataclasses import replace

import numpy as np

from jaxswarm.decomposition import lstsq
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.folds.partial_out import Fold
from jaxswarm.effects.term import Term

# Steps at most, and the difference of positions in the unit cube that a slope is taken over.
_STEPS, _APART = 8, 1e-4
# A step that gains less than this part of what is left is the last.
_SETTLED = 1e-4
# A step leads no further: a search ends in the right valley, a long step may leave it.
_LONGEST = 0.1


def refined(
    lin: Linearization, term: Term, fold: Fold, values: dict[str, float], least: float
) -> tuple[dict[str, float], np.ndarray]:
    """Values of a law's searched parameters where its columns explain most of a fold, and the columns.

    Gauss-Newton steps in the unit cube, the linear parameters and the current model free to follow; a step
    is made only if the fold's training rows are left with less, and if a coefficient that physics wants
    positive stays so: c |dq|^alpha beside a viscous term falls on through alpha = 1, where c changes its sign.

    Args:
        lin: The current model, linearized.
        term: A term of a law whose parameters are searched.
        fold: The rows it is fitted to.
        values: Where the search ended.
        least: Share of the joint's squared error below which nothing is done.

    Returns:
        The values, and the weighted columns (T', n, k) there.
    """
    moving = [p for p in term.law.nonlinear if p.fitted]
    columns = lin.law(replace(term, values=values))
    total = float((fold.residual[fold.train, term.index] ** 2).sum())
    left, _ = left_by(fold, columns, term.index)
    if not moving or left > (1.0 - least) * total:
        return values, columns
    found = [_descend(lin, term, fold, start, moving) for start in _starts(values, moving)]
    return min(found, key=lambda one: one[0])[1:]


def _starts(values: dict[str, float], moving) -> list[dict[str, float]]:
    """Where the search ended, and a quarter and half a turn from there for angles: their valleys look alike."""
    starts = [values]
    for p in moving:
        if p.unit == "rad":
            turned = [values[p.name] + part * np.pi for part in (-1.0, -0.5, 0.5, 1.0)]
            starts += [{**values, p.name: x} for x in turned if p.lower <= x <= p.upper]
    return starts


def _descend(
    lin: Linearization, term: Term, fold: Fold, values: dict[str, float], moving
) -> tuple[float, dict[str, float], np.ndarray]:
    """What is left of the joint's training rows in the valley of the values, the values there, the columns."""
    columns = lin.law(replace(term, values=values))
    left, linear = left_by(fold, columns, term.index)
    for _ in range(_STEPS):
        here = np.array([p.encode(values[p.name]) for p in moving])
        slopes = []
        for k, _ in enumerate(moving):
            aside = here.copy()
            aside[k] += _APART if here[k] < 0.5 else -_APART
            moved = lin.law(replace(term, values={**values, **_at(moving, aside)}))
            slopes.append((moved - columns) @ linear / (aside[k] - here[k]))
        wide = np.concatenate([columns, np.stack(slopes, axis=2)], axis=2)
        step = np.clip(left_by(fold, wide, term.index)[1][columns.shape[2] :], -_LONGEST, _LONGEST)
        for part in (1.0, 0.5, 0.25):
            there = {**values, **_at(moving, np.clip(here + part * step, 0.0, 1.0))}
            other = lin.law(replace(term, values=there))
            found, coefficients = left_by(fold, other, term.index)
            if found < left and (coefficients[0] > 0.0 or not term.law.positive):
                break
        else:
            break
        settled = found > (1.0 - _SETTLED) * left
        values, columns, left, linear = there, other, found, coefficients
        if settled:
            break
    return left, values, columns


def _at(moving, position: np.ndarray) -> dict[str, float]:
    return {p.name: float(p.decode(x)) for p, x in zip(moving, position, strict=True)}


def left_by(fold: Fold, columns: np.ndarray, joint: int) -> tuple[float, np.ndarray]:
    """What the joint's training rows are left with, and the coefficients (k,) of the columns."""
    free = fold.free_rows(columns[:, joint], joint)[fold.train]
    target = fold.residual[fold.train, joint]
    scale = np.maximum(np.linalg.norm(free, axis=0), 1e-300)
    found = lstsq(free / scale, target, rcond=1e-6)
    return float(((target - free / scale @ found) ** 2).sum()), found / scale
