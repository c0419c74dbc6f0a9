"""Which joints are searched for formulas, what is searched again, and on what a formula is judged."""

import importlib
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from planted import declared_fit, log_with

from benchmarks.mechanisms import MECHANISMS
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.remainder import Remainder
from jaxswarm.diagnose.discovery.candidates import _families
from jaxswarm.diagnose.discovery.front import point, region_folds, strict
from jaxswarm.diagnose.discovery.joint_search import NoFormula
from jaxswarm.diagnose.discovery.open_joints import Open
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import joint_problem
from jaxswarm.diagnose.discovery.sums import Sum
from jaxswarm.diagnose.folds.other_motion import regions
from jaxswarm.effects.parameter import Parameter

open_joints = importlib.import_module("jaxswarm.diagnose.discovery.open_joints")
discovery = importlib.import_module("jaxswarm.diagnose.discovery.discover")


@cache
def problem():
    found, crossfit = declared_fit(log_with())
    return joint_problem(Linearization(found, crossfit), 1, 0)


def folds_with(torque):
    """The regions of the log, where this is all that the model lacks on joint 2."""
    joint = problem()
    whole = joint.lin.crossfit.whole
    residual = whole.free_part(joint.lin.on_joint(torque[:, None], 1))[:, :, 0]
    return region_folds(replace(whole, residual=residual), regions(joint.lin.found))


def test_powers_that_hide_each_other_are_found_together():
    dq = problem().data["dq"]
    folds = folds_with(dq**3 - dq**5 / np.abs(dq).max() ** 2)
    exact = [one for one in _families(problem(), folds) if one.error < 1e-6]
    best = min(exact, key=lambda one: one.bits)
    assert best.formula.programs == (("dq", "cube"), ("dq", "square", "dq", "cube", "*"))
    assert best.symmetry.parity == "odd"


def test_a_linkage_is_found_as_waves_of_a_turn():
    q = problem().data["q"]
    values = dict(q0=-0.8, crank=0.32, rocker=0.62, coupler=1.02, x=0.73, y=-1.2, free=0.3)
    torque = MECHANISMS["four-bar balancer"].torque(values, q, 0.0, q, 0.0)
    folds = folds_with(torque)
    waves = [one for one in _families(problem(), folds) if len(one.formula.pieces) == 6]
    assert len(waves) == 1 and waves[0].symmetry.text.startswith("a function of the position alone")
    others = [one.error for one in _families(problem(), folds) if len(one.formula.pieces) < 4]
    assert waves[0].error < 1e-3 and 10.0 * waves[0].error < min(others), (waves[0].error, others)


def test_what_slides_has_no_waves(monkeypatch):
    folds = folds_with(problem().data["q"] ** 2)
    monkeypatch.setattr(type(problem()), "angles", False)
    assert all(len(one.formula.pieces) < 4 for one in _families(problem(), folds))


WAVE = Sum(
    (
        Piece(
            ("q", "k", "*", "p", "+", "sin"),
            (
                Parameter("k", "1/rad", 1.0, 30.0, False, 4.0, "order"),
                Parameter("p", "1", -np.pi, np.pi, False, 0.0, "phase"),
            ),
        ),
    ),
    {"k": 5.0, "p": 0.4},
)


def test_a_law_is_learned_without_the_region_it_is_judged_on():
    folds = folds_with(np.sin(5.0 * problem().data["q"] + 0.4))
    near = WAVE._replace(values={"k": 5.2, "p": 0.3})
    told = point(problem(), near, folds)
    assert strict(problem(), told, folds).error < 1e-3 < told.error


def test_what_fits_by_chance_is_worse_where_it_was_not_learned():
    noise = np.random.default_rng(3).normal(size=len(problem().rows))
    folds = folds_with(noise)
    assert strict(problem(), point(problem(), WAVE, folds), folds).error > 0.99


def by_hand(monkeypatch, over_noise, outcome):
    """A search of joints of which laws were added to the last two, and the joints that were asked."""
    asked = []

    def instead(diagnosis, left, other, seed):
        asked.append(left)
        return diagnosis, outcome(left.joint)

    left = [Remainder(j, x, (), (0.0, 0.0)) for j, x in enumerate(over_noise)]
    kept = [SimpleNamespace(added=SimpleNamespace(joint=j)) for j in (1, 2)]
    model = SimpleNamespace(robot=SimpleNamespace(joints=("a", "b", "c")), terms=())
    diagnosis = SimpleNamespace(kept=kept, final=SimpleNamespace(model=model))
    monkeypatch.setattr(discovery, "unlawful", lambda diagnosis, seed: [])
    monkeypatch.setattr(discovery, "remainders", lambda final: left)
    monkeypatch.setattr(discovery, "_discover_instead", instead)
    return diagnosis, asked


def test_laws_that_leave_more_than_noise_are_doubted_and_not_told_as_searched_in_vain(monkeypatch):
    diagnosis, asked = by_hand(
        monkeypatch, (1.6, 1.6, 1.1), lambda joint: NoFormula(joint, 9, None, "none")
    )
    _, search = discovery.discover(diagnosis)
    assert asked == [Open(1, (), 0.0, named=True)]
    assert search == ((), ())


