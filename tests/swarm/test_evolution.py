"""Genetic operators, differential evolution, CMA-ES, SEPSO and CLPSO: rules against hand and law."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.swarm import (
    Space,
    clpso,
    cma_es,
    de,
    ga,
    lshade,
    minimize_runs,
    operators,
    sepso,
    shade,
    textbook_ga,
)
from jaxswarm.swarm.optimizers.cma_distribution import Rates
from jaxswarm.swarm.optimizers.counting import FEW
from jaxswarm.swarm.optimizers.de import cross, within
from jaxswarm.swarm.optimizers.rules import Swarm
from jaxswarm.swarm.random import Random
from jaxswarm.swarm.schedules import for_run

KEY = jax.random.key(0)
RANDOM = Random(KEY)


def test_sbx_keeps_the_mean_and_the_bounds():
    first, second = jnp.full((4000, 3), 0.4), jnp.full((4000, 3), 0.6)
    a, b = jnp.split(operators.sbx(15.0, 1.0)(RANDOM, first, second), 2)
    np.testing.assert_allclose(0.5 * (a + b), 0.5, atol=2e-3)  # symmetric room: symmetric spread
    crossed = np.asarray(a != first)
    assert crossed.mean() == pytest.approx(0.5, abs=0.02)
    assert bool(((a >= 0) & (a <= 1)).all())
    # With eta the spread beta has median 1: half the children lie between the parents.
    between = np.asarray((a > 0.4) & (a < 0.6))[crossed]
    assert between.mean() == pytest.approx(0.5, abs=0.03)


def test_polynomial_mutation_rate_and_size():
    children = jnp.full((5000, 4), 0.5)
    mutant = np.asarray(operators.polynomial(20.0)(RANDOM, children))
    changed = mutant != 0.5
    assert changed.mean() == pytest.approx(0.25, abs=0.02)  # 1/d
    steps = np.abs(mutant[changed] - 0.5)
    # |delta| = 1 - (2u)^(1/21) far from the bounds; its mean is 1/22, over a range of 1.
    assert steps.mean() == pytest.approx(1 / 22, rel=0.05)


def test_gaussian_and_uniform_mutation():
    children = jnp.full((5000, 4), 0.5)
    noisy = np.asarray(operators.gaussian(0.1, 1.0)(RANDOM, children))
    assert noisy.std() == pytest.approx(0.1, rel=0.03)
    fresh = np.asarray(operators.uniform(0.1)(RANDOM, children))
    assert (fresh != 0.5).mean() == pytest.approx(0.1, abs=0.01)


def test_roulette_follows_one_over_value():
    value = jnp.array([1.0, 2.0, 4.0, jnp.inf])
    pick = jax.vmap(lambda k: operators.roulette()(Random(k), value))
    drawn = np.asarray(pick(jax.random.split(KEY, 4000))).ravel()
    share = np.bincount(drawn, minlength=4) / drawn.size
    np.testing.assert_allclose(share, [4 / 7, 2 / 7, 1 / 7, 0.0], atol=0.02)
    exact = operators.roulette()(RANDOM, jnp.array([0.0, 1.0, 1.0, 1.0], jnp.float32))
    assert not exact.any()  # a value of zero takes the wheel, and does not overflow it


def test_tournament_prefers_the_better():
    value = jnp.arange(4.0)
    pick = jax.vmap(lambda k: operators.tournament(2)(Random(k), value))
    drawn = np.asarray(pick(jax.random.split(KEY, 4000))).ravel()
    share = np.bincount(drawn, minlength=4) / drawn.size
    np.testing.assert_allclose(share, np.array([7, 5, 3, 1]) / 16, atol=0.02)
    # No order leaves anybody out: the best wins every tournament it enters, two on each side.
    wins = (np.asarray(pick(jax.random.split(KEY, 500))) == 0).sum(axis=2)
    assert set(np.unique(wins)) <= {1, 2}


def test_arithmetic_crossover_keeps_the_sum():
    first, second = jnp.full((500, 2), 0.2), jnp.full((500, 2), 0.8)
    a, b = jnp.split(operators.arithmetic(0.8)(RANDOM, first, second), 2)
    np.testing.assert_allclose(a + b, 1.0, atol=1e-6)
    assert np.mean(np.asarray(a[:, 0] != 0.2)) == pytest.approx(0.8, abs=0.06)


@pytest.mark.parametrize("build, elites", [(ga, 6), (textbook_ga, 1)])
def test_survivors_are_children_and_elites(build, elites):
    optimizer = build(6)
    state = optimizer.init(KEY, 2)
    state, _ = optimizer.update(KEY, state, jnp.array([5.0, 1.0, 4.0, 2.0, 6.0, 3.0]))
    np.testing.assert_array_equal(state.parent_value, [1, 2, 3, 4, 5, 6])
    new, _ = optimizer.update(KEY, state, jnp.full(6, 3.5))
    expected = np.sort(np.r_[np.arange(1.0, 7.0)[:elites], np.full(6, 3.5)])[:6]
    np.testing.assert_array_equal(new.parent_value, expected)
    assert float(new.best_value) == 1.0


def test_de_crossover_and_bounds():
    members, mutants = jnp.zeros((4000, 5)), jnp.ones((4000, 5))
    for rate, share in [(0.0, 0.2), (0.5, 0.6), (1.0, 1.0)]:  # one coordinate always crosses
        crossed = np.asarray(cross(RANDOM, members, mutants, jnp.asarray(rate)))
        assert crossed.mean() == pytest.approx(share, abs=0.01)
        assert (crossed.sum(axis=1) >= 1).all()
    np.testing.assert_allclose(
        within(jnp.array([-0.5, 0.3, 1.5]), jnp.array([0.4, 0.4, 0.4])), [0.2, 0.3, 0.7]
    )


def test_de_replaces_only_what_is_not_better():
    optimizer = de(5, crossover_rate=1.0)
    state = optimizer.init(KEY, 2)
    first = state.position
    state, _ = optimizer.update(KEY, state, jnp.arange(5.0))
    trials = state.position
    state, _ = optimizer.update(KEY, state, jnp.array([-1.0, 2.0, 2.0, jnp.nan, 3.0]))
    expected = jnp.stack([trials[0], first[1], trials[2], first[3], trials[4]])
    np.testing.assert_array_equal(state.members, expected)


def test_shade_memory_by_hand():
    """Two successes with gains 1 and 3: Lehmer mean of F, weighted mean of CR, in the first slot."""
    optimizer = shade(8, num_memories=3)
    state = optimizer.init(KEY, 2)
    state, _ = optimizer.update(KEY, state, jnp.arange(8.0))
    weight, rate = state.trial_weight, state.trial_rate
    value = jnp.arange(8.0).at[2].add(-1.0).at[5].add(-3.0) + jnp.array([1, 1, 0, 1, 1, 0, 1, 1])
    new, _ = optimizer.update(KEY, state, value)
    w, f, cr = np.array([0.25, 0.75]), np.asarray(weight)[[2, 5]], np.asarray(rate)[[2, 5]]
    assert float(new.memory_weight[0]) == pytest.approx(np.sum(w * f**2) / np.sum(w * f))
    assert float(new.memory_rate[0]) == pytest.approx(np.sum(w * cr))
    np.testing.assert_array_equal(new.memory_weight[1:], 0.5)
    assert int(new.slot) == 1 and int(new.archived) == 2


def test_lshade_shrinks_and_keeps_the_best_alive():
    optimizer = lshade(12, 10)
    state = optimizer.init(KEY, 2)
    update = jax.jit(optimizer.update)
    for k in range(10):
        value = jnp.sum((state.position - 0.3) ** 2, axis=1)
        state, _ = update(jax.random.key(k), state, value)
        assert int(state.alive) == round(12 - 8 * (k + 1) / 10)
        assert float(state.member_value[0]) == float(state.best_value)
        assert bool((jnp.diff(state.member_value) >= 0).all())


@pytest.mark.parametrize("steps, first", [(50_000, 90), (5000, 90), (500, 28), (50, 10)])
def test_lshade_begins_a_short_run_with_fewer(steps, first):
    """90 members in 5-D for 10,000 evaluations a dimension, the root of the share of that else."""
    optimizer = lshade(num_steps=steps)
    state, update = optimizer.init(KEY, 5), jax.jit(optimizer.update)
    for k in range(-(-first // 10)):
        value = jnp.sum((state.position - 0.3) ** 2, axis=1)
        state, _ = update(jax.random.key(k), state, value)
    assert bool(state.born) and int(jnp.isfinite(state.member_value).sum()) == first
    assert int(state.alive) <= first
    unbound = for_run(lshade(), float(steps))
    assert unbound.crowd == optimizer.crowd and lshade(population=90).crowd is None


def test_a_generation_of_lshade_takes_several_steps():
    """20 members, 8 trials a step: three steps a generation while more than 16 live, then two."""
    optimizer = lshade(8, 12, population=20)
    state = optimizer.init(KEY, 2)
    update, alive, evaluated = jax.jit(optimizer.update), [], []
    for k in range(12):
        value = jnp.sum((state.position - 0.3) ** 2, axis=1)
        state, _ = update(jax.random.key(k), state, value)
        alive.append(int(state.alive))
        evaluated.append(int(jnp.isfinite(state.member_value).sum()))
        assert float(state.member_value[: alive[-1]].min()) == float(state.best_value)
        if int(state.first) == 0:  # a generation begins: the best come first
            assert bool((jnp.diff(state.member_value) >= 0).all())
    assert evaluated[:3] == [8, 16, 20]
    # 4 + 16 (1 - k / 12) after k updates, at the end of a generation only.
    assert alive == [20, 20, 16, 16, 13, 13, 11, 11, 8, 7, 5, 4]


def test_de_walks_down_a_linear_slope_in_twenty_dimensions():
    """With smaller and less varied steps the population collapses on the way."""
    slope = 10.0 ** jnp.linspace(0.0, 1.0, 20)
    space = Space.vector([-5.0] * 20, [5.0] * 20)
    keys = jax.random.split(KEY, 10)
    result = minimize_runs(lambda x, _: x @ slope, de(), space, keys, num_steps=400)
    np.testing.assert_allclose(result.value, -5.0 * float(slope.sum()), atol=1e-8)


@pytest.mark.parametrize("dims, members", [(2, 24), (5, 30), (20, 40)])
def test_de_has_as_many_members_as_it_needs(dims, members):
    """On an ellipsoid with 1,000 evaluations a dimension; fifty members are 1e6 times as far off."""
    scale = 10.0 ** (6.0 * jnp.linspace(0.0, 1.0, dims))
    space, keys = Space.vector([-5.0] * dims, [5.0] * dims), jax.random.split(KEY, 10)
    assert de().init(KEY, dims).position.shape == (members, dims)
    assert de(50).init(KEY, dims).position.shape == (50, dims)
    result = minimize_runs(
        lambda x, _: (x - 1.0) ** 2 @ scale, de(), space, keys, num_steps=1000 * dims // members
    )
    assert float(result.value.max()) < 1e-9


def test_de_begins_anew_when_it_has_collapsed():
    """Of 20 populations 18 rested in another of many valleys for most of a run."""
    space, keys = Space.vector([-5.0] * 3, [5.0] * 3), jax.random.split(KEY, 20)

    def rastrigin(x, _):
        x = x - 1.234
        return (10.0 * (1.0 - jnp.cos(2.0 * jnp.pi * x)) + x**2).sum(axis=-1) + 7.0

    result = minimize_runs(rastrigin, de(8), space, keys, num_steps=4000)
    np.testing.assert_allclose(result.value, 7.0, atol=1e-9)


def test_members_that_differ_are_kept():
    """Alike in value on a plateau, or apart by what a value tells: neither has collapsed."""
    optimizer = de(6)
    state, _ = optimizer.update(KEY, optimizer.init(KEY, 2), jnp.ones(6))
    assert bool((state.member_value == 1.0).all())  # spread over a plateau
    near = 0.5 + 1e-7 * state.members
    told = state._replace(members=near, position=near, member_value=jnp.full(6, jnp.inf))
    kept, _ = optimizer.update(KEY, told, jnp.arange(6.0))
    assert kept.member_value.tolist() == list(range(6)) and kept.best_value == 0.0
    fresh, info = optimizer.update(KEY, told, jnp.full(6, 3.0))
    assert bool(jnp.isinf(fresh.member_value).all()) and float(fresh.position.std()) > 0.1
    assert float(fresh.best_value) == 1.0 and not info.improved


def test_differential_evolution_finds_valleys_that_lie_along_the_axes():
    """Ten coordinates with a dozen valleys each: all eight runs, one where all populations are alike."""

    def rastrigin(x, _):
        return jnp.sum(10.0 * (1.0 - jnp.cos(2.0 * jnp.pi * x)) + x**2, axis=-1)

    space = Space.vector([-5.37] * 10, [4.63] * 10)
    keys = jax.random.split(KEY, 8)
    runs = minimize_runs(rastrigin, de(), space, keys, num_steps=1500)
    assert (np.asarray(runs.value) < 1e-6).sum() >= 7
    assert int(runs.state.restarts.min()) > 0
    once = minimize_runs(rastrigin, de(renew=False), space, keys, num_steps=1500)
    assert int(once.state.restarts.max()) == 0


def test_cma_rates_of_the_tutorial():
    rates = Rates.of(10, 10)
    assert rates.weights[:5].sum() == pytest.approx(1.0) and len(rates.weights) == 10
    assert (rates.weights[5:] < 0.0).all()
    # No sample can take more from C than the decay leaves: C stays positive definite.
    kept = 1.0 - rates.c_1 - rates.c_mu * rates.weights.sum()
    assert kept + rates.c_mu * 10 * rates.weights[5:].sum() >= 0.0
    assert rates.mass == pytest.approx(3.167, abs=1e-3)
    assert rates.length == pytest.approx(3.0847, abs=1e-3)  # E|N(0, I)| for d = 10
    assert 0 < rates.c_1 < rates.c_mu < 1


def test_cma_mean_and_covariance_follow_the_selected():
    optimizer = cma_es(8, sigma=0.1)
    state = optimizer.init(KEY, 3)
    value = jnp.arange(8.0)
    new, _ = optimizer.update(KEY, state, value)
    weights = Rates.of(8, 3).weights
    np.testing.assert_allclose(new.search.mean, weights[:4] @ state.sample[:4], atol=1e-12)
    np.testing.assert_allclose(new.search.covariance, new.search.covariance.T, atol=1e-12)
    decomposed = new.search.basis @ jnp.diag(new.search.spread**2) @ new.search.basis.T
    np.testing.assert_allclose(decomposed, new.search.covariance, atol=1e-12)


@pytest.mark.parametrize("n", [9, FEW + 2])
def test_cma_does_not_depend_on_the_order_of_its_candidates(n):
    """Few candidates get their weights where they are, many are brought in order: both are the same step."""
    optimizer = cma_es(n, sigma=0.1)
    state = optimizer.init(KEY, 3)
    value = jnp.sum((state.position - 0.2) ** 2, axis=1)
    rising = jnp.argsort(value)
    ordered = state._replace(position=state.position[rising], sample=state.sample[rising])
    one, _ = optimizer.update(KEY, state, value)
    other, _ = optimizer.update(KEY, ordered, value[rising])
    for a, b in zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-12)


def test_cma_worse_half_shrinks_the_covariance():
    """First step: C = I and p_c is the move of the mean, so C' follows from the samples alone."""
    optimizer = cma_es(8, sigma=0.1)
    state = optimizer.init(KEY, 3)
    new, _ = optimizer.update(KEY, state, jnp.arange(8.0))
    rates = Rates.of(8, 3)
    expected = np.eye(3) * (1.0 - rates.c_1 - rates.c_mu * rates.weights.sum())
    for weight, sample in zip(rates.weights, np.asarray(state.sample), strict=True):
        y = (sample - np.asarray(state.search.mean)) / 0.1
        y *= np.sqrt(3.0) / np.linalg.norm(y) if weight < 0.0 else 1.0
        expected += rates.c_mu * weight * np.outer(y, y)
    path = np.asarray(new.search.path_covariance)
    expected += rates.c_1 * np.outer(path, path)
    np.testing.assert_allclose(new.search.covariance, expected, atol=1e-12)


