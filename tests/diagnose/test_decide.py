"""The decision: the test by hand and its level, thresholds, rivals and special cases."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from planted import declared_fit, log_with
from scipy import signal, stats

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.decision.competing import beats, choose, difference, is_special_case, overlap
from jaxswarm.diagnose.decision.judged import can_be
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.score import score
from jaxswarm.diagnose.decision.significance import (
    certainty,
    no_more_than,
    slope_p_value,
)
from jaxswarm.diagnose.decision.worth import Score, passes, runners_up
from jaxswarm.diagnose.selection import refit as refitting
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.finite_columns import Diverged


def told(effect, joint, gain, shows=None, own=None):
    candidate = SimpleNamespace(term=Term(effect, joint))
    where, own = joint if shows is None else shows, None if own is None else np.array([own])
    blocks, per_joint = np.array([gain]), np.full(8, gain / 8 if own is None else own[0])
    return Score(
        candidate, gain, per_joint, blocks, 1.0, 1.0, where, 0.0, 1.0, blocks, True, own=own
    )


def test_runners_up_are_what_else_would_explain_the_same():
    """A refused delay stood before a bristle at twice its gain, and other joints' laws beside any."""
    chosen = told("hysteresis", 4, 10.0)
    lag, rotor, other = (
        told("torque_lag", 4, 3.0),
        told("rotor_inertia", 4, 9.0),
        told("drive_gain", 2, 9.5),
    )
    tilt, delay, worse = (
        told("base_tilt", None, 1.0, 4),
        told("time_delay", None, 20.0, 5),
        told("cable_coupling", 4, -1.0),
    )
    scores = [lag, other, chosen, rotor, tilt, delay, worse]
    refused = {delay.candidate.term.identity}
    assert runners_up(chosen, scores, refused) == (rotor, lag, tilt)
    assert runners_up(tilt, scores) == (delay, chosen, other, rotor, lag)


def test_runners_up_are_compared_as_the_choice_was_made():
    """By the other joints of a short log an offset gained 2.7 times as much, and 0.6 on its own."""
    chosen = told("friction_change", 3, 786.0, own=136.6)
    offset = told("torque_offset", 3, 2126.0, own=83.7)
    ripple = told("torque_ripple", 3, 1080.0, own=-566.0)
    soft = replace(told("base_compliance", None, 4900.0, 3), per_joint=np.full(8, -2.0))
    spring = told("joint_spring", 3, 2112.0, own=90.4)
    assert runners_up(chosen, [ripple, offset, spring, chosen, soft]) == (spring, offset)
    assert offset.relative_gain(chosen) == pytest.approx(0.613, abs=1e-3)
    assert offset.relative_gain(soft) == pytest.approx(2126 / 4900)


def test_slope_p_value_by_hand():
    inner, square = np.array([1.0, 3.0, 2.0]), np.array([1.0, 2.0, 2.0])
    # Leaving one block out: slopes 5/4, 3/3, 4/3; all blocks: 6/5.
    slopes = np.array([1.25, 1.0, 4 / 3])
    spread = np.sqrt(2 / 3 * ((slopes - slopes.mean()) ** 2).sum())
    assert slope_p_value(inner, square) == pytest.approx(stats.t.sf(1.2 / spread, 2))


def test_a_p_value_is_worth_the_standard_errors_that_it_came_from():
    slopes = 1.0 + 0.3 * np.random.default_rng(0).normal(size=12)
    spread = slopes.std(ddof=1) / np.sqrt(12)
    p_value = slope_p_value(slopes, np.ones(12))
    assert certainty(p_value, 12) == pytest.approx(slopes.mean() / spread)


@pytest.mark.parametrize(("late", "allowed"), [(3.46e-3, True), (2.7e-3, False), (2.3e-3, False)])
def test_a_delay_is_told_where_its_own_doubt_leaves_it_above_half_a_sample(late, allowed):
    # The p-value of 13.9 standard errors over 20 blocks: of a normal distribution those are 6.7.
    delay, found = Candidate(Term("time_delay"), (), 1), [np.array([late])] * 3
    assert can_be(delay, found, 1.07e-11, 20, 5e-3) is allowed


