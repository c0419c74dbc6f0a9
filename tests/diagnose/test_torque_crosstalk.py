"""A torque that is logged with a share of another joint's is told from a coupling of the two, or both are."""

from dataclasses import replace
from functools import cache

import jax.numpy as jnp
import numpy as np
import pytest
from elbow import ask, elbow_log, fitted, passing
from planted import BAND

from jaxswarm.diagnose.decision.competing import choose
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import Joint, Robot, build_robot

CROSSTALK = "torque_crosstalk"
RIVALS = (
    *("transmission_coupling", "cable_coupling", "drive_gain", "link_geometry"),
    *("gear_coupling_error", "joint_spring", "load_dependent_friction"),
)


def crosstalk(joint: int, other: int, c: float) -> Term:
    return Term(CROSSTALK, joint, other, values={"c": c})


def coupling(joint: int, other: int, **values: float) -> Term:
    return Term(
        "transmission_coupling",
        joint,
        other,
        values={"b": 0.0, "fc": 0.0, "fd": 0.0, "ia": 0.0, **values},
    )


def told(found):
    """The law that is chosen, those that it is not told from, and the fit with it."""
    chosen, rivals = choose(passing(ask(found, CROSSTALK, *RIVALS)), Rules(), cross_fit(found))
    terms = [s.candidate.term for s in (chosen, *rivals)]
    return terms[0].place, [t.place for t in terms[1:]], refit_with(found, chosen)


@pytest.mark.parametrize(
    "truth",
    [crosstalk(1, 0, 0.08), crosstalk(0, 1, 0.05), crosstalk(2, 1, -0.03)],
    ids=["of the joint before", "of the joint behind", "little, against it"],
)
def test_a_share_of_another_torque_is_named_with_its_size_and_leaves_nothing(truth):
    place, rivals, after = told(fitted(elbow_log(truth)))
    assert place == truth.place and not rivals
    assert find_term(after, truth).values["c"] == pytest.approx(truth.values["c"], rel=0.02)
    assert not passing(ask(after, CROSSTALK, *RIVALS))


@pytest.mark.parametrize(
    "truth",
    [coupling(1, 2, b=1.0), coupling(1, 0, ia=0.3), coupling(1, 2, fc=1.0), coupling(1, 2, fd=1.0)],
    ids=["viscous", "of inertia", "dry", "dry, of axes that point apart"],
)
def test_a_coupling_is_no_crosstalk(truth):
    place, rivals, after = told(fitted(elbow_log(truth)))
    assert place == truth.place and not rivals
    found = find_term(after, truth).values
    assert found == pytest.approx(truth.values, rel=0.02, abs=0.02)


@cache
def gantry() -> Robot:
    """A slide of 5 kg that carries one of 3 kg across, both level."""
    along, across = np.eye(3)[:2]
    joints = [
        Joint("x", "prismatic", axis=along),
        Joint("y", "prismatic", parent="x", axis=across),
    ]
    masses = np.array([5.0, 3.0])
    return build_robot("gantry", joints).replace(
        parameters=jnp.asarray(masses[:, None] * np.eye(10)[0])
    )


def gantry_fit(friction: str, hidden: Term):
    """The gantry with friction of 2 on both slides, fitted to a log that hides one law more."""
    declared = parse_terms(friction, gantry().joints)
    real = (*(replace(t, values={"b": 2.0, "fc": 2.0}) for t in declared), hidden)
    noise = Noise(2e-6, 0.02)
    log = synthetic_log(gantry(), real, 1, noise=noise, duration=12.0, rate=125.0)
    return estimate(gantry(), declared, [prepare(log, BAND)], bounded=False)


# A twentieth of the inertia and of the viscous friction of the slide y, which is all that its drive supplies.
ALIKE = [crosstalk(0, 1, 0.05), coupling(0, 1, b=0.1, ia=0.15)]


@pytest.mark.parametrize("truth", ALIKE, ids=["crosstalk", "coupling"])
def test_where_both_say_the_same_neither_is_certain(truth):
    place, rivals, _ = told(gantry_fit("viscous_friction", truth))
    assert {place, *rivals} == {t.place for t in ALIKE}


@pytest.mark.parametrize("truth", ALIKE, ids=["crosstalk", "coupling"])
def test_dry_friction_of_the_partner_tells_them_apart(truth):
    place, rivals, _ = told(gantry_fit("viscous_friction,coulomb_friction", truth))
    assert place == truth.place and not rivals


@pytest.mark.parametrize("c", [0.25, 0.9])
def test_more_than_a_sensor_picks_up_is_no_crosstalk(c):
    """The couplings of a measured wrist were told as shares of 0.24 and 0.89."""
    score = next(s for s in ask(gantry_fit("viscous_friction", crosstalk(0, 1, c)), CROSSTALK))
    assert score.coefficients == pytest.approx(c, rel=0.1)
    assert not score.allowed
