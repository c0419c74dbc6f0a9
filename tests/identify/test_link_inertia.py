"""The inertia of a soft joint's link stays positive, and least squares keep to inequalities."""

import clarabel
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy import optimize, sparse

from jaxswarm.effects.term import parse_terms
from jaxswarm.identify.estimation.factors import triangular_factor
from jaxswarm.identify.estimation.inequalities import solve_above
from jaxswarm.identify.estimation.least_squares import fit
from jaxswarm.identify.estimation.link_inertia import link_inertias
from jaxswarm.identify.forward.regression import Regression
from jaxswarm.robot import load_robot, mass_matrix


class Reached:
    """Positions of a log, all that is asked of one."""

    q = np.array([[-1.0, -0.5, 0.0], [1.0, 0.5, 0.7]])


def test_rows_are_the_inertia_of_the_link_in_every_position():
    arm = load_robot("rx60")
    rows = link_inertias(arm, parse_terms("joint_elasticity@joint2", arm.joints), [Reached])
    own = np.array(
        [
            mass_matrix(arm, q)[1, 1]
            for q in np.random.default_rng(0).uniform(-np.pi, np.pi, (256, 3))
        ]
    )
    seen = rows @ np.asarray(arm.parameters).ravel()
    assert np.allclose(seen, own - 0.02 * own.mean(), rtol=1e-9)
    assert (seen > 0).all()
    assert link_inertias(arm, parse_terms("coulomb_friction", arm.joints), [Reached]) is None


@settings(max_examples=60, deadline=None)
@example(212, 5, 19)
@example(7250, 3, 27)
@example(520, 6, 7)
@given(st.integers(0, 10_000), st.integers(1, 6), st.integers(1, 30))
def test_inequalities_against_an_interior_point_solver(seed, size, count):
    rng = np.random.default_rng(seed)
    matrix, target = rng.normal(size=(40, size)), rng.normal(size=40)
    rows, inside = rng.normal(size=(count, size)), rng.normal(size=size)
    least = rows @ inside - rng.uniform(0.0, 1.0, count)
    ours = solve_above(triangular_factor(np.column_stack([matrix, target])), rows, least)

    def cost(x):
        return float(((matrix @ x - target) ** 2).sum())

    assert (rows @ ours >= least - 1e-8).all()
    quiet = clarabel.DefaultSettings()
    quiet.verbose = False
    peer = clarabel.DefaultSolver(
        sparse.csc_matrix(np.triu(2.0 * matrix.T @ matrix)),
        -2.0 * matrix.T @ target,
        sparse.csc_matrix(-rows),
        -least,
        [clarabel.NonnegativeConeT(count)],
        quiet,
    ).solve()
    least_cost = cost(np.array(peer.x))
    if peer.status != clarabel.SolverStatus.Solved:
        # On the third example it stays far from the minimum; another peer goes on from a point inside.
        within = {"type": "ineq", "fun": lambda x: rows @ x - least, "jac": lambda x: rows}
        found = optimize.minimize(
            cost,
            inside,
            method="SLSQP",
            constraints=[within],
            options={"ftol": 1e-12, "maxiter": 500},
        )
        assert found.success
        least_cost = found.fun
    # A peer ends within its own tolerance of the minimum, and may end a hair outside.
    assert cost(ours) == pytest.approx(least_cost, rel=1e-6)


@pytest.mark.parametrize("lower", [None, np.array([0.2, -9.0])])
def test_a_fit_that_would_leave_a_negative_inertia(lower):
    rng = np.random.default_rng(3)
    columns = rng.normal(size=(400, 1, 2))
    torque = columns @ np.array([1.0, -1.5]) + 0.1 * rng.normal(size=(400, 1))
    rows = Regression(
        ("a", "b"),
        columns,
        torque,
        np.ones((400, 1), bool),
        np.arange(400.0),
        np.zeros(400, int),
        1.0,
    )
    upper = None if lower is None else np.full(2, np.inf)
    free = fit(rows, lower, upper)
    assert np.allclose(free.theta, [1.0, -1.5], atol=0.05)
    held = fit(rows, lower, upper, above=np.array([[0.5, 1.0]]))
    assert held.theta @ [0.5, 1.0] == pytest.approx(0.0, abs=1e-9)
    assert (held.theta >= (-np.inf if lower is None else lower)).all()
    assert held.sigma[0] > free.sigma[0]
