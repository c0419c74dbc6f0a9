r"""Fitting changes to what an earlier model leaves, with all that makes them uncertain.

With X the columns of the changes and W those of the earlier model, the changes are :math:`A r`, A the
weighted pseudo-inverse of X. Three errors enter: that of the new log (Newey-West, as everywhere), that of
the earlier parameters, which A W carries into the changes, and that of the drive gains. An event is told by the
few rows that it lasts, which no sandwich of blocks of time can weigh: its torque is as uncertain as the mean of
that many rows of what is left elsewhere, and as its begin and end. An earlier model
identified with the same gains has their error in its own parameters; what is left on joint j is then
scaled as a whole, and a relative error s of the gain adds :math:`s A X_j \delta`.

The gains of an arm as two sources publish them differ by 13 to 49 %: no load that is weighed, no scale.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy

from jaxswarm.decomposition import lstsq
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.selection.earlier_model import earlier_covariance
from jaxswarm.identify.estimation.base_parameters import BaseParameters
from jaxswarm.identify.estimation.covariance import correlation_length
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.events import edges as event_edges
from jaxswarm.identify.estimation.least_squares import Fit, fit
from jaxswarm.identify.estimation.validate import time_blocks
from jaxswarm.identify.forward.regression import Regression
from jaxswarm.identify.physical.projection import nearest_physical, plain_prior

# Relative standard error of a drive gain that nobody weighed a load against.
_GAIN_ERROR = 0.1
# Body from which a payload departs where the log says nothing of it: mass [kg], radius of gyration [m].
_PRIOR_MASS, _PRIOR_SIZE = 1.0, 0.1


class Coefficients(NamedTuple):
    """Coefficients of all columns of the changes, k of them.

    Attributes:
        values: Zero where one merges into others, (k,).
        covariance: NaN where one cannot be told from others, (k, k).
        response: How an error of the earlier parameters comes out in them, (k, p).
        edges: Standard error of every event's begin and end by its number among the changes [s].
        fit: The fit that they are of.
    """

    values: np.ndarray
    covariance: np.ndarray
    response: np.ndarray
    edges: dict[int, float]
    fit: Fit


def change_rows(before: Estimate, candidates: Sequence[Candidate]) -> Regression:
    """What the earlier model leaves as a regression on the columns of the changes."""
    columns = np.concatenate([c.columns[0] for c in candidates], axis=2)
    regression = before.regression
    return Regression(
        tuple(f"{k}" for k in range(columns.shape[2])),
        regression.counted(columns),
        before.fit.residual,
        regression.moving,
        regression.t,
        regression.log,
        regression.step,
        share=regression.share,
    )


def crossed(before: Estimate, candidates: Sequence[Candidate]) -> np.ndarray:
    """Residual of each half of the blocks with the changes fitted to the other half."""
    rows = change_rows(before, candidates)
    odd = time_blocks(rows.log, 20) % 2 == 1
    residual = np.empty_like(rows.torque)
    for part in (odd, ~odd):
        theta = fit(rows.rows(~part)).theta
        residual[part] = rows.torque[part] - rows.columns[part] @ theta
    return residual


def fit_changes(before: Estimate, candidates: Sequence[Candidate]) -> Coefficients:
    """Fit all changes together; a payload is held to bodies that exist, put on or taken off."""
    rows = change_rows(before, candidates)
    solution = fit(rows)
    kept = solution.base.kept
    # W and X in units of the noise, and A of the text.
    scaled = (rows.columns[:, :, kept] / solution.sigma[:, None]).reshape(-1, len(kept))
    earlier = (before.regression.columns / solution.sigma[:, None]).reshape(len(scaled), -1)

    def through(torque: np.ndarray) -> np.ndarray:
        half = scipy.linalg.solve_triangular(solution.factor, scaled.T @ torque, trans="T")
        return scipy.linalg.solve_triangular(solution.factor, half)

    response = through(earlier)
    told, edges = _events(rows, solution, candidates)
    covariance = told + response @ earlier_covariance(before) @ response.T
    for joint in np.flatnonzero(_known_by_gains(before)):
        own = np.zeros_like(rows.torque)
        own[:, joint] = rows.columns[:, joint, kept] @ solution.values / solution.sigma[joint]
        drift = _GAIN_ERROR * through(own.ravel())
        covariance += np.outer(drift, drift)
    return _expanded(solution, candidates, covariance, response, edges)


def _events(
    rows: Regression, solution: Fit, candidates: Sequence[Candidate]
) -> tuple[np.ndarray, dict[int, float]]:
    """Covariance (b, b) of the fit with that of every event's torque in it, and errors of begin and end [s]."""
    covariance, start = solution.covariance.copy(), 0
    edges: dict[int, float] = {}
    happened = [c for c in candidates if c.term.law.recurring]
    if not happened:
        return covariance, edges
    quiet = ~np.any([c.columns[0].any(axis=(1, 2)) for c in happened], axis=0)
    left = np.where(quiet[:, None], solution.residual, 0.0)
    sigma = np.sqrt((left**2).sum(axis=0) / max(int(quiet.sum()), 1)) + 1e-12
    memory = correlation_length(left / sigma, rows.log)
    for number, candidate in enumerate(candidates):
        own = slice(start, start + candidate.columns[0].shape[2])
        start = own.stop
        if not candidate.term.law.recurring:
            continue
        inside = (solution.base.kept >= own.start) & (solution.base.kept < own.stop)
        values, columns = solution.values[inside], rows.columns[:, :, solution.base.kept[inside]]
        torque = np.abs(columns @ values).max(axis=0)
        step = rows.step[int(candidate.term.values.get("log", 0))]
        edges[number], relative = event_edges(candidate.term, torque, sigma, memory, step)
        mean = memory / ((columns / sigma[:, None]) ** 2).sum(axis=(0, 1))
        covariance[inside] = covariance[:, inside] = 0.0
        covariance[np.ix_(inside, inside)] = np.diag(mean + (relative * values) ** 2)
    return covariance, edges


