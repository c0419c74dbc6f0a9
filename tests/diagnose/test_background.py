"""What a model can absorb: projections against explicit refits."""

import numpy as np
import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.folds.bends import width_slopes
from jaxswarm.diagnose.folds.noise import robust_weight
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term


@pytest.fixture(scope="module")
def case():
    spring = Term("joint_spring", 1, values={"k": 5.0, "tau0": 0.5})
    return declared_fit(log_with(spring))


def weighted(found, crossfit):
    """The model's columns and the torque, weighted."""
    columns = found.regression.columns[:, :, found.fit.base.kept]
    return crossfit.weigh(columns), found.regression.torque * crossfit.weight


def test_free_part_is_orthogonal_to_the_model_on_training_rows(case):
    found, crossfit = case
    columns, _ = weighted(found, crossfit)
    candidate = crossfit.weigh(np.random.default_rng(0).normal(size=(*columns.shape[:2], 3)))
    for fold in crossfit.folds:
        free = fold.free_part(candidate)[fold.train].reshape(-1, 3)
        model = columns[fold.train].reshape(-1, columns.shape[2])
        model = model / np.linalg.norm(model, axis=0)
        np.testing.assert_allclose(model.T @ free, 0.0, atol=1e-9 * np.linalg.norm(free))


def test_held_out_residual_equals_an_explicit_refit(case):
    found, crossfit = case
    """What its joints' own sign widths would do is known within a factor of e."""
    columns, torque = weighted(found, crossfit)
    slopes = crossfit.weigh(width_slopes(found))
    columns, widths = np.concatenate([columns, slopes], axis=2), slopes.shape[2]
    known = np.eye(columns.shape[2])[-widths:]
    for fold in crossfit.halves:
        a = np.concatenate([columns[fold.train].reshape(-1, columns.shape[2]), known])
        y = np.append(torque[fold.train].ravel(), np.zeros(widths))
        scale = np.linalg.norm(a, axis=0)
        theta = np.linalg.lstsq(a / scale, y, rcond=1e-12)[0] / scale
        np.testing.assert_allclose(fold.residual, torque - columns @ theta, atol=1e-6)


def test_what_the_model_can_do_is_absorbed_whole_and_given_back_as_parameters(case):
    found, crossfit = case
    columns = weighted(found, crossfit)[0][:, :, : found.fit.base.size]
    change = np.random.default_rng(1).normal(size=columns.shape[2])
    torque = columns @ change
    for fold in crossfit.folds:
        free = fold.free_part(torque[:, :, None])
        assert np.abs(free).max() < 1e-8 * np.abs(torque).max()
        np.testing.assert_allclose(columns @ fold.absorbed(torque), torque, atol=1e-7)


def test_halves_share_no_rows_and_cover_all(case):
    _, crossfit = case
    first, second = (fold.train for fold in crossfit.halves)
    assert (first ^ second).all()
    assert crossfit.whole.train.all()
    for block in np.unique(crossfit.block):
        assert np.ptp(first[crossfit.block == block].astype(int)) == 0


def test_a_frozen_model_absorbs_nothing(case):
    found, _ = case
    crossfit = cross_fit(found, frozen=True)
    candidate = np.ones((*crossfit.weight.shape, 1))
    np.testing.assert_array_equal(crossfit.whole.free_part(candidate), candidate)
    np.testing.assert_allclose(crossfit.whole.residual, found.fit.residual * crossfit.weight)


def test_outliers_are_bounded_and_do_not_count_as_noise():
    residual = np.random.default_rng(0).normal(size=(2000, 1)) * 0.3
    residual[::100] = 50.0
    weight = robust_weight(residual)
    assert np.median(weight) == pytest.approx(1 / 0.3, rel=0.1)
    np.testing.assert_allclose((residual * weight)[::100], 4.0)


def test_effective_samples_are_fewer_where_the_residual_is_structured(case):
    structured = case[1].effective
    clean = declared_fit(log_with())[1].effective
    assert structured < 0.5 * clean


def test_columns_on_one_joint_need_its_rows_only(case):
    found, crossfit = case
    own = np.random.default_rng(0).normal(size=(len(found.fit.residual), 4))
    columns = np.zeros((*found.fit.residual.shape, 4))
    columns[:, 1] = own
    for fold in crossfit.folds:
        np.testing.assert_allclose(
            fold.free_rows(own, 1), fold.free_part(columns)[:, 1], atol=1e-10
        )
