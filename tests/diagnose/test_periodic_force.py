"""A force with a frequency of its own is named with it, and no motion is taken for one."""

from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import jax
import numpy as np
import pytest
from elbow import ask, elbow, elbow_log, fitted, passing
from planted import BAND

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.tone import _alone, tonal_candidate
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.forward.model import model_torque
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import inverse_dynamics

DOUBLES = ("torque_ripple", "contact", "friction_change", "encoder_eccentricity", "thermal_drift")
HERTZ, SIZE = 2.37, 1.2


def shaken(log, hertz=HERTZ, joint=1, force=SIZE, phase=0.7):
    tau = log.tau.copy()
    tau[:, joint] += force * np.sin(2 * np.pi * hertz * log.t + phase)
    return replace(log, tau=tau)


def test_a_force_of_its_own_frequency_is_named_with_it():
    found = fitted(shaken(elbow_log()))
    best = passing(ask(found, "periodic_force", *DOUBLES))[0]
    assert best.candidate.term.place == ("periodic_force", 1, None)
    after = refit_with(found, best)
    values = find_term(after, best.candidate.term).values
    assert values["hertz"] == pytest.approx(HERTZ, abs=0.003)
    assert np.hypot(values["sine"], values["cosine"]) == pytest.approx(SIZE, rel=0.05)
    assert after.fit.sigma[1] < 0.5 * found.fit.sigma[1]


@pytest.mark.parametrize(("size", "force", "least"), [(0.006, SIZE, 0.05), (0.01, 3.0, 0.15)])
def test_a_force_that_shakes_the_arm_is_named_though_the_motion_has_its_line(size, force, least):
    """A model without the force bends to take up what it can of it, and so leaves a fourth off its line."""
    log = elbow_log()
    swing = 2 * np.pi * HERTZ
    along = [size * np.sin(swing * log.t + 0.3), size * swing * np.cos(swing * log.t + 0.3)]
    along.append(-(swing**2) * along[0])
    motion = prepare(log, BAND)
    parts = [np.array(x) for x in (motion.q, motion.dq, motion.ddq)]
    torque = jax.vmap(partial(inverse_dynamics, elbow()))
    still = torque(*parts)
    for part, more in zip(parts, along, strict=True):
        part[:, 1] += more
    tau = log.tau + np.asarray(torque(*parts) - still)
    tau[:, 1] += 2.0 * along[1]
    q = log.q + np.outer(along[0], [0.0, 1.0, 0.0])
    found = fitted(shaken(replace(log, q=q, tau=tau), force=force))
    line = 2.0 * np.abs(np.exp(-1j * swing * log.t) @ parts[2][:, 1]) ** 2 / len(log.t)
    assert line > least * (parts[2][:, 1] ** 2).sum()
    best = passing(ask(found, "periodic_force", *DOUBLES))[0]
    assert best.candidate.term.place == ("periodic_force", 1, None)


@pytest.mark.parametrize("part", [0.0, 0.25, 0.5])
def test_its_frequency_is_told_between_the_lines_of_the_spectrum(part):
    """A frequency a sixteenth of a line off left what seemed to be the rest of a law of the motion."""
    log = elbow_log()
    hertz = HERTZ + part / (8.0 * (log.t[-1] - log.t[0]))
    found = fitted(shaken(log, hertz))
    told = tonal_candidate(Linearization(found, cross_fit(found)), Term("periodic_force", 1))
    assert told.term.values["hertz"] == pytest.approx(hertz, abs=3e-4)


@pytest.mark.parametrize(
    ("turn", "share", "told"),
    [
        (0.1, 0.999, True),
        (0.1, 0.9, False),
        (0.2, 0.6, True),
        (0.01, 0.999, False),
        (0.0, 0.9999, False),
    ],
)
def test_a_tone_nearly_in_step_is_one_where_what_does_not_repeat_is_far_more_than_it_leaves(
    turn, share, told
):
    """A force of 46 times the noise, 0.14 of a turn ahead when the motion repeated itself, had no name."""
    t, period = np.arange(0.0, 20.0, 0.004), 5.0
    base = 2.0 * np.pi / period
    # Fast enough that a function of the motion may have any line.
    q = np.stack([np.sin(base * t) + 0.2 * np.sin(9 * base * t), np.cos(2 * base * t)], axis=1)
    dq = np.gradient(q, t, axis=0)
    motion = SimpleNamespace(t=t, q=q, dq=dq, ddq=np.gradient(dq, t, axis=0), rate=250.0)
    assert _alone(motion, (18.0 + turn) / period, share) == told


