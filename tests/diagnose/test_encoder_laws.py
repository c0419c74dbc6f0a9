"""Wrong positions are named by their law and joint, and not one of their doubles; true ones by none."""

from dataclasses import replace

import numpy as np
import pytest
from elbow import ask, elbow, elbow_log, fitted, passing

from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.selection.beside_sign import is_told_from_sign
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.diagnose.selection.tenable import can_be_as_wrong
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.torque_along import torque_along

LAWS = ("encoder_offset", "encoder_eccentricity", "gear_coupling_error", "base_tilt")
DOUBLES = ("joint_spring", "cubic_spring", "cable_coupling", "transmission_coupling")
PLANTED = [
    Term("encoder_offset", 1, values={"dq0": 0.06}),
    Term("encoder_eccentricity", 1, values={"s1": 0.03, "c1": -0.01, "s2": 0.01, "c2": 0.0}),
    Term("gear_coupling_error", 2, 1, values={"c": 0.08}),
]


@pytest.mark.parametrize("truth", PLANTED, ids=lambda t: t.effect)
def test_a_wrong_position_is_named_with_its_values(truth):
    found = fitted(elbow_log(truth))
    scores = ask(found, *LAWS, *DOUBLES)
    best = passing(scores)[0]
    assert best.candidate.term.place == truth.place
    after = refit_with(found, best)
    values = find_term(after, best.candidate.term).values
    place = [t.place for t in after.model.terms].index(truth.place)
    size = max(map(abs, truth.values.values()))
    for name, value in truth.values.items():
        error = after.std_errors[place][name]
        assert error < 0.25 * size, name
        assert abs(values[name] - value) < 2.5 * error, name
    assert (after.fit.sigma <= 1.05 * found.fit.sigma).all()


def test_true_positions_are_left_as_they_are():
    assert not passing(ask(fitted(elbow_log()), *LAWS))


def test_an_encoder_or_a_base_that_would_be_worse_than_any_is_refused():
    assert can_be_as_wrong(Term("gear_coupling_error", 2, 1, values={"c": 0.3}))
    assert not can_be_as_wrong(Term("gear_coupling_error", 2, 1, values={"c": 0.5}))
    assert not can_be_as_wrong(Term("encoder_offset", 1, values={"dq0": -0.5}))
    assert can_be_as_wrong(Term("time_delay", None, values={"seconds": 0.02}))
    assert not can_be_as_wrong(Term("time_delay", None, values={"seconds": 0.05}))
    assert can_be_as_wrong(Term("base_tilt", None, values={"gx": -0.3, "gy": 2.9}))
    assert not can_be_as_wrong(Term("base_tilt", None, values={"gx": -0.3, "gy": 3.0}))
    assert can_be_as_wrong(Term("viscous_friction", 1, values={"b": 0.0}))


def test_friction_follows_the_true_motion_and_not_what_an_encoder_says():
    """Where a coupling ratio is wrong, the joint may turn while its encoder stands still."""
    coupled = Term("gear_coupling_error", 1, 2, values={"c": 0.5})
    viscous = Term("viscous_friction", 1, values={"b": 2.0})
    motion = fitted(elbow_log()).motions[0]
    still = np.zeros_like(motion.q)
    turned = still.copy()
    turned[:, 2] = 0.3
    standing = replace(motion, q=still, dq=turned, ddq=still)
    width = (0.01,) * 3
    without, own = (
        torque_along(elbow(), terms, standing, width, np.append(np.zeros(30), 2.0))
        for terms in ((viscous,), (coupled, viscous))
    )
    np.testing.assert_allclose(without, 0.0)
    np.testing.assert_allclose(own[:, 1], 2.0 * 0.5 * 0.3)


def test_an_error_within_the_width_of_a_sign_is_the_shape_of_friction():
    """A wrist of friction alone, its torque in coarse steps, was told as a coupling ratio off by 0.0014."""
    found = with_motion_noise(fitted(elbow_log()))
    motion = found.motions[0]
    turned = Term("gear_coupling_error", 2, 1, values={"c": 0.02})
    speed = 0.02 * np.sqrt(np.mean(motion.dq[:, 1] ** 2))

    def told(width: float, loud: float) -> bool:
        model = replace(found.model, terms=(*found.model.terms, turned), width=(width,) * 3)
        noisy = replace(motion, model_noise=motion.model_noise + loud)
        return is_told_from_sign(replace(found, model=model, motions=(noisy,)), turned)

    assert not told(1.5 * speed, loud=10.0)
    assert told(0.7 * speed, loud=10.0)
    # Links go by it too.
    assert told(1.5 * speed, loud=0.0)
    for other in (
        Term("encoder_offset", 1, values={"dq0": 1e-4}),
        Term("viscous_friction", 1, values={"b": 1.0}),
    ):
        assert is_told_from_sign(found, other)
