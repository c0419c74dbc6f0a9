"""How large a gain is goes by the noise of each row, as what is left does."""

from dataclasses import replace

import numpy as np
from planted import declared_fit, log_with

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.folds.noise import row_doubt
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term


def size_of_spring(found):
    crossfit = cross_fit(found)
    (score,) = score_terms(Linearization(found, crossfit), [Term("joint_spring", 1)], 0)
    np.testing.assert_array_equal(crossfit.quiet, row_doubt(found).min(axis=0))
    return score.over_noise


def test_rows_that_say_nothing_do_not_hide_what_the_others_say():
    """A ripple was too small beside a noise that was that of rest alone, eighteen times the usual one."""
    found, _ = declared_fit(log_with(Term("joint_spring", 1, values={"k": 5.0, "tau0": 0.5})))
    (motion,) = found.motions
    noise = np.zeros((len(found.regression.t), 2))
    as_it_is = size_of_spring(replace(found, motions=(replace(motion, model_noise=noise),)))
    noise[::4] = 100.0 * motion.sensor_noise
    by_others = size_of_spring(replace(found, motions=(replace(motion, model_noise=noise.copy()),)))
    assert 0.75 * as_it_is < by_others < as_it_is
