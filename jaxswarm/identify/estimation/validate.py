"""Errors on motion that was not fitted: another log, or blocks of time held out one after the other."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
import scipy

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.factors import joint_factors, triangular_factor
from jaxswarm.identify.estimation.least_squares import values_on
from jaxswarm.identify.forward.link_lag import slope_terms, unseen_samples, unseen_start
from jaxswarm.identify.forward.metrics import is_moving, torque_errors
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.logs.motion import Motion
from jaxswarm.memory import joined


def log_errors(
    model: Model,
    *motions: Motion,
    terms: Sequence[Term] | None = None,
    events: Sequence[tuple[float, float]] = (),
) -> dict:
    """Errors of a model on one log, in the band that is compared and over the whole signal.

    A link on a spring may swing in the first seconds by what was before the log. Nobody can predict that: it
    is left out, as it is of a fit.

    Args:
        model: The model.
        motions: The log's stretches between gaps, at least one.
        terms: Terms whose links are thought of; those of the model by default. Models that are compared have
            to leave out the same.
        events: Stretches of the log [s] that are left out too.

    Returns:
        :func:`torque_errors` of the low-passed torque, with ``wideband`` the same of the torque as
        measured, ``torque_cutoff`` [Hz], and what is not scored: ``left_out_s``, how much at the start [s],
        and ``events``, begins and ends [s].
    """
    swinging = bool(slope_terms(tuple(model.terms if terms is None else terms)))
    scored = [outside(m.t, events) & ~(swinging & unseen_samples(m)) for m in motions]
    # A joint moves by its top speed in the whole log, not in each of its stretches.
    ends = np.cumsum([len(m.t) for m in motions])[:-1]
    moving = np.split(is_moving(joined([m.dq for m in motions])), ends)
    parts = [_compared(model, *given) for given in zip(motions, scored, moving, strict=True)]
    low, measured = zip(*parts, strict=True)
    errors = torque_errors(*map(joined, zip(*low, strict=True)))
    errors["wideband"] = torque_errors(*map(joined, zip(*measured, strict=True)))
    errors["torque_cutoff"] = motions[0].torque_cutoff
    errors["left_out_s"] = float(sum(unseen_start(m) for m in motions)) if swinging else 0.0
    errors["events"] = [{"start": start, "end": end} for start, end in events]
    return errors


def outside(t: np.ndarray, events: Sequence[tuple[float, float]]) -> np.ndarray:
    """Whether times (T,) lie outside of all stretches.

    >>> outside(np.array([0.0, 1.0, 2.0]), [(0.5, 1.0)]).tolist()
    [True, False, True]
    """
    calm = np.ones(len(t), dtype=bool)
    for start, end in events:
        calm &= (t < start) | (t > end)
    return calm


def _compared(
    model: Model, motion: Motion, scored: np.ndarray, moving: np.ndarray
) -> tuple[tuple, tuple]:
    """Torque, prediction and whether each joint moves, below the torque's cutoff and as measured."""
    kept = motion.decimator.kept(len(motion.t))
    predicted = model_torque(model, motion)
    low = motion.low_torque, motion.decimator.apply(predicted), moving[kept]
    wide = np.asarray(motion.tau), predicted, moving
    if scored.all() and motion.lost is None:  # of a long log a copy is as large as all else
        return low, wide
    rows = scored[kept] & ~motion.lost_rows
    samples = scored if motion.lost is None else scored & ~motion.lost
    return tuple(x[rows] for x in low), tuple(x[samples] for x in wide)


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
    found: Estimate,
    count: int = 5,
    block: np.ndarray | None = None,
    sigma: np.ndarray | None = None,
) -> np.ndarray:
    """Residual (T, n) where every block of rows is predicted by a fit to the others.

    The blocks are numbered by ``block`` (T,); by default they are ``count`` stretches of time per log.
    Nonlinear parameters, width, weights and bounds stay those of the whole fit, or the weights are by another
    one's ``sigma`` (n,); the linear parameters, by far the most, are refitted. A column that is zero on all
    other blocks counts as absent.
    """
    regression, solution = found.regression, found.fit
    solution = solution if sigma is None else replace(solution, sigma=sigma)
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
    """The least of :func:`known_without`; 1 for no columns."""
    return min(known_without(found, names, block), default=1.0)


def known_without(found: Estimate, names: Collection[str], block: np.ndarray) -> list[float]:
    """Parts of what a log tells of some columns that are left where each of its blocks is held out, in order.

    Of what the other columns cannot imitate, in the direction that is known least; 1 each for no columns.

    Args:
        found: The fit.
        names: Names of the columns.
        block: Number of every row's block, (T,).
    """
    regression, base = found.regression, found.fit.base
    # Of columns that others hold whole nothing is told anywhere.
    own = [k for k in base.kept if regression.names[k] in names]
    numbers = np.unique(block)
    if not own:
        return [1.0] * len(numbers)
    order = [k for k in base.kept if k not in own] + own
    columns = regression.columns[:, :, order] / found.fit.sigma[:, None]
    factors = [triangular_factor(columns[block == b].reshape(-1, len(order))) for b in numbers]

    def free(parts: list[np.ndarray]) -> np.ndarray:
        return triangular_factor(np.concatenate(parts))[-len(own) :, -len(own) :]

    whole = free(factors)
    if len(factors) < 2 or not np.diag(whole).all():
        return [0.0] * len(numbers)
    rest = [free(factors[:k] + factors[k + 1 :]) for k in range(len(factors))]
    left = [scipy.linalg.solve_triangular(whole, r.T, trans="T") for r in rest]
    return [float(np.linalg.norm(x, -2) ** 2) for x in left]


def held_out_errors(found: Estimate, count: int = 5) -> dict:
    """Errors on held-out blocks of time, as :func:`torque_errors`."""
    regression, residual = found.regression, held_out_residual(found, count)
    torque, used = regression.torque, regression.whole_rows
    return torque_errors(torque, torque - residual, regression.moving, used)
