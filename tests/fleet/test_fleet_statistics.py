"""Arms that differ, and parameters that drift: found where planted, rarely told by chance."""

import numpy as np
import pytest
from scipy import stats

from jaxswarm.fleet.drift import drifts
from jaxswarm.fleet.mixed_model import FALSE_DISCOVERIES, Series, deviations, scatter
from jaxswarm.fleet.robust import expected_bounded_square, population

BETWEEN, WITHIN = 0.5, 0.2


def simulated(seed, arms=20, logs=2, parameters=10, planted=(), slopes=()):
    """Parameters of a fleet: spread between arms, scatter of logs, known errors; (arm, parameter, size)."""
    rng = np.random.default_rng(seed)
    names = [f"arm{a:03d}" for a in range(arms)]
    found = []
    for p in range(parameters):
        own = 10.0 * rng.normal() + BETWEEN * rng.normal(size=arms)
        for arm, parameter, size in planted:
            own[arm] += size * BETWEEN * (parameter == p)
        days = np.tile(7.0 * np.arange(logs), arms)
        values = np.repeat(own, logs)
        for arm, parameter, size in slopes:
            values += (
                size * WITHIN * (parameter == p) * (np.repeat(range(arms), logs) == arm) * days / 7
            )
        errors = rng.uniform(0.1, 0.4, arms * logs)
        values = values + rng.normal(size=arms * logs) * np.hypot(errors, WITHIN)
        found.append(Series(f"p{p}", list(np.repeat(names, logs)), values, errors, days))
    return found


def told(found, which):
    return {(int(x.arm[3:]), int(x.parameter[1:])) for x in found if getattr(x, which)}


def share_of_false(runs, truth):
    """Mean share of what is told that is not true, with its standard error."""
    shares = np.array([len(t - truth) / max(1, len(t)) for t in runs])
    return shares.mean(), shares.std() / np.sqrt(len(shares))


def test_planted_arms_are_found_and_false_discoveries_stay_below_their_rate():
    planted = ((3, 1, 9.0), (11, 1, -9.0), (7, 6, 9.0))
    truth = {(arm, p) for arm, p, _ in planted}
    runs = [told(deviations(simulated(s, planted=planted)), "differs") for s in range(60)]
    false, error = share_of_false(runs, truth)
    assert false <= FALSE_DISCOVERIES + 3 * error
    assert np.mean([len(t & truth) / len(truth) for t in runs]) > 0.9


@pytest.mark.parametrize("arms", [6, 20])
def test_equal_arms_are_told_apart_no_oftener_than_the_rate(arms):
    # Without anything to find, any discovery at all is a false one.
    runs = [told(deviations(simulated(s, arms=arms)), "differs") for s in range(60)]
    false, _ = share_of_false(runs, set())
    assert false <= stats.binom.ppf(0.999, 60, FALSE_DISCOVERIES) / 60


def test_chances_of_equal_arms_are_not_smaller_than_they_say():
    chances = np.array([x.p_value for s in range(40) for x in deviations(simulated(s))])
    for level in (0.05, 0.01):
        assert (chances < level).mean() < 1.1 * level


def test_center_and_spread_are_those_of_the_normal_population_and_hold_with_outliers():
    rng = np.random.default_rng(0)
    values, variances = rng.normal(3.0, 2.0, 4000), np.full(4000, 1e-6)
    everybody = np.ones((1, 4000), bool)
    clean = population(values, variances, everybody)
    np.testing.assert_allclose([clean.center[0], clean.between[0]], [3.0, 4.0], rtol=0.06)
    values[:400] += 1e6  # a tenth of the arms
    spoiled = population(values, variances, everybody)
    assert abs(spoiled.center[0] - 3.0) < 0.5 and spoiled.between[0] < 8.0


def test_bounded_square_of_a_normal_variable():
    draws = np.random.default_rng(0).normal(size=400_000)
    assert expected_bounded_square(1.5) == pytest.approx(
        np.minimum(draws**2, 1.5**2).mean(), rel=5e-3
    )


def test_scatter_of_logs_beyond_their_errors():
    found = [scatter(simulated(s, arms=200, parameters=1)[0])[0] for s in range(10)]
    assert np.mean(found) == pytest.approx(WITHIN**2, rel=0.2)


def test_a_planted_drift_is_found_and_the_steady_arms_are_left_alone():
    slopes = ((4, 2, 5.0),)
    runs = [told(drifts(simulated(s, logs=4, slopes=slopes)), "drifts") for s in range(60)]
    false, error = share_of_false(runs, {(4, 2)})
    assert false <= FALSE_DISCOVERIES + 3 * error
    assert np.mean([(4, 2) in t for t in runs]) > 0.9


def test_too_few_arms_and_too_few_logs_tell_nothing():
    assert deviations(simulated(0, arms=4)) == []
    assert drifts(simulated(0, arms=4, logs=2)) == []
    assert drifts(simulated(0, logs=1)) == []
