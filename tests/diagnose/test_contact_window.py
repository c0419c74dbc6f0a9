"""Where a contact begins and ends is told to the row, and rows that do not count cut none in two."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy
from planted import BAND, blank, declared_fit, log_with, small_arm
from test_contacts import contact, pushed

from jaxswarm.diagnose import diagnose
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.contact import external_candidate, loudest
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision import event as event_module
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.changes import compare
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import Motion, prepare

NUM_LOGS = 10
# Begin of pushes by hand [s] in a log of 28 s, their length [s] and their highest torque [N m].
BY_HAND = [
    (2.5, 1.1, -3.6, -2.2), (5.0, 1.3, 7.5, 5.6), (8.0, 1.0, 7.6, -6.9), (12.0, 1.3, 2.2, -6.4),
    (14.0, 1.3, -5.2, -3.8), (16.5, 0.4, 2.7, 6.0),
]  # fmt: skip


def by_hand(number: int) -> Motion:
    """A log with so many pushes that swell and fade."""
    log = log_with(duration=28.0, motion_seed=9)
    tau = log.tau.copy()
    for begin, length, *torque in BY_HAND[:number]:
        phase = np.clip((log.t - begin) / length, 0.0, 1.0)[:, None]
        tau += np.sin(np.pi * phase) ** 2 * np.array(torque)
    return prepare(replace(log, tau=tau), BAND)


@cache
def unpushed():
    return estimate(small_arm(), blank(), [prepare(log_with(duration=28.0), BAND)]).model


def window(found, crossfit) -> dict[str, float]:
    return dict(external_candidate(Linearization(found, crossfit), Term("contact")).term.values)


def test_begin_and_end_are_within_their_intervals():
    """Lengths were tried a tenth apart and rows were taken for instants: 9 of 20 edges were in theirs."""
    within = 0
    for k in range(NUM_LOGS):
        start, end = 2.31 + 0.377 * k, 2.31 + 0.377 * k + 0.6 + 0.17 * k
        log = pushed(log_with(seed=k + 1), [(start, end, 1.2, -0.8)])
        found = with_motion_noise(declared_fit(log)[0])
        told = window(found, cross_fit(found))
        term = contact(told["start"], told["end"])
        errors = refit(found, (*found.model.terms, term)).std_errors[-1]
        for name, true in (("start", start), ("end", end)):
            within += abs(told[name] - true) < 1.96 * errors[name]
    # Of 20 edges at 95 %, as few as this happens once in three thousand.
    assert within >= 16


def added(motion: Motion) -> list[Term]:
    return [step.added for step in diagnose(small_arm(), blank(), [motion]).kept]


def changed(motion: Motion) -> list[Term]:
    return [change.term for change in compare(unpushed(), [motion]).changes]


@pytest.mark.parametrize(("number", "told"), [(4, added), (6, changed)])
def test_pushes_do_not_hide_each_other(number, told):
    """Each was refused, as too small a share of the error beside the others, or no more than they remember."""
    found = told(by_hand(number))
    assert [term.effect for term in found] == ["contact"] * number
    windows = sorted((term.values["start"], term.values["end"]) for term in found)
    for (begin, length, *_), (start, end) in zip(BY_HAND, windows, strict=False):
        assert begin < start < begin + 0.5 * length < end < begin + length


def test_only_what_stands_out_may_be_another_event():
    """Of a law that shows in a dozen places most are left, and of slow structure all is."""
    rng = np.random.default_rng(0)
    noise, log, push = rng.normal(size=(1200, 2)), np.zeros(1200), np.ones((1200, 2))

    def rows(left):
        return loudest(push, left, log, 5, lambda share, time: share > 4.0 * time)

    def bumps(number):
        left = noise.copy()
        for k in range(number):
            left[50 + 100 * k : 70 + 100 * k] += 10.0
        return left

    assert not rows(noise).any()
    assert not rows(noise + 10.0 * np.sin(np.arange(1200.0) / 60.0)[:, None]).any()
    for number in (1, 3, 12):
        found = rows(bumps(number)).reshape(12, 100)[:, 50:70]
        assert (found.mean(axis=1) > 0.8).sum() == min(number, 5)
        assert rows(bumps(number)).sum() < 20 * min(number, 5) + 30  # chance finds a few rows


def test_a_change_of_events_tells_their_doubt():
    """Sandwiches over blocks of time gave a push that lasts a few rows half its size, and no doubt of when."""
    within, wide = [], []
    for k in range(NUM_LOGS):
        start = 2.31 + 0.377 * k
        push = {
            "start": start,
            "end": start + 0.6 + 0.17 * k,
            "tau_joint1": 3.0,
            "tau_joint2": -2.0,
        }
        log = pushed(log_with(seed=k + 1, duration=28.0, motion_seed=9), [tuple(push.values())])
        (change,) = compare(unpushed(), [prepare(log, BAND)]).changes
        for name, true in push.items():
            within.append(abs(change.term.values[name] - true) < 1.96 * change.std_errors[name])
        wide.append(
            [change.std_errors[f"tau_joint{j}"] / abs(push[f"tau_joint{j}"]) for j in (1, 2)]
        )
    # Of 40 at 95 %, as few as this happens once in four hundred.
    assert np.sum(within) >= 34
    assert np.max(wide) < 0.06


def test_a_joint_that_rests_within_a_contact_does_not_cut_it_in_two():
    """Its torque is not known there; a push of 2 s was told as one of 1.1 s and one of 0.3 s."""
    found, crossfit = declared_fit(pushed(log_with(), [(4.0, 6.5, 2.0, 0.0)]))
    clock = found.regression.t
    unknown = (clock > 5.2) & (clock < 6.1)
    timing = np.where(unknown[:, None], 1e-3, crossfit.timing)
    left = np.where(unknown[:, None], 0.0, crossfit.whole.residual)
    crossfit = replace(crossfit, timing=timing, whole=replace(crossfit.whole, residual=left))
    told = window(found, crossfit)
    assert (told["start"], told["end"]) == pytest.approx((4.0, 6.5), abs=0.06)


def test_windows_beside_an_event_end_with_their_log(monkeypatch):
    """What is loud at the end of a log and at the begin of the next is two things."""
    logs = [prepare(log_with(duration=d, motion_seed=9), BAND) for d in (12.0, 8.0)]
    crossfit = cross_fit(with_motion_noise(estimate(small_arm(), blank(), logs)))
    seen: list[np.ndarray] = []
    own = event_module.loudest
    monkeypatch.setattr(event_module, "loudest", lambda *of: (seen.append(of[2]), own(*of))[1])
    inside = np.zeros((len(crossfit.weight), 1, 1))
    inside[100:200] = 1.0
    columns = inside * crossfit.weight[:, :, None]
    event_module.score_event(Candidate(contact(4.0, 8.0), (columns,) * 3, 2), crossfit, columns)
    rows = [len(m.t[m.decimator.kept(len(m.t))]) for m in logs]
    assert seen[0].tolist() == np.repeat([0, 1], rows).tolist()


def test_the_chance_of_an_event_is_what_it_says_on_all_joints_and_on_one_of_them():
    """A push of 30 times the noise for 0.4 s on one joint of six was no more than chance beside the others."""
    acting = np.ones(6, dtype=int)
    noise = np.random.default_rng(0).normal(size=(20000, 6)) ** 2
    chances = np.array([event_module.chance_of(squares, acting) for squares in noise])
    for level in (0.05, 0.01):
        # Of 20,000 draws more than this by accident happens once in a thousand.
        assert (chances < level).mean() < level + 3.1 * np.sqrt(level / len(noise))
    alone, together = np.array([36.0, 0, 0, 0, 0, 0]), np.full(6, 6.0)
    assert event_module.chance_of(alone, acting) == pytest.approx(
        12.0 * scipy.stats.chi2.sf(36.0, 1)
    )
    assert event_module.chance_of(together, acting) == pytest.approx(
        2.0 * scipy.stats.chi2.sf(36.0, 6)
    )
    # A load says ten things of one joint.
    load = event_module.chance_of(alone, np.array([10, 0, 0, 0, 0, 0]))
    assert load > event_module.chance_of(alone, acting)
