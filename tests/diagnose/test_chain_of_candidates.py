"""A candidate's columns pass what the drives report, exactly as the fit will see them."""

import importlib
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest
from elbow import elbow_log, fitted
from planted import BAND, blank, declared_fit, log_with, small_arm

from jaxswarm.diagnose.candidates.backlash import _curves, _Point
from jaxswarm.diagnose.candidates.best_of import Task, best_of
from jaxswarm.diagnose.candidates.journal import fingerprint
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.search import _late, searching
from jaxswarm.diagnose.candidates.whole_model import body_candidate
from jaxswarm.diagnose.folds.fold_data import FoldData
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects import Law, Parameter, make_sample
from jaxswarm.effects.deflection import contact_stiffness
from jaxswarm.effects.lattice import lattice_of
from jaxswarm.effects.series import law_columns
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.forward.columns import term_columns
from jaxswarm.identify.forward.joint_series import joint_series
from jaxswarm.identify.forward.measuring_chain import assemble
from jaxswarm.identify.forward.model import linear_values
from jaxswarm.logs.motion import Filtering, prepare

LATE = Term("time_delay", values={"seconds": 0.02})
STRONG = Term("drive_gain", 1, values={"gain": 1.3})


@pytest.fixture(scope="module")
def lin():
    """A model that is 20 ms late with a drive that reports 1.3 times its torque."""
    found, _ = declared_fit(log_with())
    terms = (*found.model.terms, LATE, STRONG)
    found = replace(found, model=replace(found.model, terms=terms))
    return Linearization(found, cross_fit(found))


def fitted_columns(lin, term):
    """The same term's columns as the regression of the model with it has them."""
    model = lin.found.model
    parts = [
        assemble(model.robot, (*model.terms, term), m, model.width, lin.pi, r, decimate=True)
        for m, r in zip(lin.found.motions, lin.found.rigids, strict=True)
    ]
    size = len(term.columns(model.robot.joints))
    return lin.crossfit.weigh(np.concatenate(parts)[:, :, -size:])


@pytest.mark.parametrize(
    "term",
    [
        Term("coulomb_friction", 1),
        Term("joint_spring", 0),
        Term("stribeck_friction", 1, values={"vs": 0.2, "delta": 1.5}),
    ],
    ids=lambda t: t.effect,
)
def test_columns_of_a_law_are_those_of_the_fit_with_a_delay_and_a_gain(lin, term):
    np.testing.assert_allclose(lin.law(term), fitted_columns(lin, term), rtol=1e-9, atol=1e-9)


def test_a_payload_and_a_tilt_pass_the_drives_too(lin):
    model, found = lin.found.model, lin.found
    parts = [
        assemble(model.robot, model.terms, m, model.width, lin.pi, r, decimate=True)[:, :, 10:20]
        for m, r in zip(found.motions, found.rigids, strict=True)
    ]
    carried = body_candidate(lin, Term("payload")).columns[0]
    np.testing.assert_allclose(
        carried, lin.crossfit.weigh(np.concatenate(parts)), rtol=1e-9, atol=1e-9
    )
    step = 1e-4
    tilted = [
        [
            assemble(
                model.robot, (*model.terms, Term("base_tilt", values={"gx": g, "gy": 0.0})),
                m, model.width, lin.pi, r, decimate=True,
            ) @ linear_values(model)
            for g in (step, -step)
        ]
        for m, r in zip(found.motions, found.rigids, strict=True)
    ]  # fmt: skip
    slope = np.concatenate([(high - low) / (2 * step) for high, low in tilted])
    found_slope = body_candidate(lin, Term("base_tilt")).columns[0][:, :, 0]
    np.testing.assert_allclose(found_slope, slope * lin.crossfit.weight, rtol=1e-4, atol=1e-4)


def test_a_tilt_loads_no_masses_but_those_that_a_level_arm_does_not_feel():
    """What merges into another link's does so in any gravity: four columns of none were counted too."""
    found = fitted(elbow_log())
    columns = body_candidate(Linearization(found, cross_fit(found)), Term("base_tilt")).columns[0]
    aside = 2  # the first link's moments about its vertical axis
    assert columns.shape[2] == 2 + aside
    # They hold up the first joint alone.
    assert np.abs(columns[:, 1:, 2:]).max() < 1e-9 * np.abs(columns).max()


def fold_of(residual):
    length = len(residual)
    ones = jnp.ones((1, length))
    return FoldData(jnp.zeros((1, length, 1)), jnp.asarray(residual)[None], ones, ones)


def test_a_search_sees_a_late_torque_as_late(lin):
    """Its columns follow from late motion, which is as good as a late torque, but for the sampling."""
    term = Term("stribeck_friction", 1, values={"vs": 0.15, "delta": 2.0})
    motion, width = lin.found.motions[0], lin.found.model.width
    told = (lin.law(term) / lin.crossfit.weight[:, :, None])[:, 1, 0]

    def apart(delay):
        series = _late(joint_series(motion, width, lin.loads[0], 1), delay, motion)
        nonlinear = {p.name: term.values[p.name] for p in term.law.nonlinear}
        own = motion.decimator.apply(np.asarray(law_columns(term.law, nonlinear, series)))[:, 0]
        scale = own @ told / (own @ own)
        return np.linalg.norm(told - scale * own) / np.linalg.norm(told)

    assert apart(0.02) < 0.01 and apart(0.0) > 0.1