def emotional_step(variant, emotion, numbers=0.5):
    """Velocity of particle 1 at x with r = 1/2 everywhere, in one dimension."""
    from jaxswarm.swarm.optimizers.sepso import emotional

    class Half:
        def uniform(self, stream, shape, dtype):
            return jnp.full(shape, numbers, dtype)

    position = jnp.array([[0.2], [0.4], [0.5], [0.9], [1.0]])
    swarm = Swarm(
        position=position,
        velocity=jnp.full((5, 1), 0.1),
        memory_position=position + 0.1,
        attractor=jnp.full((5, 1), 0.2),
        value=jnp.array([1.0, 2.0, 3.0, 4.0, 5.0]),  # the worst three: 0.5, 0.9, 1.0
        improved=jnp.zeros(5, bool),
        memory_value=jnp.ones(5),
    )
    hyper = {"inertia": 0.5, "cognitive": 2.0, "social": 2.0, "emotion": jnp.full(5, emotion)}
    return float(emotional(variant, 0.1)(Half(), swarm, hyper)[1, 0])


@pytest.mark.parametrize(
    "variant, emotion, expected",
    [
        # w v = 0.05; own 2 (1/2) 0.1 = 0.1; social 2 (1/2)(-0.2) = -0.2; R = 2.4 - 1.2 = 1.2,
        # away -0.1 (1/2) 1.2 / 3 = -0.02
        ("R1", 0.2, 0.05 - 0.2),
        ("R1", 0.5, 0.05 + 0.1 - 0.2 - 0.02),
        ("R1", 0.6, 0.05 + 0.1 - 0.02),
        ("R2", 0.25, 0.05 + 0.25 * 0.1 - 0.75 * 0.2 - 0.02),
        # R3: k3 (1/2) 0.1 = 0.0015, k2 (1/2)(-0.2) = -0.002, k1 (1/2) 1.2 = 0.006; no velocity
        ("R3", 0.2, -0.002),
        ("R3", 0.5, 0.0015 - 0.002 - 0.006),
        ("R3", 0.9, 0.0015 - 0.006),
    ],
)
def test_sepso_behaviors_by_hand(variant, emotion, expected):
    assert emotional_step(variant, emotion) == pytest.approx(expected, abs=1e-9)


