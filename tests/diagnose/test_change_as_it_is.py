"""Changes are held against the noise that motion makes, and as they are, not only to first order."""

from dataclasses import replace

import pytest
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.folds.noise import noise_of, with_motion_noise
from jaxswarm.diagnose.selection import change_again, changes
from jaxswarm.diagnose.selection.earlier_model import freeze
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import Noise
from jaxswarm.logs.motion import prepare


@pytest.fixture(scope="module")
def earlier():
    return estimate(small_arm(), blank(), [prepare(log_with(), BAND)])


def test_the_noise_of_a_comparison_is_that_of_a_fit_of_the_same_log(earlier):
    """Without what encoders make of it a slide on a clean log was told as left with 246 times its noise."""
    motion = prepare(log_with(noise=Noise(5e-4, 0.01), motion_seed=9), BAND)
    found = changes.compare(earlier.model, [motion])
    fitted = with_motion_noise(estimate(small_arm(), blank(), [motion]))
    assert noise_of(found.after) == pytest.approx(noise_of(fitted), rel=0.5)
    assert (noise_of(found.after) > 3.0 * motion.torque_noise).all()


@pytest.mark.parametrize(("factor", "refused"), [(0.5, True), (1.0, False)])
def test_a_change_that_leaves_more_as_it_is_is_none(earlier, factor, refused, monkeypatch):
    """``factor`` of the true friction where the earlier model has 0.8 of it."""

    def with_friction(part):
        terms = tuple(
            replace(t, values={p: part * x for p, x in t.values.items()})
            for t in earlier.model.terms
        )
        return replace(earlier.model, terms=terms)

    motions = [prepare(log_with(motion_seed=9), BAND)]
    before = freeze(with_friction(0.8), motions)
    monkeypatch.setattr(change_again, "with_changes", lambda found, picked: with_friction(factor))
    assert (change_again.worse(before, before, ()) is not None) == refused