def test_slope_p_value_of_nothing_and_of_a_single_block_is_one():
    assert slope_p_value(np.zeros(4), np.zeros(4)) == 1.0
    assert slope_p_value(np.array([5.0, 0, 0]), np.array([5.0, 0, 0])) == 1.0


@pytest.mark.parametrize("memory", [0.0, 0.8])
def test_level_of_the_test_under_white_and_autocorrelated_noise(memory):
    """A wrong prediction is called right at about the nominal rate, or less often."""
    rng = np.random.default_rng(0)
    count, rows, trials = 20, 60, 2000
    wave = np.sin(2 * np.pi * 0.013 * np.arange(count * rows)).reshape(count, rows)
    noise = rng.normal(size=(trials, count * rows))
    noise = signal.lfilter([1.0], [1.0, -memory], noise, axis=1).reshape(trials, count, rows)
    p = [slope_p_value((wave * e).sum(axis=1), (wave**2).sum(axis=1)) for e in noise]
    for level in (0.05, 0.01):
        allowed = level + 3.5 * np.sqrt(level / trials)
        assert np.mean(np.array(p) < level) < allowed


def test_power_of_the_test():
    rng = np.random.default_rng(1)
    wave = np.sin(0.1 * np.arange(1200)).reshape(20, 60)
    y = 0.3 * wave + rng.normal(size=wave.shape)
    assert slope_p_value((wave * y).sum(axis=1), (wave**2).sum(axis=1)) < 1e-4


def wild(waves, noise):
    """p-values of predictions of twenty blocks, one of which is thirty times too large, as is and bounded."""
    waves = waves * np.where(np.arange(20) == 7, 30.0, 1.0)[:, None]
    sums = (noise * waves).sum(axis=1), (waves**2).sum(axis=1)
    return slope_p_value(*sums), slope_p_value(*no_more_than((noise**2).sum(axis=1), *sums))


def test_one_wild_block_does_not_hide_what_the_others_show():
    rng = np.random.default_rng(2)
    wave = np.sin(0.1 * np.arange(1200)).reshape(20, 60)
    plain, bounded = wild(wave, wave + 0.5 * rng.normal(size=wave.shape))
    assert plain > 0.01 and bounded < 1e-6


def test_level_of_the_test_with_a_wild_block():
    """Bounded by what was to be predicted, whatever its sign, chance is no likelier than it says."""
    rng = np.random.default_rng(3)
    wave = np.sin(0.1 * np.arange(1200)).reshape(20, 60)
    p = np.array([wild(wave, rng.normal(size=wave.shape))[1] for _ in range(2000)])
    for level in (0.05, 0.01):
        assert np.mean(p < level) < level + 3.5 * np.sqrt(level / 2000)


@pytest.fixture(scope="module")
def case():
    return declared_fit(log_with(Term("joint_spring", 1, values={"k": 6.0, "tau0": 0.0})))


def candidate(case, own, joint=1, size=1, effect="joint_spring"):
    """A candidate with the given columns (T, k) on a joint."""
    _, crossfit = case
    columns = np.zeros((*crossfit.weight.shape, own.shape[1]))
    columns[:, joint] = own
    columns = crossfit.weigh(columns)
    return Candidate(Term(effect, joint), (columns,) * 3, size)


def position(case):
    motion = case[0].motions[0]
    return motion.q[motion.decimator.kept(len(motion.t)), 1]


@pytest.fixture(scope="module")
def truth(case):
    return candidate(case, position(case)[:, None], effect="torque_offset")


def test_truth_scores_and_passes_and_noise_does_not(case, truth):
    right = score(truth, case[1])
    assert right.share > 0.8 and right.joint == 1 and right.repeats > 0.8
    assert right.coefficients[0] == pytest.approx(6.0, rel=0.05)
    assert right.blocks.sum() == pytest.approx(right.gain) == right.per_joint.sum()
    assert passes(right, 100, Rules())
    noise = np.random.default_rng(0).normal(size=(len(position(case)), 1))
    assert not passes(score(candidate(case, noise), case[1]), 100, Rules())