def test_emotion_rises_with_success_and_decays():
    optimizer = sepso(5, 10)
    state = optimizer.init(KEY, 2)
    state, _ = optimizer.update(KEY, state, jnp.arange(5.0))
    np.testing.assert_array_equal(state.control.emotion, 1.0)
    for k in range(3):
        state, info = optimizer.update(KEY, state, jnp.array([-1.0 - k, 9, 9, 9, 9]))
    np.testing.assert_allclose(info.hyper["emotion"], [1.0, 0.85, 0.85, 0.85, 0.85])
    with pytest.raises(InputError, match="num_particles=3"):
        sepso(3)


@pytest.mark.parametrize("steps, gap", [(16, 0), (499, 0), (1000, 2), (3500, 7), (10**5, 7)])
def test_clpso_keeps_exemplars_longer_in_longer_runs(steps, gap):
    assert float(clpso(10, steps).control.refresh) == gap
    assert float(clpso(10, steps, refresh=4).control.refresh) == 4


def test_clpso_exemplars():
    optimizer = clpso(10, 100, refresh=3)
    state = optimizer.init(KEY, 6)
    state, info = optimizer.update(KEY, state, jnp.arange(10.0))
    first = np.asarray(info.hyper["exemplar"])
    own = np.arange(10)[:, None]
    assert (first != own).any(axis=1).all()  # everybody learns something from another
    learned = (first != own).mean(axis=1)
    assert learned[-1] > 0.3 and learned[0] < 0.4  # Pc from 0.05 to 0.5
    for k in range(3):
        value = jnp.full(10, 99.0).at[0].set(-1.0 - k)  # only particle 0 improves
        state, info = optimizer.update(jax.random.key(k), state, value)
        exemplar = np.asarray(info.hyper["exemplar"])
        changed = (exemplar != first).any(axis=1)
        assert not changed[0] and (k < 2) == (not changed[1:].any())


@pytest.mark.parametrize(
    "build, message",
    [
        (lambda: ga(3), "num_particles=3"),
        (lambda: ga(6, num_elites=9), "num_elites=9"),
        (lambda: de(3), "num_particles=3"),
        (lambda: de(strategy="best/2"), "strategy='best/2'"),
        (lambda: de(crossover_rate=1.5), "crossover_rate=1.5"),
        (lambda: shade(5), "num_particles=5"),
        (lambda: cma_es(3), "num_particles=3"),
        (lambda: cma_es(sigma=0.0), "sigma=0.0"),
        (lambda: clpso(2), "num_particles=2"),
        (lambda: operators.sbx(rate=2.0), "rate=2.0"),
    ],
)
def test_bad_arguments_are_named(build, message):
    with pytest.raises(InputError, match=message):
        build()
