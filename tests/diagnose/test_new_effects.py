"""One new effect of every kind, each one registration, goes through every command's machinery."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest
from matplotlib.figure import Figure
from planted import BAND, DECLARED, blank, declared_fit, log_with, small_arm

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.worth import passes
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.report.figures import evidence
from jaxswarm.diagnose.report.result import to_result
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.outcome import outcome_of
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import Step, find_term
from jaxswarm.effects import (
    REGISTRY,
    BodyChange,
    ExternalTorque,
    MeasurementLaw,
    Parameter,
    TorqueLaw,
    TransmissionLaw,
    register,
)
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.forward.model import Model, load_model, model_torque, save_model
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.simulate import Acting, make_plant
from jaxswarm.testing import check_effect

NOVEL = {"summary": "new", "reference": "none"}
TOYS = {
    "sine_torque": (
        TorqueLaw(
            "sine_torque",
            "joint",
            (
                Parameter("a", "N m", 0.0, 100.0, True, 1.0, "amplitude"),
                Parameter("n", "1", 2.0, 9.0, False, 4.0, "periods per turn"),
            ),
            **NOVEL,
            torque=lambda p, s: p["a"] * jnp.sin(p["n"] * s.q),
        ),
        Term("sine_torque", 1, values={"a": 2.0, "n": 5.0}),
    ),
    "soft_belt": (
        TransmissionLaw(
            "soft_belt",
            "joint",
            (Parameter("k", "N m/rad", 10.0, 1e5, False, 500.0, "stiffness", "log"),),
            **NOVEL,
            spring=lambda p: (p["k"], 0.02 * p["k"]),
            lattice=lambda inertia: [{"k": k} for k in np.geomspace(20.0, 2e4, 25)],
        ),
        Term("soft_belt", 1, values={"k": 60.0}),
    ),
    "sideways_gravity": (
        BodyChange(
            "sideways_gravity",
            "global",
            (Parameter("g", "m/s^2", -5.0, 5.0, False, 0.0, "gravity along base y"),),
            **NOVEL,
            gravity=lambda p, gravity: gravity + p["g"] * jnp.array([0.0, 1.0, 0.0]),
        ),
        Term("sideways_gravity", values={"g": 3.0}),
    ),
    "swelling_push": (
        ExternalTorque(
            "swelling_push",
            "global",
            (
                Parameter("start", "s", 0.0, 1e6, False, 0.0, "begin"),
                Parameter("end", "s", 0.0, 1e6, False, 1.0, "end"),
                Parameter("log", "1", 0.0, 1e6, False, 0.0, "number of its log", fitted=False),
            ),
            **NOVEL,
            profile=lambda phase: np.sin(np.pi * phase),
        ),
        Term(
            "swelling_push",
            values={"start": 4.0, "end": 4.6, "log": 0.0, "tau_joint1": 12.0, "tau_joint2": 6.0},
        ),
    ),
    "crosstalk": (
        MeasurementLaw(
            "crosstalk",
            "global",
            (Parameter("c", "1", -0.5, 0.5, False, 0.0, "of the next joint in each"),),
            **NOVEL,
            report=lambda p, x, step: x + p["c"] * jnp.roll(x, 1, axis=1),
        ),
        Term("crosstalk", values={"c": 0.2}),
    ),
}


@pytest.fixture(params=sorted(TOYS))
def toy(request):
    law, term = TOYS[request.param]
    register(law)
    yield law, term
    del REGISTRY[law.name]


def log_of(term: Term):
    """A log with the declared friction and the term, from the model that identification uses."""
    log = log_with()
    motion = prepare(log, Filtering(60.0, 60.0))
    models = [
        Model(small_arm(), terms, (0.01, 0.01), Filtering(), (1.0, 1.0))
        for terms in ((*DECLARED, term), DECLARED)
    ]
    change = np.subtract(*(model_torque(model, motion) for model in models))
    return replace(log, tau=log.tau + change)


def test_a_new_effect_of_each_kind_needs_its_registration_only(toy, tmp_path):
    law, term = toy
    check_effect(law)
    # The command line and the columns know it.
    parsed = parse_terms(law.name, small_arm().joints)
    assert [t.joint for t in parsed] == ([None] if law.scope == "global" else [0, 1])
    log = log_of(term)
    found, crossfit = declared_fit(log)
    assert any(t.place == term.place for t in eligible_terms(found.model, found.motions))
    # A candidate that passes, and the refit that finds the truth.
    (score,) = score_terms(Linearization(found, crossfit), [replace(term, values={})], 0)
    assert passes(score, 20, Rules())
    after = refit_with(found, score)
    added = find_term(after, score.candidate.term)
    for name, value in term.values.items():
        assert added.values[name] == pytest.approx(value, rel=0.15), name
    assert (after.fit.sigma < 0.8 * found.fit.sigma).any()
    # Its values, intervals and pictures in the report; the model in its file.
    step = Step(added, score, (), (), found, after, ())
    result = to_result(outcome_of(Diagnosis(found, after, (step,), (), cross_fit(after), 20)))
    names = {p.name for p in law.parameters} | set(law.linear_names(small_arm().joints))
    assert set(result["effects"][0]["parameters"]) == names
    assert isinstance(evidence(step, after.model, after.motions[0]), Figure)
    save_model(after.model, tmp_path / "model.json")
    assert load_model(tmp_path / "model.json").terms == after.model.during(None).terms
    # Asked no more where it is, unless it may recur.
    asked = {t.place for t in eligible_terms(after.model, after.motions)}
    assert (term.place in asked) == law.recurring


def test_an_estimate_starts_from_the_nominal_values_of_a_new_effect(toy):
    law, term = toy
    if law.recurring:
        pytest.skip("a window has to be found before anything is fitted in it")
    found = estimate(small_arm(), (*blank(), Term(*term.place)), [prepare(log_of(term), BAND)])
    got = found.model.terms[-1].values
    for name, value in term.values.items():
        assert got[name] == pytest.approx(value, rel=0.2), name


def test_new_effects_act_on_a_plant_or_are_refused(toy):
    law, term = toy
    acting = Acting(*term.place, values={p.name: term.values[p.name] for p in law.parameters})
    rotor = Acting("rotor_inertia", 1, values={"ia": 0.1})
    if law.recurring:
        with pytest.raises(ValueError, match="external"):
            make_plant(small_arm(), [acting])
        return
    plant = make_plant(small_arm(), [rotor, acting])
    assert (len(plant.acting) == 2) != (plant.robot.gravity[1] != small_arm().gravity[1])
    assert (plant.soft == (1,)) == isinstance(law, TransmissionLaw)
