"""A law that was found as a formula is told to be a guess where it was not seen."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.effects.formula import DISCOVERED, Formula
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.predict import predict_log
from jaxswarm.identify.synthetic import random_links, synthetic_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot import rx60

FACTOR = Parameter("a", "N m/rad^2", -1e6, 1e6, True, 1.0, "factor")


def notes(valid: tuple) -> tuple[str, ...]:
    arm = rx60().replace(parameters=random_links(rx60(), np.random.default_rng(0)))
    formula = Formula((("q_other", "q", "*"),), (FACTOR,), valid)
    term = Term(DISCOVERED, 1, 2, {"a": 1.0}, formula)
    log = synthetic_log(arm, (), 0, duration=4.0)
    model = Model(arm, (term,), (0.01,) * 3, Filtering(20.0, 10.0), (1.0,) * 3)
    return predict_log(model, replace(log, notes=())).notes


def test_a_law_asked_where_it_was_seen_says_nothing():
    assert notes((("q", -9.0, 9.0), ("q_other", -9.0, 9.0), ("load", 0.0, 0.0))) == ()


@pytest.mark.parametrize("name,joint", [("q", "joint2"), ("q_other", "joint3")])
def test_a_law_asked_elsewhere_is_told_to_be_a_guess(name, joint):
    (told,) = notes(((name, 8.0, 9.0),))
    assert "found on joint2 is a guess in 100 % of the samples" in told
    assert f"q_{joint} from 8 to 9 only" in told
