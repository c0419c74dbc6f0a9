"""An addition that raises the error in one cut of a log stays where that in all cuts falls by much."""

from types import SimpleNamespace

import numpy as np
import pytest

from jaxswarm.diagnose.decision.rules import STRETCHES
from jaxswarm.diagnose.selection import stretches

ROWS = 120


def asked(monkeypatch, without, beside, known=1.0):
    """What is told of errors of a joint in halves, thirds and quarters, in units of the fit's own."""
    used = np.ones((ROWS, 1), dtype=bool)
    before, after = (
        SimpleNamespace(
            regression=SimpleNamespace(log=np.zeros(ROWS), used_rows=used),
            fit=SimpleNamespace(residual=np.ones((ROWS, 1)), sigma=np.array([sigma])),
            errors=dict(zip(STRETCHES, errors, strict=True)),
        )
        for errors, sigma in ((without, 4.0), (beside, 1.0))
    )

    def held_out(found, block, sigma):
        assert sigma is after.fit.sigma, "a fit that lacks a law says little by its rows"
        return np.full((ROWS, 1), found.errors[len(np.unique(block))])

    monkeypatch.setattr(stretches, "added_columns", lambda *a: None)
    monkeypatch.setattr(stretches, "least_known", lambda *a: known)
    monkeypatch.setattr(stretches, "held_out_residual", held_out)
    return stretches.on_stretches(before, after, 0)


@pytest.mark.parametrize(
    ("without", "beside", "told"),
    [
        ((1.1, 1.2, 1.1), (0.9, 0.9, 0.9), (True, False)),  # falls in every cut
        ((1.1, 1.2, 1.1), (1.0, 1.3, 1.0), (True, True)),  # rises in one
        ((3.2, 1.5, 1.9), (1.2, 1.7, 1.4), (True, False)),  # and falls by much in all together
        ((5.0, 5.0, 5.0), (4.0, 4.0, 4.0), (False, False)),  # no part predicts another
        ((5.0, 5.0, 5.0), (0.9, 4.0, 4.0), (True, False)),  # but with the addition
    ],
)
def test_cuts_decide_together(monkeypatch, without, beside, told):
    assert asked(monkeypatch, without, beside) == told


def test_a_cut_whose_other_stretches_know_nothing_of_the_addition_does_not_decide(monkeypatch):
    assert asked(monkeypatch, (1.1, 1.1, 1.1), (1.3, 1.3, 1.3), known=0.0) == (False, False)
