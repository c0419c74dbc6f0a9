"""A model identified before on new logs: nothing is fitted, and how certain it was is kept."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.identify.estimation.base_parameters import find_base
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.least_squares import Fit
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.model import Model, linear_values, smooth_torque
from jaxswarm.identify.forward.regression import build_regression
from jaxswarm.logs.motion import Motion


def freeze(model: Model, motions: Sequence[Motion]) -> Estimate:
    """An earlier model on new logs, as an estimate in which nothing was fitted."""
    rigids = tuple(rigid_of(model.robot, m) for m in motions)
    pi = np.asarray(model.robot.parameters).ravel()
    # A body that was added is in the last link's parameters.
    terms = tuple(t for t in model.terms if not (t.law.reference_only and not t.law.recurring))
    model = replace(model, terms=terms)
    regression = build_regression(model.robot, terms, motions, model.width, pi, rigids)
    theta = linear_values(model)
    smooth = [m.decimator.apply(smooth_torque(model, m)) for m in motions]
    regression = replace(regression, torque=regression.torque - np.concatenate(smooth))
    residual = regression.target - regression.columns @ theta
    sigma = np.sqrt((residual**2).mean(axis=0)) + 1e-12
    flat = regression.columns.reshape(-1, regression.columns.shape[2])
    base = find_base(flat, regression.names)
    size = base.size
    frozen = Fit(
        base, base.reduce(theta), np.zeros((size, size)), sigma, np.eye(size), np.zeros(size), 0.0,
        residual, np.zeros(size, bool), float(len(residual)),
    )  # fmt: skip
    errors = tuple({p.name: 0.0 for p in t.law.parameters} for t in terms)
    return Estimate(model, frozen, regression, tuple(motions), rigids, errors)


def earlier_covariance(before: Estimate) -> np.ndarray:
    """Covariance (p, p) of a frozen model's linear parameters; zeros where its file told none."""
    names = before.regression.names
    known = before.model.uncertainty
    return np.zeros((len(names), len(names))) if known is None else known.on(names)
