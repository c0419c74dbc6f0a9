"""A log begins with bristles bent nobody knows how far: what that leaves is no push."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, NOISE, blank, log_with, small_arm

from jaxswarm.diagnose.candidates.contact import external_candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects import REGISTRY
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

BRISTLES = Term("hysteresis", 0, values={"fc": 6.0, "x0": 0.3})


@pytest.fixture(scope="module")
def bent():
    """A log whose first joint begins with its bristles bent as far as they go, the law known."""
    log = log_with(BRISTLES, noise=replace(NOISE, torque=0.02))
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(log.q[:, 0])))])
    tau = log.tau.copy()
    tau[:, 0] += 6.0 * np.exp(-way / 0.3)
    motion = prepare(replace(log, tau=tau), BAND)
    terms = (*blank(), replace(BRISTLES, values={"x0": 0.3}))
    return with_motion_noise(estimate(small_arm(), terms, [motion], bounded=False)), way


def test_no_touch_is_seen_while_bristles_remember(bent):
    found, way = bent
    lin = Linearization(found, cross_fit(found))
    seen = external_candidate(lin, Term("contact"))
    forgotten = found.motions[0].t[int(np.argmax(way > 0.9))]
    residual = np.abs(lin.crossfit.whole.residual[:, 0])
    early = found.regression.t < forgotten
    assert early[int(np.argmax(residual))]
    assert seen is None or seen.term.values["start"] > forgotten


def test_every_law_with_a_memory_of_travel_says_over_what():
    told = {law.name: law.forgets for law in REGISTRY.values() if getattr(law, "forgets", "")}
    assert {"hysteresis", "lugre_friction", "dwell_friction"} <= set(told)
    for name, parameter in told.items():
        law = REGISTRY[name]
        assert law.rate is not None
        assert parameter in {p.name for p in law.nonlinear}
