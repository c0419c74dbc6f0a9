"""A joint with backlash: its impacts are predicted one by one, and the doubt of its dead zone is honest."""

from dataclasses import replace
from functools import cache

import jax.numpy as jnp
import numpy as np
import pytest
from planted import DECLARED, blank, small_arm

from jaxswarm.diagnose import diagnose
from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.transmission import lagging_candidate
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import fourier_motion
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.simulate import PD, Reference, make_plant, rest, stable_substeps, track

GAP, ROTOR, RATE, FASTER = 0.004, 0.15, 250.0, 8
ROTORS = (*DECLARED, Term("rotor_inertia", 1, values={"ia": ROTOR}))
BAND = Filtering(35.0, 20.0)


@cache
def loose_log() -> Log:
    """Fifteen seconds of the arm in a closed loop, backlash on the second joint, with sensor noise."""
    plant = make_plant(small_arm(), (*ROTORS, Term("backlash", 1, values={"gap": GAP})))
    t, q, dq, ddq = fourier_motion(2, np.random.default_rng(3), rate=RATE * FASTER, duration=15.0)
    reference = Reference(*(jnp.asarray(x) for x in (q, dq, ddq, np.zeros_like(q))))
    start = rest(plant, jnp.asarray(q[0]), jnp.asarray(dq[0]))
    period = 1.0 / (RATE * FASTER)
    control = PD(jnp.array([150.0, 60.0]), jnp.array([15.0, 5.0]))
    steps = stable_substeps(plant, jnp.asarray(q[0]), period)
    run = track(plant, start, control, reference, dt=period, substeps=steps)
    kept = slice(round(RATE) * FASTER, None, FASTER)
    rng = np.random.default_rng(4)
    q, tau = np.asarray(run.q)[kept], np.asarray(run.tau)[kept]
    return Log(
        source="backlash",
        joints=small_arm().joints,
        t=np.arange(len(q)) / RATE,
        q=q + 1e-5 * rng.normal(size=q.shape),
        tau=tau + 0.05 * rng.normal(size=q.shape),
    )


@cache
def lin() -> Linearization:
    motion = prepare(loose_log(), BAND)
    found = estimate(small_arm(), blank(ROTORS), [motion], bounded=False)
    return Linearization(found, cross_fit(found), Memory())


def test_backlash_is_named_with_its_size_and_nothing_else():
    found = diagnose(small_arm(), blank(ROTORS), [prepare(loose_log(), BAND)])
    assert [(s.added.effect, s.added.joint) for s in found.kept] == [("backlash", 1)]
    term, errors = next(
        (t, e)
        for t, e in zip(found.final.model.terms, found.final.std_errors, strict=True)
        if t.effect == "backlash"
    )
    assert abs(term.values["gap"] - GAP) < 3.0 * errors["gap"] < GAP
    assert term.values["blur"] == 0.0
    assert found.final.fit.sigma[1] < 0.6 * found.declared.fit.sigma[1]
    # One transmission per joint: no spring is asked where there is backlash.
    asked = eligible_terms(found.final.model, found.final.motions)
    assert ("joint_elasticity", 1) not in {(t.effect, t.joint) for t in asked}
    assert ("joint_elasticity", 0) in {(t.effect, t.joint) for t in asked}


def test_impacts_are_predicted_and_the_rotor_takes_its_share():
    candidate = lagging_candidate(lin(), Term("backlash", 1))
    assert candidate.term.values["blur"] == 0.0
    assert candidate.term.values["gap"] == pytest.approx(GAP, rel=0.35)
    inertia = lin().sensed(1)[0].inertia(candidate.start)
    exact = lin().sensed(1)[0].inertia(np.asarray(small_arm().parameters).ravel())
    np.testing.assert_allclose(np.median(inertia), np.median(exact), rtol=0.25)


def test_rows_that_are_left_out_say_nothing_against_impacts():
    """Nothing is left of them, and curves that went on there explained half: a gap was 2.3 times too large."""
    motion = prepare(loose_log(), BAND)
    rows = len(motion.decimator.kept(len(motion.t)))
    held = np.zeros((rows, 2), bool)
    held[np.arange(rows) // 60 % 5 > 2, 1] = True
    found = estimate(small_arm(), blank(ROTORS), [replace(motion, held=held)], bounded=False)
    candidate = lagging_candidate(
        Linearization(found, cross_fit(found), Memory()), Term("backlash", 1)
    )
    assert candidate.term.values["blur"] == 0.0
    assert candidate.term.values["gap"] == pytest.approx(GAP, rel=0.35)


def test_steady_fit_does_not_follow_a_few_large_residuals():
    calm = lin()
    exact = calm.found.regression.torque - calm.found.fit.residual
    rng = np.random.default_rng(0)
    noisy = exact + 0.01 * rng.normal(size=exact.shape)
    hit = noisy.copy()
    hit[50:80] += 3.0
    residuals = []
    for torque in (noisy, hit):
        regression = replace(calm.found.regression, torque=torque)
        columns = regression.columns[:, :, calm.found.fit.base.kept]
        values = np.linalg.lstsq(
            columns.reshape(-1, columns.shape[2]), torque.ravel(), rcond=1e-12
        )[0]
        fit = replace(calm.found.fit, residual=torque - columns @ values, values=values)
        found = replace(calm.found, regression=regression, fit=fit)
        steady = Linearization(found, calm.crossfit, Memory()).steady
        residuals.append((columns @ values - exact, steady))
    (_, (calm_pi, _)), (pulled, (pi, left)) = residuals
    rigid = calm.found.regression.columns[:, :, : len(pi)]
    drift = np.abs(rigid @ (pi - calm_pi)).max()
    assert drift < 0.02 < np.abs(pulled).max()
    assert np.abs(left[50:80]).min() > 50.0
