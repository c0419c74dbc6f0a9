"""A small two-joint arm whose logs hold planted effects, diagnosed once per session and case."""

from dataclasses import replace
from functools import cache

import jax.numpy as jnp
import numpy as np

from jaxswarm.diagnose import Diagnosis, diagnose
from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.robot import Robot, robot_from_dh

NOISE = Noise(2e-5, 0.1)
# One band for all logs, so that compiled searches are shared between the tests.
BAND = Filtering(20.0, 10.0)
DURATION, RATE = 12.0, 125.0
DECLARED = tuple(
    Term(effect, j, values={symbol: 3.0 / (1 + j)})
    for effect, symbol in (("viscous_friction", "b"), ("coulomb_friction", "fc"))
    for j in range(2)
)


@cache
def small_arm() -> Robot:
    """A pendulum in a vertical plane that carries a second joint, with drawn physical links."""
    bare = robot_from_dh(
        "small", convention="modified", alpha=[np.pi / 2, 0.3], a=[0.0, 0.35], d=[0.0, 0.1]
    )
    return bare.replace(
        parameters=jnp.asarray(random_links(bare, np.random.default_rng(0), mass=6.0))
    )


def log_with(
    *hidden: Term, seed: int = 1, noise: Noise = NOISE, duration=DURATION, motion_seed: int = 7
) -> Log:
    """A log of the arm with the declared friction and hidden terms."""
    return synthetic_log(
        small_arm(),
        (*DECLARED, *hidden),
        seed,
        noise=noise,
        duration=duration,
        rate=RATE,
        motion_seed=motion_seed,
    )


def blank(terms=DECLARED) -> tuple[Term, ...]:
    """Terms as a user declares them, without values."""
    return tuple(replace(t, values={}) for t in terms)


def diagnose_log(log: Log) -> Diagnosis:
    """The loop from the declared friction."""
    return diagnose(small_arm(), blank(), [prepare(log, BAND)])


def declared_fit(log: Log):
    """Estimate and background of the declared model."""
    found = estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False)
    return found, cross_fit(found)


def search_of(found: Estimate, **more) -> Search:
    """A selection that has added nothing to a fit so far."""
    return Search(found, found, Rules(), 0, Memory(), (), lambda text: None, Budget(), **more)


def added(found: Diagnosis) -> list[tuple]:
    """What was added, as (effect, joint)."""
    return [(s.added.effect, s.added.joint) for s in found.kept]