def _expanded(
    solution: Fit, candidates: Sequence[Candidate], covariance, response, edges
) -> Coefficients:
    """Base values (b,) on all columns, a payload's as those of the nearest body."""
    base, values = solution.base, solution.values
    size, bodies, start = len(base.names), [], 0
    for candidate in candidates:
        own = slice(start, start + candidate.columns[0].shape[2])
        if getattr(candidate.term.law, "body", None) is not None:
            body = _nearest_body(base, values, covariance, own)
            inside = np.flatnonzero((base.kept >= own.start) & (base.kept < own.stop))
            # What the others were found to be beside the payload goes with it.
            step = base.reduce(_placed(body, own, size))[inside] - values[inside]
            spread = covariance[np.ix_(inside, inside)]
            values = values + covariance[:, inside] @ lstsq(spread, step, rcond=1e-12)
            bodies.append((own, body))
        start = own.stop
    full = base.expand(values)
    for own, body in bodies:
        full[own] = body
    spread = np.full((size, size), np.nan)
    spread[np.ix_(base.kept, base.kept)] = covariance
    whole = np.zeros((size, response.shape[1]))
    whole[base.kept] = response
    return Coefficients(full, spread, whole, edges, solution)


def _placed(own_values: np.ndarray, own: slice, size: int) -> np.ndarray:
    full = np.zeros(size)
    full[own] = own_values
    return full


def _nearest_body(base: BaseParameters, values, covariance, own: slice) -> np.ndarray:
    """Parameters (10,) of the body whose base parameters are nearest to those found, by their covariance.

    A body that was taken off counts with all of its parameters below zero: the nearer of the two is told.
    """
    inside = np.flatnonzero((base.kept >= own.start) & (base.kept < own.stop))
    merge = base.reduce(np.eye(len(base.names)))[own, inside].T
    size, axes = np.linalg.eigh(covariance[np.ix_(inside, inside)])
    size = np.maximum(size, 1e-12 * size[-1])
    weight = (axes / np.sqrt(size)).T
    prior = plain_prior(1, mass=_PRIOR_MASS, size=_PRIOR_SIZE)
    put_on, taken_off = (
        nearest_physical(merge, sign * values[inside], prior=prior, weight=weight)
        for sign in (1.0, -1.0)
    )
    return put_on.parameters[0] if put_on.cost <= taken_off.cost else -taken_off.parameters[0]


def _known_by_gains(before: Estimate) -> np.ndarray:
    """Whether a joint's torque is a current times a drive gain, (n,)."""
    gains = np.isfinite(np.asarray(before.model.robot.drive_gain))
    return gains & any("current" in m.channels for m in before.motions)
