"""Changes are held against the noise that motion makes, and as they are, not only to first order."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.folds.noise import noise_of, with_motion_noise
from jaxswarm.diagnose.selection import change_again, changes
from jaxswarm.diagnose.selection.earlier_model import freeze
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import Noise
from jaxswarm.logs.motion import prepare


def with_friction(model, part):
    """A model with a part of its friction."""
    terms = tuple(
        replace(t, values={p: part * x for p, x in t.values.items()}) for t in model.terms
    )
    return replace(model, terms=terms)


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
    motions = [prepare(log_with(motion_seed=9), BAND)]
    before = freeze(with_friction(earlier.model, 0.8), motions)
    changed = with_friction(earlier.model, factor)
    monkeypatch.setattr(change_again, "with_changes", lambda found, picked: changed)
    assert (change_again.worse(before, before, ()) is not None) == refused


def test_what_a_change_takes_is_that_of_the_rows_in_use(earlier, monkeypatch):
    """Over all rows, three quarters of which friction held, it was told as a quarter of what it was."""
    motions = [prepare(log_with(motion_seed=9), BAND)]

    def moving(part):
        found = freeze(with_friction(earlier.model, part), motions)
        used = np.zeros(found.fit.residual.shape)
        used[::4] = 1.0
        left = used * found.fit.residual
        return replace(
            found,
            regression=replace(found.regression, share=used),
            fit=replace(found.fit, residual=left),
        )

    before, after = moving(0.8), moving(1.0)
    size, left = (before.regression.rms(e.fit.residual) for e in (before, after))
    taken = size**2 - left**2
    monkeypatch.setattr(change_again, "with_changes", lambda found, picked: after.model)
    monkeypatch.setattr(change_again, "freeze", lambda model, motions: after)
    monkeypatch.setattr(change_again, "lacking", lambda found: np.sqrt(0.5 * taken))
    assert change_again.worse(before, before, ()) is None