def test_it_is_of_its_own_log_alone():
    logs = [shaken(elbow_log()), elbow_log(seed=2)]
    declared = parse_terms("viscous_friction,coulomb_friction", elbow().joints)
    motions = [prepare(x, BAND) for x in logs]
    found = estimate(elbow(), declared, motions, bounded=False)
    best = passing(ask(found, "periodic_force"))[0]
    after = refit_with(found, best)
    term = find_term(after, best.candidate.term)
    assert (term.values["log"], term.acts_in(0), term.acts_in(1)) == (0.0, True, False)
    both = [model_torque(after.model.during(k), motions[1]) for k in (1, None)]
    np.testing.assert_array_equal(*both)
    assert (after.fit.sigma < 0.7 * found.fit.sigma)[1]


def test_each_log_has_its_own_force():
    """Of three it took a third off the squares, and none was told; nor was any asked beside the first one."""
    logs = [
        shaken(elbow_log(seed=seed), phase=phase) for phase, seed in ((0.7, 1), (2.9, 2), (4.6, 3))
    ]
    declared = parse_terms("viscous_friction,coulomb_friction", elbow().joints)
    found = estimate(elbow(), declared, [prepare(x, BAND) for x in logs], bounded=False)
    first = found.fit.sigma
    for _ in logs:
        best = passing(ask(found, "periodic_force"))[0]
        found = refit_with(found, best)
    forces = [t for t in found.model.terms if t.effect == "periodic_force"]
    assert sorted(t.values["log"] for t in forces) == [0.0, 1.0, 2.0]
    for term in forces:
        assert term.values["hertz"] == pytest.approx(HERTZ, abs=0.003)
        assert np.hypot(term.values["sine"], term.values["cosine"]) == pytest.approx(SIZE, rel=0.05)
    assert found.fit.sigma[1] < 0.5 * first[1]
    names = [name for t in forces for name in t.columns(elbow().joints)]
    assert len(set(names)) == len(names)
    left = [t.place for t in eligible_terms(found.model, tuple(found.motions))]
    assert ("periodic_force", 1, None) not in left and ("periodic_force", 0, None) in left


@pytest.mark.parametrize(
    "truth",
    [
        None,
        Term("joint_spring", 1, values={"k": 12.0, "tau0": 1.0}),
        Term("quadratic_drag", 0, values={"c": 2.0}),
        Term("torque_ripple", 2, values={"sine": 1.0, "cosine": 0.0, "n": 8.0}),
        Term("cubic_spring", 0, values={"k3": 9.0, "q0": 0.1}),
    ],
    ids=lambda t: t.effect if t else "clean",
)
def test_what_goes_with_the_motion_is_no_force_of_its_own(truth):
    found = fitted(elbow_log(*([truth] if truth else [])))
    assert not passing(ask(found, "periodic_force"))


def test_a_motion_that_repeats_itself_hides_a_multiple_of_its_frequency():
    log = elbow_log()
    t, base = log.t, 2 * np.pi * 0.5
    q = np.column_stack([np.sin(base * t), np.cos(base * t), np.sin(base * t + 1.0)])
    noise = 0.1 * np.random.default_rng(0).normal(size=q.shape)

    def asked(hertz):
        found = fitted(shaken(replace(log, q=q + 1e-6 * log.q, tau=noise), hertz))
        stand = Linearization(found, cross_fit(found))
        return tonal_candidate(stand, Term("periodic_force", 1))

    assert asked(1.0) is None
    assert asked(1.005) is None
    # A twentieth of a turn each time, which is far more than noise leaves.
    assert asked(1.03).term.values["hertz"] == pytest.approx(1.03, abs=0.003)
    # Nothing of a motion of 0.5 Hz has a line beyond its cubes alone.
    assert asked(2.0).term.values["hertz"] == pytest.approx(2.0, abs=0.01)
    assert asked(HERTZ).term.values["hertz"] == pytest.approx(HERTZ, abs=0.01)
