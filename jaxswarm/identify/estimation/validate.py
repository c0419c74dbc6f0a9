"""Errors on motion that was not fitted: another log, or blocks of time held out one after the other."""

from collections.abc import Collection

import numpy as np
import scipy

from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.least_squares import joint_factors, triangular_factor, values_on
from jaxswarm.identify.forward.metrics import is_moving, torque_errors
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.logs.motion import Motion


def log_errors(model: Model, *motions: Motion) -> dict:
    """Errors of a model on one log, in the band that is compared and over the whole signal.

    Args:
        model: The model.
        motions: The log's stretches between gaps, at least one.

    Returns:
        :func:`torque_errors` of the low-passed torque, with ``wideband`` the same of the torque as
        measured, and ``torque_cutoff`` [Hz].
    """
    predicted = [model_torque(model, motion) for motion in motions]
    moving = is_moving(np.concatenate([motion.dq for motion in motions]))
    ends = np.cumsum([0, *(len(motion.t) for motion in motions)])
    kept = [start + m.decimator.kept(len(m.t)) for start, m in zip(ends, motions, strict=False)]
    errors = torque_errors(
        np.concatenate([m.low_torque for m in motions]),
        np.concatenate([m.decimator.apply(p) for m, p in zip(motions, predicted, strict=True)]),
        moving[np.concatenate(kept)],
    )
    measured = np.concatenate([motion.tau for motion in motions])
    errors["wideband"] = torque_errors(measured, np.concatenate(predicted), moving)
    errors["torque_cutoff"] = motions[0].torque_cutoff
    return errors


def time_blocks(log: np.ndarray, count: int) -> np.ndarray:
    """Number the rows by contiguous blocks of time, ``count`` of them per log.

    >>> time_blocks(np.array([0, 0, 0, 0, 1, 1]), 2)
    array([0, 0, 1, 1, 2, 3])
    """
    block = np.zeros(len(log), dtype=int)
    start = 0
    for k in np.unique(log):
        rows = np.flatnonzero(log == k)
        block[rows] = start + np.arange(len(rows)) * count // len(rows)
        start += count
    return block


def held_out_residual(
    found: Estimate, count: int = 5, block: np.ndarray | None = None
) -> np.ndarray:
    """Residual (T, n) where every block of rows is predicted by a fit to the others.

    The blocks are numbered by ``block`` (T,); by default they are ``count`` stretches of time per log.
    Nonlinear parameters, width, weights and bounds stay those of the whole fit; the linear parameters,
    by far the most, are refitted. A column that is zero on all other blocks counts as absent.
    """
    regression, solution = found.regression, found.fit
    block = time_blocks(regression.log, count) if block is None else block
    residual = np.empty_like(solution.residual)
    # Each block is factored once: what is left without it is the factors of all others.
    numbers = np.unique(block)
    factors = {b: joint_factors(regression.rows(block == b)) for b in numbers}
    for b in numbers:
        others = [factors[k] for k in numbers if k != b]
        values = values_on([np.concatenate(parts) for parts in zip(*others, strict=True)], solution)
        out = block == b
        columns = regression.columns[out]
        residual[out] = regression.target[out] - columns @ solution.base.expand(values)
    return residual


def least_known(found: Estimate, names: Collection[str], block: np.ndarray) -> float:
    """Least part of what a log tells of some columns that is left where one of its blocks is held out.

    Of what the other columns cannot imitate, in the direction that is known least; 1 for no columns.

    Args:
        found: The fit.
        names: Names of the columns.
        block: Number of every row's block, (T,).
    """
    regression, base = found.regression, found.fit.base
    own = [k for k, name in enumerate(regression.names) if name in names]
    if not own:
        return 1.0
    order = [k for k in base.kept if k not in own] + own
    columns = regression.columns[:, :, order] / found.fit.sigma[:, None]
    factors = [
        triangular_factor(columns[block == b].reshape(-1, len(order))) for b in np.unique(block)
    ]

    def free(parts: list[np.ndarray]) -> np.ndarray:
        return triangular_factor(np.concatenate(parts))[-len(own) :, -len(own) :]

    whole = free(factors)
    rest = [free(factors[:k] + factors[k + 1 :]) for k in range(len(factors))]
    if len(factors) < 2 or not np.diag(whole).all():
        return 0.0
    left = [scipy.linalg.solve_triangular(whole, r.T, trans="T") for r in rest]
    return min(float(np.linalg.norm(x, -2) ** 2) for x in left)


def held_out_errors(found: Estimate, count: int = 5) -> dict:
    """Errors on held-out blocks of time, as :func:`torque_errors`."""
    regression, residual = found.regression, held_out_residual(found, count)
    used = np.ones(len(residual), bool) if regression.used is None else regression.used
    measured = regression.torque[used]
    return torque_errors(measured, measured - residual[used], regression.moving[used])
