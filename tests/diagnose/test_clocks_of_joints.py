"""Clocks of single joints: what a drive's late or early torque looks like, and how much of it is believed."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, DECLARED, declared_fit, log_with, small_arm

from jaxswarm.diagnose.folds.clocks import clock_slopes
from jaxswarm.diagnose.folds.partial_out import Fold, _fold
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation.estimate import CLOCKS_APART
from jaxswarm.identify.forward.model import model_torque
from jaxswarm.identify.synthetic import Noise
from jaxswarm.logs.motion import prepare

# A part of a sample by which a torque is read apart.
EARLY = 0.5


@pytest.fixture(scope="module")
def clean():
    return log_with(noise=Noise(2e-5, 1e-4))


def residual_changed(log, tau) -> tuple[np.ndarray, np.ndarray]:
    """How another torque changes what one and the same model leaves, and the model's clock columns."""
    found, _ = declared_fit(log)
    moved = prepare(replace(log, tau=tau), BAND)
    (motion,) = found.motions
    change = motion.decimator.apply(moved.tau - motion.tau)
    return change, clock_slopes(found)


def test_a_torque_read_early_is_the_column_of_its_joint(clean):
    step = float(np.median(np.diff(clean.t)))
    tau = clean.tau.copy()
    tau[:, 0] = np.interp(clean.t + EARLY * step, clean.t, tau[:, 0])
    change, slopes = residual_changed(clean, tau)
    assert not change[:, 1].any()
    inside = slice(20, -20)
    told = EARLY / CLOCKS_APART * slopes[inside, 0, 0]
    # a straight line between samples takes off a little
    assert np.std(change[inside, 0] - told) < 0.15 * np.std(told)
    assert not slopes[:, 0, 1].any()
    assert not slopes[:, 1, 0].any()


def test_a_weight_held_is_the_column_of_the_weight(clean):
    found, _ = declared_fit(clean)
    (motion,) = found.motions
    still = replace(motion, dq=0 * motion.dq, ddq=0 * motion.ddq)
    weight = model_torque(found.model, still)
    step = motion.interval
    later = np.column_stack([np.interp(motion.t + EARLY * step, motion.t, w) for w in weight.T])
    change = motion.decimator.apply(later - weight)
    slopes = clock_slopes(found)
    for joint in range(2):
        told = EARLY / CLOCKS_APART * slopes[:, joint, 2 + joint]
        inside = slice(5, -5)
        np.testing.assert_allclose(
            told[inside], change[inside, joint], atol=0.03 * np.abs(change[:, joint]).max()
        )


def test_coefficients_that_are_known_are_as_one_more_row_each():
    rng = np.random.default_rng(0)
    columns, torque = rng.normal(size=(40, 2, 3)) * [1.0, 0.1, 0.01], rng.normal(size=(40, 2))
    train = np.arange(40) % 2 == 0
    fold = _fold(columns, torque, train, 3, known=True)
    rows = np.concatenate([columns[train].reshape(-1, 3), np.eye(3)])
    target = np.concatenate([torque[train].ravel(), np.zeros(3)])
    x = np.linalg.lstsq(rows, target, rcond=None)[0]
    np.testing.assert_allclose(fold.residual, torque - columns @ x, atol=1e-12)
    other = rng.normal(size=(40, 2, 1))
    held = np.concatenate([other[train].ravel(), np.zeros(3)])
    y = np.linalg.lstsq(rows, held, rcond=None)[0]
    np.testing.assert_allclose(
        fold.free_part(other)[:, :, 0], other[:, :, 0] - columns @ y, atol=1e-12
    )


def test_further_columns_that_are_known_take_no_more_than_they_may(clean):
    """What a clock of ten samples would explain is left: only a part of a sample is believed."""
    found = estimate(
        small_arm(), tuple(replace(t, values={}) for t in DECLARED), [prepare(clean, BAND)]
    )
    rows = np.ones(len(found.regression.t), bool)
    empty = np.zeros((*found.regression.torque.shape, 0))
    clocks = clock_slopes(found)[:, :, :1] / found.fit.sigma[:, None]
    fold = Fold(rows, empty, empty, 1e-3 * clocks[:, :, 0], np.zeros((0, 0)), np.zeros(0))
    weak = replace(fold, residual=10.0 * fold.residual).with_columns(1e-3 * clocks, known=True)
    # noise of one a row against a prior of one: that little is hardly seen, so that little is taken off
    before = np.sum((10.0 * fold.residual) ** 2)
    assert np.sum(weak.residual**2) > 0.5 * before
    strong = replace(fold, residual=0.5 * clocks[:, :, 0]).with_columns(clocks, known=True)
    assert np.sum(strong.residual**2) < 0.01 * np.sum((0.5 * clocks[:, :, 0]) ** 2)


def test_rows_that_are_not_used_leave_no_edge_in_the_columns(clean):
    """Torques of rows that are not used are zero, and no drive is late where they jump there."""
    found, _ = declared_fit(clean)
    whole = clock_slopes(found)
    used = np.ones(found.regression.torque.shape)
    used[40:60, 0] = 0.0
    torque = used * found.regression.torque
    residual = used * found.fit.residual
    regression = replace(found.regression, torque=torque, share=used)
    parted = clock_slopes(
        replace(found, regression=regression, fit=replace(found.fit, residual=residual))
    )
    assert not parted[40:60, 0, 0].any()
    assert np.abs(parted[:, 0, 0]).max() < 1.5 * np.abs(whole[:, 0, 0]).max()
    np.testing.assert_array_equal(parted[:, 1, 1], whole[:, 1, 1])