def test_the_share_of_a_joint_effect_is_that_of_its_own_joint(case):
    """What it takes off another joint, by the parameters that both share, does not count."""
    crossfit, rng = case[1], np.random.default_rng(0)
    more = np.zeros_like(crossfit.weight)
    more[:, 0] = 10.0 * crossfit.whole.residual.std() * rng.normal(size=len(more))
    loud = [replace(f, residual=f.residual + more) for f in crossfit.folds]
    crossfit = replace(crossfit, whole=loud[0], halves=tuple(loud[1:]))
    truth = candidate(case, position(case)[:, None])
    own, other = (score(replace(truth, term=Term("joint_spring", j)), crossfit) for j in (1, 0))
    assert own.joint == 1 and own.share > 0.8 and other.joint == 0 and other.share < 0.2


def test_every_threshold_can_refuse(case, truth):
    good, rules = score(truth, case[1]), Rules()
    assert passes(good, 100, rules)
    for change in (
        {"share": 0.99 * rules.share},
        {"repeats": 0.99 * rules.repeat},
        {"p_value": 1.01 * rules.significance / 100},
        {"allowed": False},
        {"gain": -1.0, "own": None},
        {"own": -good.own},
    ):
        assert not passes(replace(good, **change), 100, rules), change
    assert passes(replace(good, p_value=0.9 * rules.significance / 100), 100, rules)


def test_a_coefficient_against_physics_is_not_allowed(case):
    wrong = candidate(case, -position(case)[:, None], effect="coulomb_friction")
    item = score(wrong, case[1])
    assert item.gain > 0 and not item.allowed


def test_the_smaller_of_two_that_say_the_same_is_chosen_and_the_other_is_no_rival(case, truth):
    q = position(case)
    wide = candidate(case, np.stack([q, np.sin(9 * q)], axis=1), size=2)
    crossfit = case[1]
    assert is_special_case(truth, wide, crossfit)
    assert not is_special_case(wide, truth, crossfit)
    both = [score(c, crossfit) for c in (wide, truth)]
    chosen, rivals = choose(both, Rules(), crossfit)
    assert chosen.candidate is truth and rivals == []


def test_a_law_that_contains_the_chosen_one_is_no_rival_where_it_ends_as_that(case):
    """A slack part of no width: the same column, by a search that spent three numbers on it."""
    q = position(case)
    spring = candidate(case, np.stack([q, q**2], axis=1), size=2, effect="joint_spring")
    slack = candidate(case, (q + 0.001 * q**2)[:, None], size=3, effect="dead_zone_spring")
    crossfit = case[1]
    assert is_special_case(spring, slack, crossfit) and not is_special_case(slack, spring, crossfit)
    chosen, rivals = choose([score(c, crossfit) for c in (slack, spring)], Rules(), crossfit)
    assert chosen.candidate is spring and rivals == []


def test_equal_candidates_of_other_laws_are_rivals(case, truth):
    q = position(case)
    twin = candidate(case, (q + 0.001 * np.cos(5 * q))[:, None], effect="coulomb_friction")
    crossfit = case[1]
    assert overlap(truth, twin, crossfit) > 0.95
    chosen, rivals = choose([score(c, crossfit) for c in (truth, twin)], Rules(), crossfit)
    assert {chosen.candidate.term.effect, rivals[0].candidate.term.effect} == {
        "torque_offset",
        "coulomb_friction",
    }


def test_a_smaller_law_that_leaves_what_the_larger_explains_is_beaten(case, truth):
    q, crossfit = position(case), case[1]
    rough = candidate(case, (q + 0.04 * np.cos(5 * q))[:, None], effect="coulomb_friction")
    large = replace(truth, size=3)
    near, right = score(rough, crossfit), score(large, crossfit)
    assert near.gain > 0.97 * right.gain
    assert beats(right, near, Rules(), crossfit) and not beats(near, right, Rules(), crossfit)
    chosen, rivals = choose([near, right], Rules(), crossfit)
    assert chosen.candidate is large and rivals == []


