"""Errors on other motion, where joints move and where they stand."""

import numpy as np

from jaxswarm.diagnose.selection.elsewhere import compared


def residuals(moving_error: float, standing_error: float, rows: int = 200):
    """Residual (T, 1) of a joint that moves in the first half, and when it does."""
    moving = (np.arange(rows) < rows // 2)[:, None]
    return np.where(moving, moving_error, standing_error), moving


def test_what_dry_friction_holds_at_rest_does_not_hide_what_motion_shows():
    before, moving = residuals(0.25, 2.8)
    after, _ = residuals(0.15, 2.8)
    one, two, falls, _ = compared(before, after, moving)
    assert two[0] / one[0] > 0.99
    assert falls[0]


def test_what_helps_at_rest_alone_is_a_fall_too():
    before, moving = residuals(0.25, 2.8)
    after, _ = residuals(0.25, 1.0)
    assert compared(before, after, moving)[2][0]


def test_neither_a_standing_joint_nor_an_equal_error_falls():
    before, moving = residuals(0.25, 0.0)
    assert not compared(before, before, moving)[2][0]
    assert not compared(before * 0.0, before * 0.0, moving)[2][0]
    assert not compared(before, before, np.zeros_like(moving))[2][0]


def test_a_rise_in_one_stretch_is_chance_and_one_all_along_is_not():
    """Both raise the RMS error by the same two fifths."""
    rng = np.random.default_rng(0)
    before = rng.normal(size=(400, 1))
    moving = np.ones_like(before, bool)
    everywhere = 1.4 * before
    burst = before.copy()
    burst[100:110] *= np.sqrt(1 + 0.96 * (before**2).sum() / (before[100:110] ** 2).sum())
    for after, sure in ((everywhere, True), (burst, False), (before, False)):
        one, two, _, rises = compared(before, after, moving)
        assert rises[0] == sure
        assert after is before or np.isclose(two[0] / one[0], 1.4)
