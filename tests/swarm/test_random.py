"""Evidence that the hashed numbers are good enough: every p-value is that of a fixed key."""

import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy import special, stats

from jaxswarm.errors import InputError
from jaxswarm.swarm.quantile import quantile
from jaxswarm.swarm.random import Random, fold, mix

KEYS = [jax.random.key(seed) for seed in (0, 1, 2**31)]
LANES = 2**18


def numbers(key, shape=(LANES,), dtype=jnp.float64, stream="a"):
    return np.asarray(Random(key).uniform(stream, shape, dtype), np.float64)


def correlation_score(a, b):
    """Correlation in standard deviations of its distribution under independence."""
    return np.corrcoef(a.ravel(), b.ravel())[0, 1] * np.sqrt(a.size)


@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
@pytest.mark.parametrize("key", KEYS, ids=str)
def test_uniform_in_the_open_interval(key, dtype):
    u = numbers(key, dtype=dtype)
    assert u.min() > 0.0 and u.max() < 1.0
    assert stats.kstest(u, "uniform").pvalue > 1e-3
    counts = np.bincount((u * 256).astype(int), minlength=256)
    assert stats.chisquare(counts).pvalue > 1e-3


def test_extreme_bits_stay_inside():
    from jaxswarm.swarm.random import _to_unit

    bits = jnp.array([0, 2**31 - 1, 2**31, 2**32 - 1], jnp.uint32)
    for dtype in (jnp.float32, jnp.float64):
        u = _to_unit(bits, jnp.dtype(dtype))
        assert u.dtype == dtype and bool(((u > 0.0) & (u < 1.0)).all())
    doubles = sorted(np.asarray(_to_unit(bits, jnp.dtype(jnp.float64))))
    assert doubles[0] == 2.0**-33 and doubles[-1] == 1.0 - 2.0**-33


@pytest.mark.parametrize("key", KEYS, ids=str)
@pytest.mark.parametrize("lag", [1, 2, 13, 50, 64, 1024])
def test_serial_correlation_across_lanes(key, lag):
    u = numbers(key)
    assert abs(correlation_score(u[:-lag], u[lag:])) < 4.0


@pytest.mark.parametrize("key", KEYS, ids=str)
def test_neighbors_fill_the_square(key):
    """Pairs of neighbors, and of the same lane in two streams: chi-square on a 32 x 32 grid."""
    u, v = numbers(key), numbers(key, stream="b")
    for a, b in ((u[::2], u[1::2]), (u, v)):
        cells = (a * 32).astype(int) * 32 + (b * 32).astype(int)
        assert stats.chisquare(np.bincount(cells, minlength=1024)).pvalue > 1e-3


@pytest.mark.parametrize("key", KEYS, ids=str)
@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
def test_numbers_that_share_a_hash_are_independent(key, dtype):
    """Pairs in one place, and the second number beside that of the next lane."""
    drawn = [np.asarray(u, float) for u in Random(key).uniforms("pair", 3, (LANES,), dtype)]
    for a, b in itertools.combinations(drawn, 2):
        for lag in (0, 1, 13, 64):
            assert abs(correlation_score(a[: LANES - lag], b[lag:])) < 4.0
            cells = (a[: LANES - lag] * 64).astype(int) * 64 + (b[lag:] * 64).astype(int)
            assert stats.chisquare(np.bincount(cells, minlength=4096)).pvalue > 1e-3
        assert stats.kstest((a + b) % 1.0, "uniform").pvalue > 1e-3
        assert stats.kstest((a - b) % 1.0, "uniform").pvalue > 1e-3
        assert abs(correlation_score((a - 0.5) ** 2, (b - 0.5) ** 2)) < 4.0
    assert stats.kstest(drawn[1], "uniform").pvalue > 1e-3


def test_fine_digits_of_a_pair_are_independent():
    """Digits below 2^-8 of both numbers: a shared hash must not leave a lattice."""
    a, b = Random(KEYS[2]).uniforms("pair", 2, (LANES,), jnp.float64)
    for scale in (2.0**8, 2.0**14):
        x, y = np.asarray(a * scale) % 1.0, np.asarray(b * scale) % 1.0
        cells = (x * 32).astype(int) * 32 + (y * 32).astype(int)
        assert stats.chisquare(np.bincount(cells, minlength=1024)).pvalue > 1e-3


def test_steps_keys_and_streams_are_uncorrelated():
    shape = (50, 13)
    steps = [numbers(fold(KEYS[0], count), shape) for count in range(40)]
    keys = [numbers(jax.random.key(seed), shape) for seed in range(40)]
    runs = [numbers(key, shape) for key in jax.random.split(KEYS[0], 40)]
    streams = [numbers(KEYS[0], shape, stream=str(name)) for name in range(40)]
    for family in (steps, keys, runs, streams):
        scores = [correlation_score(a, b) for a, b in itertools.combinations(family, 2)]
        assert np.abs(scores).max() < 4.5  # 780 pairs
        assert stats.kstest(scores, "norm").pvalue > 1e-3


