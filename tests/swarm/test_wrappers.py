"""What each wrapper adds, checked on what it adds."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.swarm import (
    aelspso,
    converged,
    de,
    elitist_learning,
    evolutionary_factor,
    freeze,
    islands,
    pso,
    restart,
    schedules,
)

KEY = jax.random.key(0)
VALUE = jnp.array([4.0, 1.0, 3.0, 2.0])


def test_elitist_trial_differs_from_the_best_in_one_coordinate():
    optimizer = elitist_learning(pso(4), 0.1)
    state = optimizer.init(KEY, 5)
    for k in range(5):
        value = jnp.sum((state.position - 0.4) ** 2, axis=1)
        state, _ = optimizer.update(jax.random.key(k), state, value)
        assert int(jnp.sum(state.position[-1] != state.best_position)) == 1


def test_elitist_trial_that_is_better_becomes_the_best():
    optimizer = elitist_learning(pso(4), 0.1)
    state = optimizer.init(KEY, 3)
    trial = state.position[-1]
    new, info = optimizer.update(KEY, state, jnp.append(VALUE, 0.5))
    np.testing.assert_array_equal(new.best_position, trial)
    assert float(new.best_value) == 0.5 and bool(info.improved)
    # It came in place of the worst, whose memory it now is; the others keep theirs.
    np.testing.assert_array_equal(new.inner.memory_value, [0.5, 1.0, 3.0, 2.0])


@pytest.mark.parametrize("on_failure, worst", [("discard", 4.0), ("replace worst", 9.0)])
def test_elitist_trial_that_fails(on_failure, worst):
    optimizer = elitist_learning(pso(4), 0.1, on_failure=on_failure)
    new, _ = optimizer.update(KEY, optimizer.init(KEY, 3), jnp.append(VALUE, 9.0))
    np.testing.assert_array_equal(new.inner.memory_value, [worst, 1.0, 3.0, 2.0])
    assert float(new.best_value) == 1.0


def test_elitist_scale_follows_its_schedule():
    optimizer = elitist_learning(pso(4), schedules.linear(1.0, 0.0, 4))
    state = optimizer.init(KEY, 3)
    for k in range(5):
        state, info = optimizer.update(jax.random.key(k), state, jnp.append(VALUE, 9.0))
        assert float(info.hyper["learning_scale"]) == pytest.approx(max(0.0, 1.0 - (k + 1) / 4))
    np.testing.assert_array_equal(state.position[-1], state.best_position)  # scale 0: no jump


def test_closed_gate_stops_learning():
    optimizer = elitist_learning(pso(4), 0.1, gate=lambda state: state.best_value < 0.0)
    state, _ = optimizer.update(KEY, optimizer.init(KEY, 3), jnp.append(VALUE, 9.0))
    np.testing.assert_array_equal(state.position[-1], state.best_position)
    state, _ = optimizer.update(KEY, state, jnp.append(-VALUE, 9.0))
    assert not np.array_equal(state.position[-1], state.best_position)


def test_in_place_trial_costs_no_evaluation():
    optimizer = elitist_learning(pso(4), 0.1, extra=False)
    state, _ = optimizer.update(KEY, optimizer.init(KEY, 5), VALUE)
    assert state.position.shape == (4, 5)
    assert int(jnp.sum(state.position[0] != state.best_position)) == 1  # 0 was the worst


def test_evolutionary_factor_by_hand():
    # On a line: mean distances 4/3, 1, 4/3 ... of 0, 1, 2, 4: 7/3, 5/3, 5/3, 3.
    position = jnp.array([[0.0], [1.0], [2.0], [4.0]])
    for leader, expected in [(0, 0.5), (1, 0.0), (2, 0.0), (3, 1.0)]:
        f = evolutionary_factor(position, position[leader])
        assert float(f) == pytest.approx(expected, abs=1e-7)
    assert float(evolutionary_factor(jnp.ones((3, 2)), jnp.ones(2))) == 0.0
    stretched = evolutionary_factor(position, position[0], jnp.array([100.0]))
    assert float(stretched) == pytest.approx(0.5)


def test_aelspso_sets_the_inertia_of_the_paper():
    optimizer = aelspso(6, 10)
    state = optimizer.init(KEY, 3)
    value = jnp.arange(7.0)
    _, info = optimizer.update(KEY, state, value)
    f = info.hyper["evolutionary_factor"]
    assert float(info.hyper["inertia"]) == pytest.approx(1 / (1 + 1.5 * np.exp(-2.6 * f)))
    assert 0.4 <= float(info.hyper["inertia"]) <= 0.9
    assert float(info.hyper["cognitive"]) == float(info.hyper["social"]) == 2.0


def test_adaptive_coefficients_stay_in_their_range():
    optimizer = aelspso(6, 50, adapt_coefficients=True, gate="convergence")
    state, seen = optimizer.init(KEY, 3), set()
    for k in range(40):
        value = jnp.sum((state.position - 0.5) ** 2, axis=1)
        state, info = optimizer.update(jax.random.key(k), state, value)
        c1, c2 = float(info.hyper["cognitive"]), float(info.hyper["social"])
        assert 1.49 <= min(c1, c2) and max(c1, c2) <= 2.5 and c1 + c2 <= 4.0 + 1e-9
        seen.add(int(state.inner.control[0]))
    assert len(seen) > 1


def test_converged_swarm_opens_the_gate():
    swarm = pso(5).init(KEY, 2)
    ringed = swarm._replace(
        position=jnp.array([[0.5, 0.5], [0.4, 0.5], [0.6, 0.5], [0.5, 0.4], [0.5, 0.6]]),
        best_position=jnp.array([0.5, 0.5]),
    )
    assert bool(converged()(ringed))
    assert not bool(converged()(ringed._replace(best_position=jnp.array([0.4, 0.5]))))


def test_restart_when_stalled_keeps_the_record():
    optimizer = restart(pso(4), patience=3, diversity=0.0, keep=True)
    state = optimizer.init(KEY, 2)
    first = state.position
    for k in range(4):
        state, info = optimizer.update(jax.random.key(k), state, VALUE)
    assert int(state.restarts) == 1 and int(state.count) == 4 and int(state.inner.count) == 0
    assert float(state.best_value) == 1.0
    np.testing.assert_array_equal(state.best_position, first[1])
    np.testing.assert_array_equal(state.position[0], first[1])
    assert bool(jnp.isinf(state.inner.best_value)) and float(info.value_best) == 1.0


def test_restart_when_collapsed():
    optimizer = restart(pso(4), patience=1000, diversity=0.1)
    state = optimizer.init(KEY, 2)
    state = state._replace(position=jnp.full((4, 2), 0.5))
    state, _ = optimizer.update(KEY, state, VALUE)
    assert int(state.restarts) == 1 and float(state.position.std()) > 0.1


@pytest.mark.parametrize("build", [pso, de])
def test_restart_takes_over_from_what_begins_anew_by_itself(build):
    """Else lives would end half way between the two, uncounted."""
    assert build().renew and not restart(build()).inner.renew


def test_islands_send_their_best_round():
    optimizer = islands(pso(3, initial_velocity=0.5), 3, migrate_every=2)
    state = optimizer.init(KEY, 2)
    value = jnp.array([5.0, 6.0, 7.0, 2.0, 3.0, 4.0, 8.0, 9.0, 1.0])
    state, _ = optimizer.update(jax.random.key(1), state, value)
    bests = state.inner.best_position
    assert not any((state.position == best).all(axis=1).any() for best in bests)
    state, _ = optimizer.update(jax.random.key(2), state, value + 1.0)
    worst = [2, 5, 7]
    for island in range(3):
        np.testing.assert_array_equal(state.position[worst[island]], bests[island - 1])
    assert float(state.best_value) == 1.0


def test_freeze_holds_its_coordinates():
    optimizer = freeze(pso(4), [False, True, False], [0.0, 0.25, 0.0])
    state = optimizer.init(KEY, 3)
    assert state.inner.position.shape == (4, 2)
    for k in range(3):
        state, _ = optimizer.update(jax.random.key(k), state, VALUE)
        np.testing.assert_array_equal(state.position[:, 1], 0.25)
    assert float(state.best_position[1]) == 0.25


@pytest.mark.parametrize(
    "build, message",
    [
        (lambda: freeze(pso(4), [True, True], [0.0, 0.0]), "mask freezes every"),
        (lambda: freeze(pso(4), [True, False], [2.0, 0.0]), "must hold 2 numbers in"),
        (lambda: freeze(pso(4), [True, False], [0.5, 0.0]).init(KEY, 3), "mask has 2 entries"),
        (lambda: islands(pso(4), 1), "num=1 is too small"),
        (lambda: restart(pso(4), patience=0), "patience=0"),
        (lambda: elitist_learning(pso(4), on_failure="cry"), "on_failure='cry'"),
        (lambda: elitist_learning(pso(4), -1.0), "scale=-1.0"),
        (lambda: aelspso(gate="always"), "gate='always'"),
    ],
)
def test_bad_arguments_are_named(build, message):
    with pytest.raises(InputError, match=message):
        build()
