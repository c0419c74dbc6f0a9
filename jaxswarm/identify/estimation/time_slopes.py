r"""What a torque says of when it was read: its change by time, and that of its parts, beside a model's columns.

A torque that is read :math:`s` late is :math:`\tau(t - s) \approx \tau(t) - s\,\dot\tau(t)`: one more column,
whose coefficient is that time. Friction, the weight and all of the torque may each have a time of its own.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.least_squares import fit
from jaxswarm.identify.forward.columns import torque_of
from jaxswarm.identify.forward.model import Model, linear_values
from jaxswarm.identify.forward.regression import Regression
from jaxswarm.logs.motion import Motion

# Rows that tell a time to a thousandth of a sample; of a longer log the middle is asked.
MOST_ROWS = 20_000
# A time is told from none from so many standard errors on, and a step that is below the second part of its
# standard error is nothing.
CERTAIN_CLOCK, SMALL_STEP = 3.0, 0.5


@dataclass(frozen=True)
class Rows:
    """The rows of a fit that are asked for times.

    Attributes:
        asked: Which of all rows, (T,).
        regression: Those.
        residual: What the fit leaves of their torque, (T', n).
    """

    asked: np.ndarray
    regression: Regression
    residual: np.ndarray

    @cached_property
    def slope(self) -> np.ndarray:
        """What it does to the model's torque that all of it is read late, (T', n)."""
        return -change_by_time(self.regression.torque - self.residual, self.regression)


def asked_rows(found: Estimate) -> Rows:
    """The rows that are asked: of a long log the middle."""
    regression, residual = found.regression, found.fit.residual
    asked = np.ones(len(residual), bool)
    beyond = len(residual) - MOST_ROWS
    if beyond <= 0:
        return Rows(asked, regression, residual)
    asked[: beyond // 2] = asked[beyond // 2 + MOST_ROWS :] = False
    return Rows(asked, regression.rows(asked), residual[asked])


def told_time(found: Estimate, rows: Rows, columns: np.ndarray) -> tuple[float, float]:
    """The coefficient of the last of such columns and its standard error, both zero where none is told.

    Friction of each joint may have a time of its own beside them.

    Args:
        found: A fit.
        rows: Of it.
        columns: What times do to the torque, (T', n, k).
    """
    if not columns[:, :, -1].any():
        return 0.0, 0.0
    regression = rows.regression
    beside = np.concatenate([friction_slopes(found.model, regression), columns], axis=2)
    names = (f"time {k}" for k in range(beside.shape[2]))
    wide = replace(
        regression,
        names=(*regression.names, *names),
        columns=np.concatenate([regression.columns, beside], axis=2),
        torque=rows.residual,
        shift=None,
    )
    told = fit(wide, sigma=found.fit.sigma)
    if told.base.kept[-1] != len(wide.names) - 1:
        return 0.0, 0.0  # it is what other columns say together
    return float(told.values[-1]), float(told.std_error[-1])


def friction_slopes(model: Model, regression: Regression) -> np.ndarray:
    """What it does to the torque that the dry friction of each joint is early by itself, (T, n, n).

    Args:
        model: The model.
        regression: Its rows, or some of them.
    """
    directed = [t for t in model.terms if t.law.uses_direction]
    names = {name for t in directed for name in t.columns(model.robot.joints)}
    own = np.array([name in names for name in regression.names], dtype=bool)
    friction = regression.columns[:, :, own] @ linear_values(model)[own]
    slope = -change_by_time(friction, regression)
    return slope[:, :, None] * np.eye(slope.shape[1])


def weight_slopes(found: Estimate) -> np.ndarray:
    """What it does to the torque that the weight is read late by itself, (T, n)."""
    regression = found.regression
    weight = np.zeros_like(regression.torque)
    for number, motion in enumerate(found.motions):
        weight[regression.log == number] = low_weight(found.model, motion)
    return -change_by_time(weight, regression)


def low_weight(model: Model, motion: Motion) -> np.ndarray:
    """Weight of a model's rigid body along a log, below the torque cutoff, (T', n)."""
    rest, pi = np.zeros_like(motion.q), np.asarray(model.robot.parameters).ravel()
    return motion.decimator.apply(torque_of(model.robot, motion.q, rest, rest, pi))


def change_by_time(torque: np.ndarray, regression: Regression) -> np.ndarray:
    """Derivative by time of torques (T, n) on the rows of a regression, log by log, so much as a row counts."""
    slope = np.zeros_like(torque)
    whole = torque if regression.share is None else _bridged(torque, regression.share == 1.0)
    for k in np.unique(regression.log):
        rows = regression.log == k
        if rows.sum() > 2:
            t = regression.t[rows]
            slope[rows] = scipy.interpolate.CubicSpline(t, whole[rows])(t, 1)
    return regression.counted(slope)


def _bridged(torque: np.ndarray, used: np.ndarray) -> np.ndarray:
    """Torques (T, n) with lines across the rows that do not count whole: a jump has no derivative."""
    rows = np.arange(len(torque))
    lines = [
        np.interp(rows, rows[u], x[u]) if u.any() else x
        for x, u in zip(torque.T, used.T, strict=True)
    ]
    return np.stack(lines, axis=1)
