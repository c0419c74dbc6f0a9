"""The motion that separates two rivals: it does so more than the log did."""

from dataclasses import replace

import numpy as np
import pytest
from planted import declared_fit, diagnose_log, log_with

from jaxswarm.diagnose.report.experiment import best_experiment
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.model import model_torque


def with_term(model, term):
    return replace(model, terms=(*model.terms, term))


RIVALS = [
    (
        Term("stribeck_friction", 1, values={"df": 0.4, "vs": 0.05, "delta": 2.0}),
        Term("hysteresis", 1, values={"fc": 0.1, "x0": 0.01}),
    ),
    (
        Term("quadratic_drag", 0, values={"c": 0.1}),
        Term("nonlinear_viscous_friction", 0, values={"c": 0.1, "alpha": 2.5}),
    ),
]


@pytest.mark.parametrize(("one", "other"), RIVALS)
def test_chosen_motion_separates_more_than_the_log(one, other):
    found, _ = declared_fit(log_with())
    motion = found.motions[0]
    models = [with_term(found.model, t) for t in (one, other)]
    trial = best_experiment(*models, motion, one.joint)
    apart = model_torque(models[0], motion) - model_torque(models[1], motion)
    on_log = (np.std(apart, axis=0) / motion.torque_noise).max()
    assert trial.ratio > on_log
    assert trial.joint == one.joint
    assert f"joint{one.joint + 1}" in trial.text


def test_a_difference_is_told_against_the_noise_of_the_band():
    """Of a drive that jitters near half the rate differences tell more: a motion that tells was said not to."""
    found, _ = declared_fit(log_with())
    motion = found.motions[0]
    models = [with_term(found.model, t) for t in RIVALS[1]]
    quiet = replace(motion, bounded_noise=0.1 * motion.torque_noise)
    ratio = [best_experiment(*models, m, 0).ratio for m in (motion, quiet)]
    assert ratio[1] > 5.0 * ratio[0]


def test_equal_models_cannot_be_told_apart():
    found, _ = declared_fit(log_with())
    trial = best_experiment(found.model, found.model, found.motions[0], None)
    assert trial.ratio == pytest.approx(0.0, abs=1e-12)
    assert trial.words(["joint1", "joint2"]).startswith("no motion does, they say the same of all")


def test_a_gain_of_one_of_two_drives_is_told_as_that_of_either():
    """Masses are free, so the other drive may be wrong the other way around: the elbow's was never told."""
    (step,) = diagnose_log(log_with(Term("drive_gain", 1, values={"gain": 1.3}))).steps
    told = {step.added.identity, *(r.candidate.term.identity for r in step.rivals)}
    assert told == {Term("drive_gain", j).identity for j in (0, 1)}
    gain = step.added.values["gain"]
    assert gain == pytest.approx(1.3 if step.added.joint == 1 else 1.0 / 1.3, rel=0.02)