def test_one_lane_over_many_steps_and_keys():
    """What a single particle sees in one coordinate: a sequence over the steps, or over the runs."""
    over_steps = jax.vmap(lambda c: Random(fold(KEYS[0], c)).uniform("a", (3,)))(jnp.arange(2**16))
    keys = jax.vmap(jax.random.key)(jnp.arange(2**16))
    over_keys = jax.vmap(lambda k: Random(k).uniform("a", (3,)))(keys)
    for table in (np.asarray(over_steps), np.asarray(over_keys)):
        for lane in range(3):
            u = table[:, lane]
            assert stats.kstest(u, "uniform").pvalue > 1e-3
            for lag in (1, 2, 7):
                assert abs(correlation_score(u[:-lag], u[lag:])) < 4.0
        cells = (table[:, 0] * 32).astype(int) * 32 + (table[:, 1] * 32).astype(int)
        assert stats.chisquare(np.bincount(cells, minlength=1024)).pvalue > 1e-3


def test_every_bit_is_fair_and_independent_of_its_neighbors():
    bits = np.asarray(Random(KEYS[0]).bits("a", (LANES,)))
    table = (bits[:, None] >> np.arange(32, dtype=np.uint32)) & 1
    scores = (table.mean(axis=0) - 0.5) * 2.0 * np.sqrt(LANES)
    assert np.abs(scores).max() < 4.0
    flips = (table[1:] ^ table[:-1]).mean(axis=0)
    assert (np.abs(flips - 0.5) * 2.0 * np.sqrt(LANES)).max() < 4.0


def test_gaps_follow_the_geometric_law():
    u = numbers(KEYS[1])
    gaps = np.diff(np.flatnonzero(u < 0.1)) - 1
    expected = 0.1 * 0.9 ** np.arange(40) * gaps.size
    counts = np.bincount(np.minimum(gaps, 40), minlength=41)
    expected = np.append(expected, gaps.size - expected.sum())
    assert stats.chisquare(counts, expected).pvalue > 1e-3


def test_normal_numbers():
    random = Random(KEYS[0])
    for dtype in (jnp.float32, jnp.float64):
        z = np.asarray(random.normal("z", (LANES,), dtype), float)
        assert stats.kstest(z, "norm").pvalue > 1e-3
        assert abs(stats.kurtosis(z)) < 0.05 and np.abs(z).max() > 4.0


@pytest.mark.parametrize("dtype, tolerance", [("float32", 6e-7), ("float64", 2e-15)])
def test_quantiles_are_those_of_scipy(dtype, tolerance):
    """From the smallest to the largest number that a stream holds, and on either side of a seam."""
    tail = 2.0 ** -np.arange(2.0, 24.0 if dtype == "float32" else 33.0, 0.25)
    u = np.concatenate([tail, np.linspace(0.07, 0.93, 2001), 1.0 - tail]).astype(dtype)
    expected = special.ndtri(u.astype(float))
    z = np.asarray(quantile(jnp.asarray(u)))
    assert z.dtype == dtype
    np.testing.assert_allclose(z, expected, rtol=tolerance, atol=tolerance)
    assert (np.diff(np.asarray(quantile(jnp.asarray(np.sort(u))))) >= 0.0).all()


def test_others_are_distinct_and_uniform():
    draw = jax.jit(jax.vmap(lambda c: Random(fold(KEYS[0], c)).others("o", 6, 3)))
    others = np.asarray(draw(jnp.arange(5000)))
    assert (np.diff(np.sort(others, axis=2), axis=2) > 0).all()
    assert (others != np.arange(6)[None, :, None]).all()
    for j in range(3):
        counts = np.bincount(others[:, 2, j], minlength=6)[[0, 1, 3, 4, 5]]
        assert stats.chisquare(counts).pvalue > 1e-3


def test_permutation_and_integers():
    random = Random(KEYS[0])
    assert sorted(np.asarray(random.permutation("p", 20))) == list(range(20))
    drawn = np.asarray(random.integers("i", (60000,), 6))
    assert stats.chisquare(np.bincount(drawn, minlength=6)).pvalue > 1e-3


def test_mix_is_one_to_one_and_avalanches():
    words = np.random.default_rng(0).integers(0, 2**32, 4096, np.uint32)
    base = np.asarray(mix(jnp.asarray(words)))
    assert np.unique(base).size == np.unique(words).size
    for bit in range(32):
        flipped = np.asarray(mix(jnp.asarray(words ^ np.uint32(1 << bit))))
        changed = ((base ^ flipped)[:, None] >> np.arange(32, dtype=np.uint32)) & 1
        assert abs(changed.mean() - 0.5) < 0.02


def test_raw_and_typed_keys_and_vmap_agree():
    typed, raw = jax.random.key(7), jax.random.PRNGKey(7)
    np.testing.assert_array_equal(numbers(typed, (5,)), numbers(raw, (5,)))
    np.testing.assert_array_equal(jax.random.key_data(fold(typed, 3)), fold(raw, 3))
    keys = jax.random.split(typed, 3)
    mapped = jax.vmap(lambda k: Random(k).uniform("a", (2, 3)))(keys)
    for i in range(3):
        np.testing.assert_array_equal(mapped[i], numbers(keys[i], (2, 3)))


def test_threefry_is_the_option():
    key = jax.random.key(0)
    u = np.asarray(Random(key, "threefry").uniform("a", (1000,)))
    assert stats.kstest(u, "uniform").pvalue > 1e-3
    assert not np.allclose(u, numbers(key, (1000,)))


def test_bad_keys_and_sources_are_named():
    from jaxswarm.swarm import pso

    with pytest.raises(InputError, match="key=0 is no JAX key"):
        Random(0).uniform("a")
    with pytest.raises(InputError, match="use jax.vmap"):
        Random(jax.random.split(KEYS[0], 3)).uniform("a")
    with pytest.raises(InputError, match="threefly.*threefry"):
        pso(random="threefly")