def test_a_point_without_a_finite_torque_hides_no_other(key):
    law = Law(
        "cliff", "joint",
        (
            Parameter("a", "N m", -1e3, 1e3, True, 1.0, "size"),
            Parameter("w", "1/rad", 1.0, 4.0, False, 2.0, "wave number"),
        ),
        "a sin(w q), not finite below w = 1.2", "made up",
        torque=lambda p, s: p["a"] * jnp.sin(p["w"] * s.q) * jnp.where(p["w"] < 1.2, jnp.nan, 1.0),
    )  # fmt: skip
    q = np.linspace(-3.0, 3.0, 600)
    series = make_sample(q=q)
    lattice, cell = lattice_of(1, 128, (480, 1))
    task = Task(np.int32(0), np.bool_(False), cell, series, fold_of(np.sin(3.0 * q)))
    points, gains = best_of((law,), 1, 12, task, lattice, 40, np.ones(1), key)
    assert 1.0 + 3.0 * float(points[0, 0]) == pytest.approx(3.0, abs=0.05)
    assert np.isfinite(gains).all()


def test_a_law_with_four_nonlinear_parameters_is_searched(lin, key):
    names = ("c1", "c2", "c3", "c4")
    law = Law(
        "wavy", "joint",
        (
            Parameter("a", "N m", -1e3, 1e3, True, 1.0, "size"),
            *(Parameter(n, "1/rad", -1.0, 1.0, False, 0.1, "slope") for n in names),
        ),
        "a tanh of a polynomial of q", "made up",
        torque=lambda p, s: p["a"] * jnp.tanh(sum(p[n] * s.q**k for k, n in enumerate(names, 1))),
    )  # fmt: skip
    motion = lin.found.motions[0]
    values = dict(zip(names, (0.5, -0.3, 0.2, 0.1), strict=True))
    series = joint_series(motion, (0.01,) * 3, lin.loads[0], 1)
    torque = np.asarray(law.torque({"a": 2.0, **values}, series))
    one = fold_of(motion.decimator.apply(torque))
    stages = FoldData(*(jnp.stack([x, x]) for x in one))
    with searching([(law, 1, None)], [motion], (0.01,) * 3, lin.loads, [stages], key) as finish:
        found = next(finish())[0]
    assert set(found) == set(names)
    said = np.asarray(law.torque({"a": 1.0, **found}, series))
    assert abs(np.corrcoef(said, torque)[0, 1]) > 0.95


def test_a_closed_gear_is_as_stiff_in_the_search_as_in_the_fit():
    """Two logs in which the link has another inertia: each has its own stiffness, as in the fit."""
    motions = [prepare(log_with(motion_seed=seed), BAND) for seed in (7, 8)]
    found = estimate(small_arm(), blank(), motions, bounded=False)
    lin = Linearization(found, cross_fit(found))
    own = lin.sensed(0)
    stiff = [contact_stiffness(s.inertia(lin.pi), 30.0)[0] for s in own]
    assert abs(stiff[0] / stiff[1] - 1.0) > 1e-3
    both = _curves(lin, Term("backlash", 0), [_Point(0.005, 0.0, 30.0)], lin.pi, 2)
    alone = estimate(small_arm(), blank(), motions[1:], bounded=False)
    single = Linearization(alone, cross_fit(alone))
    one = _curves(single, Term("backlash", 0), [_Point(0.005, 0.0, 30.0)], lin.pi, 2)
    np.testing.assert_allclose(both[:, -one.shape[1] :], one, rtol=1e-9, atol=1e-12)


def test_another_filter_or_another_channel_is_another_diagnosis():
    log = log_with()
    motion = prepare(log, Filtering(20.0, 10.0))
    own = fingerprint(small_arm(), [motion], 0)
    assert fingerprint(small_arm(), [prepare(log, Filtering(20.0, 10.0))], 0) == own
    other = prepare(log, Filtering(20.0, 9.0))
    heated = replace(motion, channels={**motion.channels, "temperature": 0.0 * motion.q})
    warmer = replace(motion, channels={**motion.channels, "temperature": 1.0 + 0.0 * motion.q})
    prints = {fingerprint(small_arm(), [m], 0) for m in (motion, other, heated, warmer)}
    assert len(prints) == 4


def test_what_laws_see_is_that_of_their_own_joints_whatever_was_asked_before(monkeypatch):
    module = importlib.import_module("jaxswarm.diagnose.candidates.linearization")
    monkeypatch.setattr(module, "_SERIES", 1)
    found, _ = declared_fit(log_with())
    lin = Linearization(found, cross_fit(found))
    motion, joints = found.motions[0], range(found.model.robot.num_joints)
    pairs = [Term("transmission_coupling", 0, 1), Term("transmission_coupling", 1, 0)]
    for term in [
        *(Term("load_dependent_friction", j, values={"inertial": 0.5}) for j in joints),
        *pairs,
    ]:
        seen = term_columns(term, motion, found.model.width, lin.loads[0])
        expected = lin.on_joint(motion.decimator.apply(seen), term.joint)
        np.testing.assert_allclose(lin.law(term), expected, rtol=1e-12, atol=1e-14)
        assert len(lin.series) == 1
