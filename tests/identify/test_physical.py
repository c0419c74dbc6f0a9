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
    factor_of,
    parameters_of,
    pseudo_inertia,
    violations,
)
from jaxswarm.identify.physical.projection import Further, nearest_physical, plain_prior
from jaxswarm.robot import kuka_kr300, kuka_kr300_cad_parameters, regressor, rx60
from jaxswarm.robot.placements import body_parameters

BODY = body_parameters(3.0, [0.1, -0.2, 0.05], np.diag([0.03, 0.05, 0.04]))


def test_any_positive_definite_matrix_is_a_physical_body():
    draws = np.random.default_rng(0).normal(size=(200, 4, 4)) * 1.5
    for row in parameters_of(draws @ draws.swapaxes(-1, -2)):
        assert body_violations(row) == ()
        assert distance(row) < 1e-9 * np.abs(row).max()


def test_factor_and_pseudo_inertia_invert():
    factor = factor_of(BODY)
    np.testing.assert_allclose(factor, np.triu(factor))
    np.testing.assert_allclose(parameters_of(factor @ factor.T), BODY, atol=1e-15)
    np.testing.assert_allclose(parameters_of(pseudo_inertia(BODY)), BODY, atol=1e-15)


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
            factor_of(row)


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


def objective(found, basis, beta, prior, pull):
    """What is minimized: the squared cost and the divergence from the prior."""
    relative = [
        np.linalg.solve(pseudo_inertia(a), pseudo_inertia(b))
        for a, b in zip(prior, found, strict=True)
    ]
    divergence = sum(np.trace(r) - np.linalg.slogdet(r)[1] - 4.0 for r in relative)
    return np.sum((beta - basis @ found.ravel()) ** 2) + pull**2 * divergence


@pytest.mark.parametrize("seed", range(3))
def test_projection_of_six_links_is_the_minimum(seed):
    """The problem is convex: no way towards another set of bodies begins downwards."""
    rng = np.random.default_rng(seed)
    draw = rng.normal(size=(7, 6, 4, 6)) * 0.5
    prior, *others = parameters_of(draw @ draw.swapaxes(-1, -2))
    basis = rng.normal(size=(45, 60)) * np.logspace(0.0, 2.0, 45)[:, None]
    beta = basis @ (prior + 0.4 * rng.normal(size=prior.shape)).ravel()
    found = nearest_physical(basis, beta, prior=prior, weight=np.eye(45), pull=0.03)
    least = objective(found.parameters, basis, beta, prior, 0.03)
    for other in [prior, *others]:
        for share in (1e-2, 1e-4):
            there = found.parameters + share * (other - found.parameters)
            assert objective(there, basis, beta, prior, 0.03) >= least * (1.0 - 1e-9)


def test_projection_is_the_same_in_millimeters():
    rng = np.random.default_rng(0)
    units = np.repeat([1.0, 1e3, 1e6], [1, 3, 6])
    draw = rng.normal(size=(2, 4, 6)) * 0.5
    prior = parameters_of(draw @ draw.swapaxes(-1, -2))
    basis, beta = rng.normal(size=(12, 20)), rng.normal(size=12)
    meters = nearest_physical(basis, beta, prior=prior, weight=np.eye(12), pull=0.1)
    scaled = basis / np.tile(units, 2)
    found = nearest_physical(scaled, beta, prior=prior * units, weight=np.eye(12), pull=0.1)
    np.testing.assert_allclose(found.parameters / units, meters.parameters, rtol=1e-5, atol=1e-7)


def test_values_that_no_bodies_explain_have_nearest_ones_too():
    """As of a log in wrong units: a million standard errors from any body, and still an answer."""
    rng = np.random.default_rng(1)
    basis, beta = rng.normal(size=(30, 60)), 1e7 * rng.normal(size=30)
    weight = np.triu(rng.normal(size=(30, 30)))
    prior, lower = plain_prior(5), np.zeros(10)
    further = Further(lower + 1.0, lower, np.full(10, np.inf))
    found = nearest_physical(basis, beta, prior=prior, weight=weight, pull=1e-4, further=further)
    assert all(body_violations(row) == () for row in found.parameters)
    assert np.isfinite(found.cost) and (found.further >= 0.0).all()
    again = nearest_physical(basis, beta, prior=prior, weight=weight, pull=1e-4, further=further)
    assert again.parameters.tobytes() == found.parameters.tobytes()


def test_mismatched_shapes_are_refused():
    with pytest.raises(InputError, match="base_matrix"):
        nearest_physical(jnp.eye(3), np.ones(3), prior=plain_prior(1))
