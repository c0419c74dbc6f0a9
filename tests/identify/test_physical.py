"""Physical consistency: coordinates, reasons, distance and projection."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.identify.physical.consistency import (
    body_violations,
    check_physical,
    distance,
    from_log_cholesky,
    log_cholesky_slopes,
    parameters_of,
    pseudo_inertia,
    to_log_cholesky,
    violations,
)
from jaxswarm.identify.physical.projection import nearest_physical, plain_prior
from jaxswarm.robot import kuka_kr300, kuka_kr300_cad_parameters, regressor, rx60
from jaxswarm.robot.placements import body_parameters

BODY = body_parameters(3.0, [0.1, -0.2, 0.05], np.diag([0.03, 0.05, 0.04]))


def test_any_coordinates_give_a_physical_body():
    draws = np.random.default_rng(0).normal(size=(200, 10)) * 1.5
    for row in from_log_cholesky(draws):
        assert body_violations(row) == ()
        assert distance(row) < 1e-9 * np.abs(row).max()


def test_coordinates_and_pseudo_inertia_invert():
    np.testing.assert_allclose(from_log_cholesky(to_log_cholesky(BODY)), BODY, atol=1e-13)
    np.testing.assert_allclose(parameters_of(pseudo_inertia(BODY)), BODY, atol=1e-15)


def test_slopes_of_the_coordinates_are_their_differences():
    at = np.random.default_rng(0).normal(size=(3, 10))
    step = 1e-6 * np.eye(10)[:, None]
    differences = (from_log_cholesky(at + step) - from_log_cholesky(at - step)) / 2e-6
    slopes = log_cholesky_slopes(at)
    np.testing.assert_allclose(np.moveaxis(differences, 0, -1), slopes, atol=1e-7)


def test_second_moments_of_a_point_cloud_are_the_pseudo_inertia():
    rng = np.random.default_rng(0)
    mass, place = rng.uniform(0.1, 1.0, 30), rng.normal(size=(30, 3))
    homogeneous = np.c_[place, np.ones(30)]
    cloud = sum(body_parameters(m, p, np.zeros((3, 3))) for m, p in zip(mass, place, strict=True))
    expected = np.einsum("k,ki,kj->ij", mass, homogeneous, homogeneous)
    np.testing.assert_allclose(pseudo_inertia(cloud), expected, atol=1e-12)


def test_the_paper_truth_of_the_rx60_is_refused_with_the_reason():
    told = violations(rx60(), inertia_only=True)
    assert [text.split(" (")[0] for text in told] == ["link 2", "link 3"]
    assert told[1].startswith("link 3 (joint3): abs(Ixx - Iyy) = 1.073 > Izz = 0.5472 kg m^2")
    with pytest.raises(InputError, match="link 3"):
        check_physical(rx60())


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({0: -1.0}, "mass -1 kg is not positive"),
        ({4: 9.0}, "abs("),
        ({1: 2.0}, "about the center of mass"),
        ({5: 0.3}, "principal moment"),
        ({9: np.nan}, "finite"),
    ],
)
def test_every_violation_has_its_reason(change, reason):
    row = BODY.copy()
    for index, value in change.items():
        row[index] = value
    assert any(reason in text for text in body_violations(row))
    if np.isfinite(row).all():
        assert distance(row) > 1e-4
        with pytest.raises(InputError):
            to_log_cholesky(row)


def test_point_masses_lie_on_the_boundary_and_are_accepted():
    robot = kuka_kr300().replace(parameters=kuka_kr300_cad_parameters())
    assert violations(robot) == ()


def base_of(robot, seed):
    """Base combinations of a robot by a singular value decomposition of its regressor."""
    samples = np.random.default_rng(seed).normal(size=(3, 60, robot.num_joints))
    rows = jax.jit(jax.vmap(lambda *s: regressor(robot, *s)))(*samples).reshape(-1, 30)
    _, singular, basis = np.linalg.svd(np.asarray(rows), full_matrices=False)
    return basis[singular > 1e-9 * singular[0]], np.asarray(rows)


def test_projection_keeps_base_values_that_a_body_can_have():
    robot = rx60()
    bodies = np.stack([BODY, BODY * 0.7, BODY * 0.3])
    basis, _ = base_of(robot, 0)
    beta = basis @ bodies.ravel()
    found = nearest_physical(basis, beta, prior=plain_prior(3), pull=1e-4)
    assert violations(robot.replace(parameters=found.parameters)) == ()
    assert np.abs(found.base_error).max() < 1e-3 * np.abs(beta).max()


def test_projection_of_the_paper_truth_stays_physical_and_pays_in_torque():
    robot = rx60()
    basis, rows = base_of(robot, 1)
    beta = basis @ robot.parameters.ravel()
    weight = np.linalg.qr(rows @ basis.T, mode="r") / np.sqrt(len(rows))
    found = nearest_physical(basis, beta, prior=plain_prior(3), weight=weight, pull=1e-4)
    assert violations(robot.replace(parameters=found.parameters)) == ()
    torque = rows @ (found.parameters - robot.parameters).ravel()
    assert abs(np.sqrt(np.mean(torque**2) * 1.0) - found.cost) < 1e-6
    assert found.cost > 0.05


def test_mismatched_shapes_are_refused():
    with pytest.raises(InputError, match="base_matrix"):
        nearest_physical(jnp.eye(3), np.ones(3), prior=plain_prior(1))
