"""The noise of encoders pulls a spring that is fitted to what they say, and its interval has room for that."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND
from test_hardening import DECLARED, PENDULUM, D, K, soft_log

from jaxswarm.diagnose.selection.doubt_of_motion import with_doubt_of_motion
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

COARSE = 1e-4


@pytest.fixture(scope="module")
def found():
    """A soft gear behind an encoder with ten times the noise."""
    log = soft_log(False)
    q = log.q + COARSE * np.random.default_rng(0).normal(size=log.q.shape)
    terms = (
        *parse_terms(DECLARED, PENDULUM.joints),
        Term("joint_elasticity", 0, values={"k": K, "d": D}),
    )
    return estimate(PENDULUM, terms, [prepare(replace(log, q=q), BAND)], bounded=False)


def test_a_spring_is_within_its_interval_behind_a_coarse_encoder(found):
    wide = with_doubt_of_motion(found)
    off = {n: found.model.terms[-1].values[n] - true for n, true in {"k": K, "d": D}.items()}
    for name, error in off.items():
        assert abs(error) > 2.0 * found.std_errors[-1][name]
        assert abs(error) < 1.96 * wide.std_errors[-1][name]
    assert wide.std_errors[:-1] == found.std_errors[:-1]
    assert wide.model is found.model


def test_a_dead_zone_and_a_log_whose_noise_is_not_known_are_left_as_they_are(found):
    gap = Term("backlash", 0, values={"gap": 0.005, "flank": 30.0, "blur": 0.12})
    other = replace(found, model=replace(found.model, terms=(*found.model.terms[:-1], gap)))
    assert with_doubt_of_motion(other) is other
    unknown = tuple(replace(m, position_noise=None) for m in found.motions)
    blind = replace(found, motions=unknown)
    assert with_doubt_of_motion(blind) is blind
