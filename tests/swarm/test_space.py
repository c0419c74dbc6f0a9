"""Spaces: decode and encode, names, dtypes, and every way to get them wrong."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jaxswarm.errors import InputError
from jaxswarm.swarm import Bound, Choice, Space, minimize, pso


def test_nested_and_array_bounds():
    space = Space(b=dict(k=Bound([1.0, 10.0], 100.0, "log", "N/m"), d=(0.0, 2.0)), a=(-1.0, 1.0))
    assert space.names == ("a", "b.d", "b.k[0]", "b.k[1]")
    assert space.log == (False, False, True, True)
    assert space.units == ("", "", "N/m", "N/m")
    params = space.decode(jnp.array([0.5, 0.25, 0.5, 1.0]))
    assert float(params["a"]) == 0.0 and float(params["b"]["d"]) == 0.5
    np.testing.assert_allclose(params["b"]["k"], [10.0, 100.0])


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(0.0, 1.0), min_size=3, max_size=3))
def test_encode_inverts_decode(position):
    space = Space(x=Bound(1e-6, 1e3, "log"), y=(-5.0, 7.0), z=(0.0, 1e-9))
    position = jnp.array(position)
    params = space.decode(position)
    np.testing.assert_allclose(space.encode(params), position, atol=1e-9)
    flat = jnp.stack([params["x"], params["y"], params["z"]])
    assert bool(((flat >= space.lower) & (flat <= space.upper)).all())


def test_vector_and_arrays():
    space = Space.vector([0.0, -1.0], [2.0, 1.0])
    np.testing.assert_allclose(jax.vmap(space.decode)(jnp.eye(2)), [[2.0, -1.0], [0.0, 1.0]])
    named = Space.from_arrays(["z", "a"], [0.0, 10.0], [1.0, 20.0])
    assert named.names == ("a", "z") and list(named.lower) == [10.0, 0.0]


def test_whole_numbers_are_equally_likely():
    space = Space(n=Bound(2, 5, "integer"), kind=Choice(("a", "b", "c")))
    position = jnp.stack([jnp.linspace(0.0, 1.0, 1201)] * 2, axis=1)
    params = jax.vmap(space.decode)(position)
    assert params["n"].dtype == params["kind"].dtype == jnp.int32
    values, counts = np.unique(params["n"], return_counts=True)
    assert values.tolist() == [2, 3, 4, 5] and np.ptp(counts) <= 1
    assert np.unique(params["kind"]).tolist() == [0, 1, 2]
    for n in (2, 3, 4, 5):
        for kind in ("a", "b", "c"):
            point = space.encode({"n": n, "kind": kind})
            assert space.labeled(space.decode(point)) == {"kind": kind, "n": n}
            assert bool(((point > 0.0) & (point < 1.0)).all())


def test_an_unbounded_scale_has_its_bounds_at_the_quarters():
    space = Space(x=Bound(-2.0, 4.0, "unbounded"), y=(0.0, 1.0))
    for u, x in ((0.25, -2.0), (0.5, 1.0), (0.75, 4.0), (0.9, 1.0 + 3.0 * np.tan(0.4 * np.pi))):
        params = space.decode(jnp.array([u, 0.3]))
        assert float(params["x"]) == pytest.approx(x)
        np.testing.assert_allclose(space.encode(params), [u, 0.3])
    assert np.isfinite(space.decode(jnp.array([0.0, 1.0]))["x"])
    far = minimize(
        lambda p, _: (p["x"] - 500.0) ** 2, pso(20), space, jax.random.key(0), num_steps=150
    )
    assert float(far.params["x"]) == pytest.approx(500.0, rel=1e-4)


def test_lists_and_tuples():
    space = Space(gains=[(0.0, 1.0), Bound(1.0, 100.0, "log")], pair=((0.0, 2.0), [(1.0, 3.0)]))
    assert space.names == ("gains[0]", "gains[1]", "pair[0]", "pair[1][0]")
    params = space.decode(jnp.full(4, 0.5))
    wanted = {"gains": [0.5, 10.0], "pair": (1.0, [2.0])}
    assert jax.tree.structure(params) == jax.tree.structure(wanted)
    np.testing.assert_allclose(jax.tree.leaves(params), jax.tree.leaves(wanted))
    np.testing.assert_allclose(space.encode(params), 0.5)
    arrays = Space(x=([0.0, 1.0], [1.0, 2.0]), y=Bound((0.0, 1.0), (1.0, 2.0)))
    assert arrays.names == ("x[0]", "x[1]", "y[0]", "y[1]")


def test_mixed_scales_leave_slopes_finite():
    space = Space(a=Bound(0.1, 10.0, "log"), b=(-1.0, 1.0), c=Bound(-1.0, 1.0, "unbounded"))
    slope = jax.jacfwd(lambda u: jnp.stack(jax.tree.leaves(space.decode(u))))(jnp.full(3, 0.5))
    np.testing.assert_allclose(slope, np.diag([np.log(100.0), 2.0, np.pi]), rtol=1e-12)


def test_dtype_follows_the_bounds():
    single = Space.vector(np.zeros(2, np.float32), np.ones(2, np.float32))
    assert single.dtype == jnp.float32 and Space.vector([0], [1]).dtype == jnp.float64
    assert single.decode(jnp.zeros(2, jnp.float32)).dtype == jnp.float32


def test_bounds_are_leaves():
    space = Space.vector([0.0], [1.0])
    assert len(jax.tree.leaves(space)) == 2
    scaled = jax.tree.map(lambda leaf: 2.0 * leaf, space)
    assert float(scaled.decode(jnp.array([0.5]))[0]) == 1.0


@pytest.mark.parametrize(
    "build, message",
    [
        (lambda: Space(), "no parameters"),
        (lambda: Space(x=(1.0, 1.0)), "x: lower=1.0 must be below upper=1.0"),
        (lambda: Space(x=(0.0, np.inf)), "x: bounds 0.0 and inf must be finite"),
        (lambda: Space(x=(np.nan, 1.0)), "must be finite"),
        (lambda: Space(x=Bound(0.0, 1.0, "log")), "log scale needs lower > 0"),
        (lambda: Space(x=Bound(0.0, 1.0, "lin")), "scale=.lin.*linear"),
        (lambda: Space(x=Bound(0.5, 2.0, "integer")), "x: an integer scale needs whole bounds"),
        (lambda: Space(x=Choice(("a",))), "must be two or more"),
        (lambda: Space(x=[]), "no parameters"),
        (lambda: Space(x=("a", 1.0)), "x: 'a' is no number"),
        (lambda: Space(k=Choice("ab")).encode({"k": "c"}), "k='c' is none of 'a', 'b'"),
        (lambda: Space(x=3.0), "give a Bound, a Choice or a pair"),
        (lambda: Space.vector([0.0, 1.0], [1.0, 0.5]), r"x\[1\]: lower"),
        (lambda: Space.from_arrays(["a"], [0.0, 0.0], [1.0, 1.0]), "names has 1 entries"),
        (lambda: Space(x=(0.0, 1.0)).encode({"x": jnp.ones(3)}), "params hold 3 numbers"),
    ],
)
def test_bad_bounds_are_named(build, message):
    with pytest.raises(InputError, match=message):
        build()