def test_two_laws_on_one_joint_are_doubted_where_they_leave_noise(monkeypatch):
    diagnosis, asked = by_hand(
        monkeypatch, (1.0, 1.0, 1.0), lambda joint: NoFormula(joint, 9, None, "none")
    )
    diagnosis.kept = [*diagnosis.kept, diagnosis.kept[-1]]
    discovery.discover(diagnosis)
    assert asked == [Open(2, (), 0.0, named=True)]


@pytest.mark.parametrize(
    ("laws", "terms", "constants", "worse", "right"),
    [
        (2, 1, 2, False, True),
        (2, 1, 2, True, False),
        (1, 1, 2, False, False),
        (2, 2, 2, False, False),
        (2, 1, 6, False, False),
    ],
)
def test_one_term_takes_the_place_of_several_laws(
    monkeypatch, laws, terms, constants, worse, right
):
    law = SimpleNamespace(parameters=(0,) * 3)
    kept = [SimpleNamespace(added=SimpleNamespace(joint=1, law=law), removed=())] * laws
    formula = SimpleNamespace(parameters=(0,) * constants, terms=(0,) * terms)
    added = SimpleNamespace(index=1, found_formula=formula)
    monkeypatch.setattr(discovery, "clearly_better", lambda *args: worse)
    diagnosis = SimpleNamespace(kept=kept, final=None)
    found = SimpleNamespace(added=added, after=None)
    assert discovery._one_for_several(diagnosis, found, ()) is right


def test_a_push_is_doubted_on_the_joint_where_it_shows(monkeypatch):
    diagnosis, asked = by_hand(
        monkeypatch, (1.6, 1.6, 1.6), lambda joint: NoFormula(joint, 9, None, "none")
    )
    push = SimpleNamespace(added=SimpleNamespace(joint=None), score=SimpleNamespace(joint=0))
    diagnosis.kept = [push]
    discovery.discover(diagnosis)
    assert [one.joint for one in asked] == [0]


@pytest.mark.parametrize(
    ("better", "order"), [((), ["b"]), (("b",), ["b", "c"]), (("b", "c"), ["b", "c"])]
)
def test_a_formula_is_searched_again_beside_those_found_after_it(monkeypatch, better, order):
    def law(joint):
        return SimpleNamespace(added=SimpleNamespace(joint=joint, index=joint))

    diagnosis, _ = by_hand(monkeypatch, (0.9, 1.6, 1.6), law)
    again = []

    def searched_again(diagnosis, found, earlier, other, seed):
        name = "abc"[earlier.added.joint]
        again.append(name)
        if name in better:
            found = [*(one for one in found if one is not earlier), law(earlier.added.joint)]
        return diagnosis, found

    monkeypatch.setattr(discovery, "_searched_again", searched_again)
    monkeypatch.setattr(
        discovery, "without_stand_ins", lambda diagnosis, one, seed: (diagnosis, one)
    )
    monkeypatch.setattr(discovery, "fitted_rivals", lambda one: ())
    monkeypatch.setattr(discovery, "replace", lambda one, **changes: one)
    _, search = discovery.discover(diagnosis)
    assert again == order
    assert sorted(one.added.joint for one in search.found) == [1, 2]


@pytest.mark.parametrize(
    ("over_noise", "share", "law", "asked"),
    [
        (1.7, 0.28, False, [Open(1, ("dq",), 0.28)]),
        (1.1, 0.28, False, []),
        (1.1, 0.37, True, [Open(1, ("dq",), 0.37, named=True)]),
        (0.9, 0.37, True, []),
        (1.7, 0.9, True, [Open(1, ("dq",), 0.9)]),
    ],
)
def test_structure_near_the_noise_is_searched(monkeypatch, over_noise, share, law, asked):
    """A law near standstill showed 1.7 times the noise on one log, and 3.5 times on another."""

    def structure(final, crossfit, seed, joints):
        return [SimpleNamespace(joint=j, depends_on=("dq",), share=share) for j in joints]

    left = [Remainder(j, x, (), (0.0, 0.0)) for j, x in enumerate((0.9, over_noise, 0.9))]
    kept = [SimpleNamespace(added=SimpleNamespace(joint=1))] if law else []
    monkeypatch.setattr(open_joints, "find_unexplained", structure)
    monkeypatch.setattr(open_joints, "remainders", lambda final: left)
    assert open_joints.unlawful(SimpleNamespace(final=None, crossfit=None, kept=kept), 0) == asked


def test_a_log_too_short_for_regions_is_searched_by_blocks_if_other_logs_prove_it(monkeypatch):
    """Sixty rows have no regions, and were not searched although a log of other motion was given."""
    proof = importlib.import_module("jaxswarm.diagnose.discovery.proof")
    search = importlib.import_module("jaxswarm.diagnose.discovery.joint_search")
    lin, asked = problem().lin, []
    monkeypatch.setattr(proof, "regions", lambda found: None)

    def noted(problem, pieces, label, seed, terms):
        asked.append(label)
        return problem, [], 0

    monkeypatch.setattr(search, "candidates", noted)
    diagnosis = SimpleNamespace(final=lin.found, crossfit=lin.crossfit)
    alone = search.search_joint(diagnosis, Open(1, (), 0.0), (), 0)
    assert not asked and "--validation" in alone.because
    search.search_joint(diagnosis, Open(1, (), 0.0), lin.found.motions, 0)
    assert asked and (asked[0] == lin.crossfit.block).all()
