"""What shows faintly is told where nothing else could be taken for it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jaxswarm.identify.checks.channels import _believed, wrong_channels
from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.identify.checks.faint import clear_gain, is_worth
from jaxswarm.identify.checks.guess import Scale
from jaxswarm.identify.checks.guesses import (
    ENCODER_ZERO,
    motion_scale_guesses,
    torque_guesses,
    zero_guess,
)
from jaxswarm.identify.checks.late import late_torque
from jaxswarm.identify.checks.lateness import Lateness
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import fine_samples, samples_of
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.identify.checks.torque_scales import torque_scale_guesses
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments


def column(values, joint, factor):
    return values * np.where(np.arange(values.shape[1]) == joint, factor, 1.0)


def motions(log):
    return prepare_segments(log, Filtering(torque_cutoff=5.0))[1]


HALF_AS_LARGE = {
    "torque_scale": lambda log: replace(log, tau=column(log.tau, 1, 0.5)),
    "encoder_scale": lambda log: replace(log, q=column(log.q, 1, 0.5)),
    "time_scale": lambda log: replace(log, t=0.5 * log.t),
}


@pytest.mark.parametrize("check", HALF_AS_LARGE)
def test_a_scale_is_exact_at_the_number_that_was_taken_for_another(arm, log, check):
    fine = Rough(arm, fine_samples(motions(HALF_AS_LARGE[check](log))))
    guesses = [*torque_scale_guesses(arm), *motion_scale_guesses(arm)]
    right = "time is twice" if check == "time_scale" else "joint2 is twice"
    (guess,) = [g for g in guesses if g.check == check and right in g.what]
    assert clear_gain(arm, fine, guess) > 0.0
    assert clear_gain(arm, fine, guess.nearby(1.4)) == 0.0
    assert clear_gain(arm, fine, guess.nearby(0.7)) == 0.0


@pytest.mark.parametrize("joint", [0, 1])
@pytest.mark.parametrize(("gain", "told"), [(0.6, []), (0.5, ["torque_scale"])])
def test_a_gain_of_a_drive_is_no_torque_of_twice_what_is_logged(arm, log, joint, gain, told):
    """It was refused as one, and what explained less, another sign, was told in its place."""
    weak = replace(log, tau=column(log.tau, joint, gain))
    assert [one.check for one in against_robot(arm, motions(weak))] == told


@pytest.mark.parametrize("check", HALF_AS_LARGE)
def test_a_scale_that_a_rough_model_takes_for_wrong_a_fine_one_has_to_confirm(arm, log, check):
    """Of a play on a move from point to point a rough model alone made half a position."""
    rough = Rough(arm, samples_of(motions(HALF_AS_LARGE[check](log))))
    spoiled, sound = (
        Rough(arm, fine_samples(motions(x))) for x in (HALF_AS_LARGE[check](log), log)
    )
    assert wrong_channels(arm, rough, lambda: spoiled).check == check
    assert wrong_channels(arm, rough, lambda: sound) is None


@pytest.mark.parametrize("check", HALF_AS_LARGE)
def test_a_wrong_scale_gains_far_more_in_a_fine_model(arm, log, check):
    """A rough one leaves what its one width of the sign and its columns without a low-pass make, on any log."""
    parts = motions(log)
    rough, fine = (Rough(arm, made(parts)) for made in (samples_of, fine_samples))
    assert fine.as_logged()[0].power < rough.as_logged()[0].power - 1.0
    (guess, *_) = [
        g
        for g in (*torque_scale_guesses(arm), *motion_scale_guesses(arm))
        if g.check == check and "half" in g.what and (check == "time_scale" or g.joints == (1,))
    ]
    gains = []
    for model in (rough, fine):
        logged, sigma = model.as_logged()
        if guess.mixture is not None:
            (other,) = model.fit([guess.mixture], sigma)
        else:
            other = Rough(arm, guess.moved(model.samples)).as_logged()[0]
        gains.append(other.power - logged.power)
    assert gains[1] > 1.3 * gains[0] > 0.0
    assert clear_gain(arm, fine, guess) == 0.0


@pytest.mark.parametrize(
    ("low", "high", "exact"),
    [(0.2, 0.25, True), (-0.01, 0.26, True), (-0.1, 0.3, False), (-0.1, -0.2, False)],
)
def test_the_least_of_a_flat_valley_may_lie_a_little_beside_the_scale(arm, low, high, exact):
    """Half the torque of a joint with thermal drift left a hundredth less at 0.77 of the right scale."""
    left = {1.0 / 1.3: low, 1.0: 0.0, 1.3: high}

    def scale(factor):
        return Scale("torque_scale", "", (0,), mixture=factor, factor=factor, nearby=scale)

    guess = scale(1.0)

    class Left(Tried):
        power = 0.0

    def tried(power, share):
        one = Left(np.full(6, share), np.ones(6))
        object.__setattr__(one, "power", power)
        return one

    def told(gain, strictness=1.0, share=0.03):
        fine = SimpleNamespace(
            strictness=strictness,
            fit=lambda mixtures, sigma: [tried(left[mixtures[0]], share)],
            as_logged=lambda: (tried(gain, share), np.ones(6)),
        )
        return clear_gain(arm, fine, guess) > 0.0

    assert told(0.51) == exact and not told(0.49)  # a ripple made 0.34 of it
    # Few rows bend: a right torque gained 0.7 at twice its scale, with two of them a parameter.
    assert not told(0.7, strictness=4.0) and told(1.3, strictness=4.0) == exact


def test_a_small_zero_that_shows_faintly_is_not_told(arm):
    """Springs, cables over two joints and tilts of the base looked like zeros of 0.07 to 0.16 rad."""
    assert [is_worth(zero_guess(arm, 1, zero), 0.3) for zero in (-0.3, -0.16, 0.07, 0.3)] == [
        *(True, False, False, True)
    ]


def test_a_torque_of_the_wrong_sign_is_told_where_friction_says_nothing(arm):
    """A last joint without friction gained 0.39; no pattern of wrong signs ever gained a tenth of that."""
    guesses = [g for g in torque_guesses(arm) if g.check == "torque_sign" and len(g.joints) == 1]
    (guess,) = [g for g in guesses if g.joints == (2,)]
    logged, found = (
        Tried(np.full(6, left), np.zeros(6)) for left in (0.1, 0.1 * np.exp(-0.39 / 6))
    )
    assert _believed(guess, found, logged, 1.0)
    assert not _believed(guess, found, logged, 1.5)  # a short log asks for more
    assert not _believed(replace(guess, check="swapped_channels"), found, logged, 1.0)


def test_a_last_joint_of_the_wrong_sign_shows_behind_five_that_are_right(arm, log):
    wrong = replace(log, q=column(log.q, 5, -1.0))
    parts = motions(wrong)
    logged, _ = Rough(arm, samples_of(parts)).as_logged()
    assert logged.size < 0.1  # of all torques little is left
    assert [one.check for one in against_robot(arm, parts)] == ["position_sign"]


@pytest.mark.parametrize(("joint", "zero"), [(1, 0.3), (2, -0.1), (4, 0.5)])
def test_a_zero_that_is_off_is_told_with_its_size_and_the_work_goes_on(arm, log, joint, zero):
    off = replace(log, q=log.q + zero * (np.arange(6) == joint))
    (found,) = against_robot(arm, motions(off))
    assert found.check == ENCODER_ZERO and not found.refused
    side = "large" if zero > 0 else "small"
    assert f"the position of joint{joint + 1} reads {abs(zero):.2f} rad too {side}" in found.what


def test_zeros_that_nothing_shows_are_not_guessed(arm, log):
    """A first axis that is vertical, and a last one: no motion tells where they begin to count."""
    off = replace(log, q=log.q + 0.3 * np.isin(np.arange(6), (0, 5)))
    assert against_robot(arm, motions(off)) == []


class Known:
    """A rough model of which all is known."""

    strictness = 1.0

    def __init__(self, left: float, gain: float, milliseconds: float = 18.0):
        self.left, self.gain, self.milliseconds = left, gain, milliseconds

    def as_logged(self):
        left = np.full(6, 0.03)
        left[1] = self.left
        return Tried(left, np.ones(6)), np.ones(6)

    def lateness_in_parts(self, sigma, parts):
        return [self.lateness(sigma)] * parts

    def lateness(self, sigma):
        seconds, gain = np.array([1.0, 0.0, -1.0, 0.0, 1.0, -1.0]), np.full(6, -0.01)
        seconds[1] = self.milliseconds
        gain[1] = self.gain
        return Lateness(1e-3 * seconds, gain)

    def lateness_beside_a_line(self, sigma, joint):
        return self.lateness(sigma)

    def lateness_beside_its_place(self, sigma, joint):
        return self.lateness(sigma)

    def lateness_in_motion(self, sigma):
        return self.lateness(sigma)

    def lateness_without_friction(self, sigma, joint):
        return self.lateness(sigma)

    def lateness_without_noise(self, sigma):
        return self.lateness(sigma)


# A model that has nothing to tell, and one of too few rows to be asked.
NOTHING = Known(0.02, 0.0, 0.0)
TOO_FEW = Known(0.02, 0.0, 0.0)
TOO_FEW.strictness = 4.0
INTERVAL = 0.005


class Late(Known):
    """Half a log, whose second joint is late by so many milliseconds."""

    def __init__(self, milliseconds):
        super().__init__(0.02, -0.4, milliseconds)

    def lateness(self, sigma):
        return Lateness(
            1e-3 * np.array([1.0, self.milliseconds, -1.0, 0.0, 1.0, -1.0]), np.zeros(6)
        )


@pytest.mark.parametrize(
    ("left", "gain", "milliseconds", "told"),
    [
        (0.02, -0.08, 18.0, True),
        (0.02, -0.05, 18.0, False),
        (0.02, -0.1, 11.0, False),
        (0.09, -0.1, 18.0, True),
        (0.09, -0.24, 33.0, False),
        (0.09, -0.4, 33.0, True),
        (0.25, -0.2, 18.0, False),
    ],
)
def test_a_delay_is_clear_where_little_else_is_missing(arm, left, gain, milliseconds, told):
    """Bristles of harmonic drives look 33 ms late and more, on joints of which they leave a tenth."""
    found = late_torque(arm, Known(left, gain, milliseconds), TOO_FEW, INTERVAL)
    assert (found is not None) == told
    assert not told or f"joint2 is {milliseconds:.0f} ms late" in found.what


@pytest.mark.parametrize(
    ("in_rough", "in_fine", "refused"),
    [(-0.08, -0.19, False), (-0.12, 0.0, False), (-0.4, 0.0, True), (-0.2, -0.5, True)],
)
def test_a_log_is_refused_where_a_delay_is_most_of_what_is_missing(arm, in_rough, in_fine, refused):
    """A coupling that nobody declared looked 12 ms late, by 8 % of what was left: the log is sound."""
    rough, fine = Known(0.02, in_rough, 18.0), Known(0.02, in_fine, 18.0)
    assert late_torque(arm, rough, fine, INTERVAL).refused == refused


@pytest.mark.parametrize(
    ("in_fine", "told"), [(18.0, True), (10.0, True), (6.0, False), (-18.0, False)]
)
def test_what_a_rough_model_takes_for_a_delay_a_fine_one_has_to_confirm(arm, in_fine, told):
    """Play looked 13 ms early in a rough model, by a tenth of what that left; a fine one left a thirtieth."""
    rough, fine = Known(0.02, -0.4, 18.0), Known(0.003, -0.01, in_fine)
    assert (late_torque(arm, rough, fine, INTERVAL) is not None) == told


@pytest.mark.parametrize(("interval", "told"), [(0.005, True), (0.017, True), (0.02, False)])
def test_what_is_a_part_of_a_sample_apart_is_a_matter_of_the_clock(arm, interval, told):
    rough = Known(0.02, -0.4, 18.0)
    assert (late_torque(arm, rough, rough, interval) is not None) == told


@pytest.mark.parametrize(
    ("left", "gain", "milliseconds", "spread", "told"),
    [
        (0.08, -0.9, 26.0, 12.0, True),
        (0.03, -0.36, 28.0, 12.0, False),  # harmonic drives
        (0.05, -0.19, 9.0, 4.0, False),  # friction that grows with the load
        (0.10, -0.25, 16.0, 8.0, True),
        (0.02, -0.16, 26.0, 12.0, True),
        (0.09, -0.16, 30.0, 3.0, True),
        (0.17, -0.12, 20.0, 3.0, False),  # bristles,
    ],
)
def test_a_fine_model_tells_a_delay_that_a_rough_one_does_not(
    arm, left, gain, milliseconds, spread, told
):
    fine = Known(left, gain, milliseconds)
    times = milliseconds + spread * np.array([1.0, -1.0, 0.0, 1.0, -1.0, 0.0])
    by_parts = {1: [milliseconds], 2: 2 * [milliseconds], 6: times}
    fine.lateness_in_parts = lambda sigma, parts: [Late(x).lateness(None) for x in by_parts[parts]]
    assert late_torque(arm, NOTHING, NOTHING, INTERVAL) is None
    assert (late_torque(arm, NOTHING, fine, INTERVAL) is not None) == told
    fine.strictness = 4.0  # fewer rows than two a parameter: of them nothing is known
    assert late_torque(arm, NOTHING, fine, INTERVAL) is None


@pytest.mark.parametrize(("spread", "told"), [(6.0, True), (20.0, False)])
def test_a_faint_delay_is_as_long_in_every_part_of_a_log(arm, spread, told):
    """Two clean arms had 12 and 13 ms that lowered what was left by a tenth, and any time in their parts."""
    rough = Known(0.02, -0.1)
    times = 18.0 + spread * np.array([1.0, -1.0, 0.0, 1.0, -1.0, 0.0])
    by_parts = {1: [18.0], 2: [18.0, 18.0], 6: times}
    rough.lateness_in_parts = lambda sigma, parts: [Late(x).lateness(None) for x in by_parts[parts]]
    assert (late_torque(arm, rough, TOO_FEW, INTERVAL) is not None) == told
    rough.strictness = (
        4.0  # of few rows everything seems steady: 3.7 errors and 40 % of what was left on one
    )
    rough.gain = -0.5
    assert late_torque(arm, rough, TOO_FEW, INTERVAL) is None


@pytest.mark.parametrize(
    ("first", "second", "told"), [(15, 22, True), (22, 5, False), (40, -9, False)]
)
def test_a_delay_is_one_that_both_halves_of_a_log_tell(arm, first, second, told):
    """A wrong drive gain left 15 ms on a joint of a world, and 11 and 23 ms of the other sign in its halves."""
    rough = Known(0.02, -0.4)
    halves = [Late(seconds).lateness(None) for seconds in (first, second)]
    rough.lateness_in_parts = lambda sigma, parts: np.repeat(halves, parts // 2).tolist()
    found = late_torque(arm, rough, TOO_FEW, INTERVAL)
    assert (found is not None) == told


def test_a_joint_that_tells_nothing_makes_no_other_one_late(arm):
    """All torques are 16 ms late; one joint is 40 ms early as far as its error goes, which hardly changes."""
    seconds = 1e-3 * np.array([-40.0, 14.0, 17.0])
    gain = np.array([-0.005, -0.2, -0.7])
    rough = SimpleNamespace(
        strictness=1.0,
        as_logged=lambda: (Tried(np.full(3, 0.03), np.ones(3)), np.ones(3)),
        lateness=lambda sigma: Lateness(seconds, gain),
    )
    rough.lateness_in_parts = lambda sigma, parts: [rough.lateness(sigma)] * parts
    rough.lateness_beside_a_line = lambda sigma, joint: rough.lateness(sigma)
    rough.lateness_in_motion = lambda sigma: rough.lateness_beside_a_line(sigma, 0)
    rough.lateness_without_noise = rough.lateness_in_motion
    rough.lateness_without_friction = rough.lateness_beside_a_line
    rough.lateness_beside_its_place = rough.lateness_beside_a_line
    robot = SimpleNamespace(num_joints=3, joints=("a", "b", "c"))
    assert late_torque(robot, rough, rough, INTERVAL) is None


def test_the_other_joint_of_two_is_the_clock():
    """The middle of both would halve what they are apart."""
    both = Tried(np.full(2, 0.04), np.ones(2)), np.ones(2)
    late = Lateness(np.array([0.002, 0.0135]), np.array([0.0, -0.25]))
    pair = SimpleNamespace(strictness=1.0, as_logged=lambda: both, lateness=lambda sigma: late)
    pair.lateness_in_parts = lambda sigma, parts: [late] * parts
    pair.lateness_beside_a_line = lambda sigma, joint: late
    pair.lateness_in_motion = pair.lateness_without_noise = lambda sigma: late
    pair.lateness_without_friction = pair.lateness_beside_its_place = pair.lateness_beside_a_line
    found = late_torque(SimpleNamespace(num_joints=2, joints=("a", "b")), pair, pair, INTERVAL)
    assert found is not None and "b is 12 ms late" in found.what
