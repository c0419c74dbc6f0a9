"""What is stored between two joints: its forms, and what it does on one joint while the other is searched."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.discovery import joint_search
from jaxswarm.diagnose.discovery.cables import cables, forms
from jaxswarm.diagnose.discovery.front import region_folds
from jaxswarm.diagnose.discovery.joint_search import search_joint
from jaxswarm.diagnose.discovery.open_joints import Open
from jaxswarm.diagnose.discovery.partner import without_joint
from jaxswarm.diagnose.discovery.problem import joint_problem
from jaxswarm.diagnose.folds.other_motion import regions
from jaxswarm.effects.postfix import check_program, evaluate

VALUES = {"e": 0.7, "c": -0.5, "d": 0.4, "g": 2.0 / 1.1}
STEP = 1e-6


def energy(first, second, way):
    """Half the square of what the cable is stretched by."""
    turned = first + way * second
    x = np.cos(first) + VALUES["e"] * np.cos(turned) - VALUES["c"]
    y = np.sin(first) + VALUES["e"] * np.sin(turned) - VALUES["d"]
    return 0.5 * np.maximum(np.hypot(x, y) - 1.1, 0.0) ** 2


@pytest.mark.parametrize("form", forms())
def test_a_cable_pulls_by_the_slope_of_its_energy(form):
    q, other = np.random.default_rng(0).uniform(-2.0, 2.0, (2, 60))

    def stored(q, other):
        return energy(q, other, form.way) if form.first else energy(other, q, form.way)

    slopes = [
        (stored(q + STEP, other) - stored(q - STEP, other)) / (2.0 * STEP),
        (stored(q, other + STEP) - stored(q, other - STEP)) / (2.0 * STEP),
    ]
    known = {**VALUES, "q": q, "q_other": other}
    for program, size, slope in zip(
        (form.own, form.partners), form.sizes(VALUES["e"]), slopes, strict=True
    ):
        check_program(program, list(VALUES))
        told = size * evaluate(program, known, np) / VALUES["g"]
        np.testing.assert_allclose(told, slope, atol=1e-7)
        assert (told == 0.0).any() and (told != 0.0).any(), "slack somewhere, taut elsewhere"


@cache
def sprung():
    """The arm with a hardening belt between its joints, and the belt's torque on each of them."""
    log = log_with()
    stretch = log.q[:, 0] - 0.8 * log.q[:, 1]
    pull = 60.0 * stretch**3
    return replace(log, tau=log.tau + np.stack([pull, -0.8 * pull], axis=1))


def left_of_it(lin):
    """Share of joint 2's residual that the belt's own form leaves."""
    problem = joint_problem(lin, 1, 0)
    stretch = problem.data["q_other"] - 0.8 * problem.data["q"]
    fold = lin.crossfit.whole
    column = fold.free_rows(lin.on_joint(stretch[:, None] ** 3, 1)[:, 1], 1)[:, 0]
    own = fold.residual[:, 1]
    return 1.0 - (column @ own) ** 2 / (column @ column) / (own @ own)


def test_what_the_partner_lacks_is_not_seen_on_the_joint():
    found, crossfit = declared_fit(sprung())
    bent = left_of_it(Linearization(found, crossfit))
    straight = left_of_it(Linearization(found, without_joint(crossfit, 0)))
    assert straight < 0.02 < 0.2 * bent


def test_a_joint_is_searched_without_the_rows_of_a_partner_that_is_far_from_its_noise(monkeypatch):
    found, crossfit = declared_fit(sprung())
    asked = []

    def none(problem, pieces, label, seed, terms):
        asked.append(problem.lin.crossfit.weight.any(axis=0).tolist())
        return problem, [], 0

    monkeypatch.setattr(joint_search, "candidates", none)
    diagnosis = type("Diagnosis", (), {"final": found, "crossfit": crossfit})()
    search_joint(diagnosis, Open(1, ("q_joint1", "q_joint2"), 0.9), (), 0)
    search_joint(diagnosis, Open(1, ("q_joint2",), 0.9), (), 0)
    # The second search finds nothing by the joint alone, and asks its neighbor.
    assert asked == [[False, True], [True, True], [False, True]]


def test_a_cable_over_two_joints_is_found():
    log = log_with()
    first, second = forms()[0].own, forms()[0].partners
    known = {**VALUES, "q": log.q[:, 0], "q_other": log.q[:, 1]}
    pull = [40.0 * evaluate(first, known, np), 40.0 * VALUES["e"] * evaluate(second, known, np)]
    found, crossfit = declared_fit(replace(log, tau=log.tau + np.stack(pull, axis=1)))
    lin = Linearization(found, without_joint(crossfit, 0))
    problem = replace(joint_problem(lin, 1, 0), both=crossfit)
    points, _ = cables(problem, region_folds(lin.crossfit.whole, regions(found)))
    assert points[0].formula.programs == (forms()[1].own,)
    assert points[0].error < 0.02
