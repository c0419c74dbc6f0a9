"""A law by the load is fitted with the load that the model has beside it, not with that of one without it."""

from dataclasses import replace

import numpy as np
import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.discovery.grammar import programs, skeleton
from jaxswarm.diagnose.discovery.moving_load import fitted_together
from jaxswarm.diagnose.discovery.problem import joint_problem
from jaxswarm.diagnose.discovery.screening import screen
from jaxswarm.diagnose.discovery.sums import Sum, free_columns, linear, polished, said, seen_beside
from jaxswarm.effects.postfix import fields_of

TRUE = ("q", "k", "*", "exp", "load", "*", "static_load", "*")
FACTOR, RATE = 0.02, 1.5


@pytest.fixture(scope="module")
def planted():
    """Joint 1 with exp(k q) load load0 in its torque as it is searched, and the loads of its true arm."""
    log = log_with()
    true = Linearization(*declared_fit(log))
    (motion,) = true.found.motions
    loads = {"load": true.loads[0].full[:, 0], "static_load": true.loads[0].static[:, 0]}
    law = FACTOR * np.exp(RATE * motion.q[:, 0]) * loads["load"] * loads["static_load"]
    tau = log.tau.copy()
    tau[:, 0] += np.interp(log.t, motion.t, law)
    problem = joint_problem(Linearization(*declared_fit(replace(log, tau=tau))), 0, None)
    kept = motion.decimator.kept(len(motion.t))
    return problem, {name: x[kept] for name, x in loads.items()}


@pytest.fixture(scope="module")
def pieces(planted):
    problem, _ = planted
    return programs(problem.data, problem.units, problem.angles)


@pytest.fixture(scope="module")
def fitted(planted, pieces):
    """The true form, fitted from the middle of its constant's range."""
    problem, _ = planted
    piece = next(p for p in pieces if skeleton(p.program) == skeleton(TRUE))
    start = Sum((piece,), {p.name: float(p.decode(0.5)) for p in piece.constants})
    return polished(problem, start, problem.lin.crossfit.whole)


def test_the_true_form_comes_to_its_constants(planted, fitted):
    problem, _ = planted
    whole = problem.lin.crossfit.whole
    own = free_columns(problem, fitted, whole)
    assert fitted.values["k"] == pytest.approx(RATE, rel=0.02)
    assert linear(problem, fitted, whole, own)[0] == pytest.approx(FACTOR, rel=0.05)
    residual = whole.residual[:, 0]
    left = residual - said(problem, fitted, whole)
    assert left @ left < 0.02 * residual @ residual


def test_the_load_beside_it_is_that_of_the_true_arm(planted, fitted):
    problem, loads = planted
    seen = seen_beside(problem, fitted)
    for name, load in loads.items():
        assert np.std(seen.data[name] - load) < 0.05 * np.std(problem.data[name] - load)


def test_among_programs_by_the_load_the_true_one_is_the_best(planted, pieces):
    problem, _ = planted
    asked = [p for p in pieces if {"load", "static_load"} <= set(fields_of(p.program))]
    best = screen(problem, problem.lin.crossfit.whole, asked)[0]
    # The arm hangs to one side, so that the loads keep their signs.
    told = tuple(token for token in best.piece.program if token != "abs")
    assert skeleton(told) == skeleton(TRUE) and best.share > 0.99


def test_a_stand_in_that_reads_no_load_shows_the_load_too(planted, pieces):
    """Of a large law by the load a form without it may come near first, and free the arm of it."""
    problem, loads = planted
    hinge = next(p for p in pieces if p.program == ("q", "c", "-", "pos"))
    start = Sum((hinge,), {"c": float(hinge.constants[0].decode(0.5))})
    stand_in = polished(problem, start, problem.lin.crossfit.whole)
    seen = seen_beside(problem, stand_in)
    for name, load in loads.items():
        assert np.std(seen.data[name] - load) < 0.7 * np.std(problem.data[name] - load)
    again = joint_loads(seen)
    for name in loads:
        np.testing.assert_allclose(again[name], seen.data[name], atol=1e-6 * np.ptp(loads[name]))
    assert seen_beside(seen, stand_in) is None  # they are as they were


def joint_loads(problem):
    """The loads that laws are given in the model that a problem is seen with."""
    lin = problem.lin
    again = joint_problem(lin, problem.joint, problem.other)
    return {name: again.data[name] for name in ("load", "static_load")}


def test_without_a_region_the_load_is_that_of_the_model_fitted_without_it(planted, fitted):
    """It was that of the model fitted to all: a true law left 0.1 of the error of regions, not 0.0003."""
    problem, loads = planted
    whole = problem.lin.crossfit.whole
    fold = whole.trained_on(problem.data["q"] < np.median(problem.data["q"]))
    told = fitted_together(problem, fitted.programs, (), fitted.values, fold)
    for name, load in loads.items():
        assert np.std(told.loads[name] - load) < 0.1 * np.std(problem.data[name] - load)


@pytest.mark.parametrize(("part", "varies"), [(4e-9, False), (1e-2, True)])
def test_a_load_that_stands_still_but_for_digits_is_no_variable(part, varies):
    """A weight on a slide: of a drag by the square of the speed it made one times that weight."""
    lin = Linearization(*declared_fit(log_with()))
    (load,) = lin.loads
    still = -16.9 * (1.0 + part * np.sin(np.arange(len(load.static))))
    lin.loads = [load._replace(static=np.repeat(still[:, None], 2, axis=1))]
    assert ("static_load" in joint_problem(lin, 1, None).data) is varies
