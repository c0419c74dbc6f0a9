"""Nonlinear parameters of a law brought from where a search ended to where the residual is least.

A search of a few swarm steps ends near the minimum, not in it. What it leaves is enough for another law,
whose columns are exact, to look as if it explained something that this one does not.
"""

from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.folds.partial_out import Fold
from jaxswarm.effects.term import Term

# Steps at most, the difference of positions in the unit cube that a slope is taken over, and the shortest
# part of a step that is tried.
_STEPS, _APART, _SHORTEST = 3, 1e-4, 0.25


def refined(
    stand: Linearization, term: Term, fold: Fold, values: dict[str, float], least: float
) -> tuple[dict[str, float], np.ndarray]:
    """Values of a law's searched parameters where its columns explain most of a fold, and the columns.

    Gauss-Newton steps in the unit cube, the linear parameters and the current model free to follow; a step
    is made only if the fold's training rows are left with less.

    Args:
        stand: The current model.
        term: A term of a law whose parameters are searched.
        fold: The rows it is fitted to.
        values: Where the search ended.
        least: Share of the joint's squared error below which nothing is done.

    Returns:
        The values, and the weighted columns (T', n, k) there.
    """
    moving = [p for p in term.law.nonlinear if p.fitted]
    columns = stand.law(replace(term, values=values))
    total = float((fold.residual[fold.train, term.joint] ** 2).sum())
    left, linear = _left(fold, columns, term.joint)
    if not moving or left > (1.0 - least) * total:
        return values, columns
    for _ in range(_STEPS):
        here = np.array([p.encode(values[p.name]) for p in moving])
        slopes = []
        for k, _ in enumerate(moving):
            aside = here.copy()
            aside[k] += _APART if here[k] < 0.5 else -_APART
            moved = stand.law(replace(term, values={**values, **_at(moving, aside)}))
            slopes.append((moved - columns) @ linear / (aside[k] - here[k]))
        _, step = _left(
            fold, np.concatenate([columns, np.stack(slopes, axis=2)], axis=2), term.joint
        )
        step, part = step[columns.shape[2] :], 1.0
        while part >= _SHORTEST:
            there = {**values, **_at(moving, np.clip(here + part * step, 0.0, 1.0))}
            other = stand.law(replace(term, values=there))
            found, coefficients = _left(fold, other, term.joint)
            if found < left:
                break
            part *= 0.5
        if part < _SHORTEST:
            break
        values, columns, left, linear = there, other, found, coefficients
    return values, columns


def _at(moving, position: np.ndarray) -> dict[str, float]:
    return {p.name: float(p.decode(x)) for p, x in zip(moving, position, strict=True)}


def _left(fold: Fold, columns: np.ndarray, joint: int) -> tuple[float, np.ndarray]:
    """What the joint's training rows are left with, and the coefficients (k,) of the columns."""
    free = fold.free_rows(columns[:, joint], joint)[fold.train]
    target = fold.residual[fold.train, joint]
    scale = np.maximum(np.linalg.norm(free, axis=0), 1e-300)
    found = np.linalg.lstsq(free / scale, target, rcond=1e-6)[0]
    return float(((target - free / scale @ found) ** 2).sum()), found / scale