def test_a_larger_law_of_another_place_is_a_rival_though_it_can_do_the_same(case, truth):
    q, crossfit = position(case), case[1]
    wide = candidate(case, np.stack([q, np.sin(9 * q)], axis=1), size=2, effect="base_tilt")
    wide = replace(wide, term=Term("base_tilt"))
    assert not is_special_case(truth, wide, crossfit)
    chosen, rivals = choose([score(c, crossfit) for c in (wide, truth)], Rules(), crossfit)
    assert chosen.candidate is truth and [r.candidate for r in rivals] == [wide]


def test_further_columns_leave_what_a_refit_with_them_leaves(case, truth):
    crossfit = case[1]
    wider = crossfit.with_columns(truth.columns)
    for fold, more, columns in zip(crossfit.folds, wider.folds, truth.columns, strict=True):
        free = fold.free_part(columns)
        rows, all_rows = (x.reshape(-1, free.shape[2]) for x in (free[fold.train], free))
        fitted = np.linalg.lstsq(rows, fold.residual[fold.train].ravel(), rcond=None)[0]
        left = fold.residual - (all_rows @ fitted).reshape(fold.residual.shape)
        np.testing.assert_allclose(more.residual, left, atol=1e-8)
        # But for what is known of the widths of the signs, which is not fitted to these rows.
        again = more.free_part(columns)[fold.train]
        assert np.linalg.norm(again) < 0.01 * np.linalg.norm(free[fold.train])


def test_unrelated_candidates_are_no_rivals_and_the_better_wins(case, truth):
    crossfit = case[1]
    other = candidate(case, np.sin(4 * position(case))[:, None], joint=0)
    scores = [score(c, crossfit) for c in (other, truth)]
    chosen, rivals = choose(scores, Rules(), crossfit)
    assert chosen.candidate is truth and rivals == []
    assert difference(scores[1], scores[0]) > 2.0 > difference(scores[0], scores[1])


def test_a_candidate_whose_link_runs_away_is_refused(case, truth, monkeypatch):
    """To first order it looked well; the refit finds no finite torque, which is an answer too."""
    found, crossfit = case

    def runs_away(*args):
        raise Diverged("no finite torque")

    monkeypatch.setattr(refitting, "refit", runs_away)
    assert refit_with(found, score(truth, crossfit)) is None


def test_laws_of_one_joint_are_compared_on_that_joint(case, truth):
    """What a law seems to gain on other joints, through parameters that are badly known, is no reason."""
    crossfit = case[1]
    right = score(truth, crossfit)
    assert right.own.sum() == pytest.approx(right.per_joint[1])
    luck = 3.0 * abs(right.blocks).mean()
    poor = candidate(case, np.cbrt(position(case))[:, None], effect="cubic_spring")
    lucky = score(poor, crossfit)
    lucky = replace(lucky, own=0.5 * right.own, blocks=right.blocks + luck, gain=2.0 * right.gain)
    assert difference(right, lucky) > 2.0
    assert choose([lucky, right], Rules(), crossfit)[0] is right
    wide = replace(lucky, own=None)
    assert difference(right, wide) < 0.0


def test_evidence_for_a_law_of_a_joint_is_that_of_its_joint(case, truth):
    """A law that predicts its own joint is not denied by what it does to others by chance."""
    crossfit = case[1]
    columns = truth.columns[0].copy()
    columns[:, 0, 0] = (
        0.3 * np.abs(columns[:, 1, 0]).mean() * np.where(crossfit.block % 4 < 2, 8.0, -8.0)
    )
    spread = replace(truth, columns=(columns,) * 3)
    told = score(spread, crossfit)
    alone = replace(spread, term=Term("base_tilt"))
    assert told.p_value < score(alone, crossfit).p_value


@pytest.mark.parametrize("order", [1, -1])
def test_of_equals_the_one_that_bends_least_is_chosen(case, order):
    """A spring before a cubic one, whichever gains a hair more."""
    q, ripple = position(case), 0.001 * np.cos(5 * position(case))
    plain = candidate(case, (q + order * ripple)[:, None], effect="joint_spring")
    bent = candidate(case, (q - order * ripple)[:, None], effect="cubic_spring")
    crossfit = case[1]
    chosen, rivals = choose([score(c, crossfit) for c in (plain, bent)], Rules(), crossfit)
    assert chosen.candidate is plain and rivals[0].candidate is bent
