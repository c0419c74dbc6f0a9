"""The motion that separates two rivals: it does so more than the log did."""

from dataclasses import replace

import numpy as np
import pytest
from planted import declared_fit, log_with

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


def test_equal_models_cannot_be_told_apart():
    found, _ = declared_fit(log_with())
    trial = best_experiment(found.model, found.model, found.motions[0], None)
    assert trial.ratio == pytest.approx(0.0, abs=1e-12)
