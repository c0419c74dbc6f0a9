"""A three-joint arm on which errors of positions and of measured torques show, scored against all rivals."""

from dataclasses import replace
from functools import cache

import jax.numpy as jnp
import numpy as np
from planted import BAND, NOISE

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.worth import Score, passes
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.synthetic import random_links, synthetic_log
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import Robot, robot_from_dh

# Candidates that a diagnosis of such an arm asks, for the level of the tests.
ASKED = 100


@cache
def elbow() -> Robot:
    """Three joints, the last two of which carry weight, with drawn physical links."""
    bare = robot_from_dh(
        "elbow",
        convention="modified",
        alpha=[0.0, np.pi / 2, np.pi / 2],
        a=[0, 0, 0.4],
        d=[0, 0, 0],
    )
    return bare.replace(
        parameters=jnp.asarray(random_links(bare, np.random.default_rng(3), mass=6.0))
    )


def elbow_log(*hidden: Term, seed: int = 1) -> Log:
    """A log of the arm with friction and hidden terms."""
    friction = tuple(
        replace(t, values={"b": 2.0, "fc": 2.0})
        for t in parse_terms("viscous_friction,coulomb_friction", elbow().joints)
    )
    return synthetic_log(
        elbow(), (*friction, *hidden), seed, noise=NOISE, duration=12.0, rate=125.0
    )


def fitted(log: Log) -> Estimate:
    """The declared model, friction on every joint, fitted to a log."""
    declared = parse_terms("viscous_friction,coulomb_friction", elbow().joints)
    return estimate(elbow(), declared, [prepare(log, BAND)], bounded=False)


def ask(found: Estimate, *effects: str) -> list[Score]:
    """Scores of some effects wherever they may act, the largest gain first."""
    asked = [t for t in eligible_terms(found.model, found.motions) if t.effect in effects]
    scores = score_terms(Linearization(found, cross_fit(found)), asked, 0)
    return sorted(scores, key=lambda s: -s.gain)


def passing(scores: list[Score]) -> list[Score]:
    """Those that would be added."""
    return [s for s in scores if passes(s, ASKED, Rules())]
