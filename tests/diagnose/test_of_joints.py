"""Laws of two joints are not told as one law of the arm, which gains on both at once."""

from dataclasses import replace
from functools import cache

import jax.numpy as jnp
import numpy as np
import pytest
from elbow import ask, passing
from planted import BAND, NOISE

from jaxswarm.diagnose.decision.competing import choose
from jaxswarm.diagnose.decision.of_joints import told_by_joints
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import random_links, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import Robot, robot_from_dh

FRICTION = "viscous_friction,coulomb_friction"
TILT = Term("base_tilt", values={"gx": 0.05, "gy": 0.1})


def one_way(joint: int) -> Term:
    """Friction of a slide that runs harder one way."""
    return Term(
        "asymmetric_friction",
        joint,
        values={"fc_pos": 2.5, "fc_neg": 1.5, "b_pos": 3.0, "b_neg": 1.0},
    )


@cache
def gantry() -> Robot:
    """Two level slides across each other that carry a pendulum."""
    bare = robot_from_dh(
        "gantry",
        convention="modified",
        alpha=[np.pi / 2, np.pi / 2, 0.0],
        a=[0, 0, 0.3],
        d=[0, 0, 0],
        theta=[np.pi / 2, np.pi / 2, 0.0],
        kinds=["prismatic", "prismatic", "revolute"],
    )
    drawn = random_links(bare, np.random.default_rng(3), mass=3.0)
    return bare.replace(parameters=jnp.asarray(drawn))


def asked(*hidden: Term):
    """What passes of a log with hidden terms, the largest gain first, and the folds of the declared model."""
    places = {(h.effect, h.joint) for h in hidden}
    declared = parse_terms(FRICTION, gantry().joints)
    beside = [
        replace(t, values={"b": 2.0, "fc": 2.0})
        for t in declared
        if ("asymmetric_friction", t.joint) not in places
    ]
    log = synthetic_log(gantry(), (*beside, *hidden), 1, noise=NOISE, duration=12.0, rate=125.0)
    found = estimate(gantry(), declared, [prepare(log, BAND)], bounded=False)
    scores = passing(ask(found, "torque_offset", "asymmetric_friction", "base_tilt"))
    return scores, cross_fit(found)


def test_what_laws_of_two_joints_tell_better_is_not_the_tilt_that_gains_more_than_each():
    scores, folds = asked(one_way(0), one_way(1))
    tilt, *joints = scores
    assert tilt.candidate.term.effect == "base_tilt"
    assert told_by_joints(tilt, joints, Rules(), folds)
    assert choose(scores, Rules(), folds)[0].candidate.term.place == (
        "asymmetric_friction",
        1,
        None,
    )
    # One of them alone does not explain what the tilt does on the other joint.
    alone = [s for s in joints if s.joint == 1]
    assert not told_by_joints(tilt, alone, Rules(), folds)
    assert not told_by_joints(joints[0], joints[1:], Rules(), folds)


@pytest.mark.parametrize("beside", [(), (one_way(0),)], ids=["alone", "beside a slide's"])
def test_a_tilt_that_no_law_of_a_joint_adds_to_on_one_of_its_joints_stays(beside):
    scores, folds = asked(TILT, *beside)
    assert choose(scores, Rules(), folds)[0].candidate.term.effect == "base_tilt"
