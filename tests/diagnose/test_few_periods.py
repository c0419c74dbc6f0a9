"""A ripple of which few periods are seen is one only if it leaves nothing that follows the position."""

import numpy as np
import pytest
from planted import declared_fit, log_with
from test_unexplained import with_extra

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.diagnose.selection.survives import one_place
from jaxswarm.effects.term import Term

RIPPLE = Term("torque_ripple", 1)


def magnet(q, dq):
    x = (q[:, 1] - 0.2) / 0.4
    return 4.0 * x * np.exp(-(x**2))


def why_not(log):
    """Why the best ripple of the second joint is refused on a log, and its order."""
    before, crossfit = declared_fit(log)
    (score,) = score_terms(Linearization(before, crossfit), [RIPPLE], 0)
    after = refit_with(before, score)
    assert after is not None
    found = find_term(after, RIPPLE)
    return one_place(after, found, Rules(), 0), found.values["n"]


@pytest.mark.parametrize("order", [3.5, 20.0])
def test_a_ripple_is_one(order):
    true = Term("torque_ripple", 1, values={"sine": 1.5, "cosine": 0.5, "n": order})
    why, found = why_not(log_with(true))
    assert why is None
    assert found == pytest.approx(order, rel=0.02)


def test_a_magnet_is_none():
    why, found = why_not(with_extra(magnet))
    assert why is not None
