"""Shapes of mechanisms are among the programs, and what explodes behind its range is not proposed."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.discovery import on_device, on_host
from jaxswarm.diagnose.discovery.grammar import MOST_CONSTANTS, programs
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import joint_problem
from jaxswarm.diagnose.discovery.reach import tame
from jaxswarm.diagnose.discovery.screening import screen
from jaxswarm.diagnose.discovery.sums import Sum
from jaxswarm.effects.postfix import evaluate, fields_of

# Of unit size: a buffer from one side, a spring with play, a magnet whose tails are powers, an eddy-current
# brake, a shoe that engages beyond a speed, belts to the partner, a rubber ball, a spring between two points, a
# cable between them that hangs slack, dipoles and poles of the inverse square that pass on a lever, a cam
# that lifts from one side, and a tendon that stiffens to either side.
MECHANISMS = {
    "buffer": lambda q, dq, other: np.maximum(q - 0.1, 0.0) ** 2,
    "play": lambda q, dq, other: q - 0.1 - np.clip(q - 0.1, -0.15, 0.15),
    "magnet": lambda q, dq, other: (q - 0.1) / ((q - 0.1) ** 2 + 0.02) ** 2.5,
    "brake over a span": lambda q, dq, other: (
        dq / (1.0 + (dq / 0.4) ** 2) * (1.0 - np.tanh((np.abs(q - 0.1) - 0.2) / 0.02))
    ),
    "eddy brake": lambda q, dq, other: dq / (1.0 + (dq / 0.4) ** 2),
    "shoe": lambda q, dq, other: np.maximum(np.abs(dq) - 0.6, 0.0) * np.sign(dq),
    "belt": lambda q, dq, other: (q - 0.6 * other) ** 3,
    "belt that stiffens": lambda q, dq, other: (
        (q - 0.6 * other) * (1.0 + ((q - 0.6 * other) / 0.4) ** 2)
    ),
    "rubber buffer": lambda q, dq, other: np.maximum(0.1 - q, 0.0) ** 1.5,
    "slack cable": lambda q, dq, other: (
        np.maximum(1.0 - 0.9 / np.sqrt(1.3 - np.cos(q + 0.7)), 0.0) * np.sin(q + 0.7)
    ),
    "dipoles on a lever": lambda q, dq, other: (
        np.sin(2 * q - 0.1) / (1.08 - np.cos(2 * q - 0.1)) ** 2.5
    ),
    "poles on a lever": lambda q, dq, other: np.sin(q - 0.1) / (1.05 - np.cos(q - 0.1)) ** 1.5,
    "cam": lambda q, dq, other: np.maximum(np.sin(other - 0.1), 0.0),
    "tendon": lambda q, dq, other: np.sinh((q - 0.1) / 0.25),
    "spring on a lever": lambda q, dq, other: np.sin(q + 0.7) / np.sqrt(1.3 - np.cos(q + 0.7)),
}
EXPLODING = {
    "power times exponential": ("q", "cube", "q", "k", "*", "exp", "*"),
    "powers of all": ("q", "cube", "dq", "cube", "*"),
}
CALM = {
    "cubic spring": ("q", "cube"),
    "fifth power of the speed": ("dq", "square", "dq", "cube", "*"),
    "exponential": ("q", "k", "*", "exp"),
}


@cache
def problem():
    found, crossfit = declared_fit(log_with())
    return joint_problem(Linearization(found, crossfit), 1, 0)


@cache
def simple():
    """Programs of one variable, or of two positions in a ratio."""
    joint = problem()
    pieces = programs(joint.data, joint.units, joint.angles)
    return [
        one
        for one in pieces
        if len(fields_of(one.program)) == 1 or any(p.name == "r" for p in one.constants)
    ]


@cache
def over_a_span():
    """Programs of a joint's own position and velocity."""
    joint = problem()
    pieces = programs(joint.data, joint.units, joint.angles)
    return [one for one in pieces if set(fields_of(one.program)) == {"q", "dq"}]


@pytest.mark.parametrize("name", MECHANISMS)
def test_a_program_says_what_a_mechanism_does(name):
    joint = problem()
    truth = MECHANISMS[name](joint.data["q"], joint.data["dq"], joint.data["q_other"])
    fold = joint.lin.crossfit.whole
    hidden = fold.free_part(joint.lin.on_joint(truth[:, None], 1))[:, :, 0]
    asked = over_a_span() if name == "brake over a span" else simple()
    best = screen(joint, replace(fold, residual=hidden), asked)[0]
    assert best.share > 0.995, best.piece.program


def test_a_tendon_goes_on_behind_the_range_as_it_began():
    joint = problem()
    fold = joint.lin.crossfit.whole
    truth = MECHANISMS["tendon"]
    torque = truth(joint.data["q"], 0.0, 0.0)
    hidden = fold.free_part(joint.lin.on_joint(torque[:, None], 1))[:, :, 0]
    best = screen(joint, replace(fold, residual=hidden), simple())[0]
    ends = np.quantile(joint.data["q"], (0.01, 0.99))
    beyond = ends + np.array([-0.3, 0.3])
    said = [
        evaluate(best.piece.program, {"q": q, "q_other": 0.0, **best.values}, np)
        for q in (ends, beyond)
    ]
    assert said[1] / said[0] == pytest.approx(truth(beyond, 0, 0) / truth(ends, 0, 0), rel=0.05)


@pytest.mark.parametrize("name", [*EXPLODING, *CALM])
def test_what_explodes_behind_its_range_is_no_law(name):
    joint = problem()
    program = {**EXPLODING, **CALM}[name]
    rate = 5.0 / np.ptp(joint.data["q"])
    formula = Sum((Piece(program),), {"k": rate} if "k" in program else {})
    assert np.isfinite(evaluate(program, {**joint.data, **formula.values}, np)).all()
    assert tame(joint, formula) is (name in CALM)


def test_programs_score_the_same_on_the_processor_as_in_lanes():
    joint = problem()
    pieces = programs(joint.data, joint.units, joint.angles)[::60]
    rows = joint.rows_of(joint.lin.crossfit.whole)
    draws = np.random.default_rng(0).uniform(0.2, 0.8, (4, MOST_CONSTANTS)).astype(np.float32)
    lattices = dict.fromkeys(range(MOST_CONSTANTS + 1), draws)
    told = [e.survey(joint.names, rows, pieces, lattices) for e in (on_host, on_device)]
    assert {len(one.constants) for one in pieces} == {0, 1, 2, 3}
    (places, shares), (others, same) = told
    np.testing.assert_allclose(shares, same, rtol=0.02, atol=1e-4)
    np.testing.assert_array_equal(places[shares > 0.01], others[shares > 0.01])
