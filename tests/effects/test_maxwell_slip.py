"""Elements that stick and slip each by itself: against an exact count, a stiff solver, and one bristle."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jaxswarm.effects import get_law, make_sample
from jaxswarm.effects.series import law_columns, law_torque
from jaxswarm.identify.synthetic import fourier_motion
from jaxswarm.robot import rx60
from jaxswarm.simulate import Acting, make_plant, rest, simulate

LAW = get_law("maxwell_slip")
VALUES = {"fc1": 5.0, "fc2": 3.0, "x1": 0.12, "part": 0.25}


def slipping(q, ways):
    """Elements that let go at their own ways, exactly, (T, k)."""
    bend, along = np.zeros(len(ways)), np.zeros((len(q), len(ways)))
    for k, step in enumerate(np.diff(q)):
        along[k + 1] = bend = np.clip(bend + step / np.asarray(ways), -1.0, 1.0)
    return along


def motion():
    t, q, dq, _ = fourier_motion(3, np.random.default_rng(0), 20.0, 250.0)
    return t, q[:, 1], dq[:, 1]


def series_of(t, q, dq):
    return make_sample(t=jnp.asarray(t), q=jnp.asarray(q), dq=jnp.asarray(dq))


def test_its_torque_is_that_of_an_exact_count():
    t, q, dq = motion()
    wanted = slipping(q, [0.12, 0.03]) @ [5.0, 3.0]
    found = law_torque(LAW, VALUES, series_of(t, q, dq))
    # The way of a step is its mean velocity times its length: an error of the third order, at every reversal.
    np.testing.assert_allclose(found, wanted, atol=2e-3)


def test_small_loops_close_where_they_began():
    turns = np.array([0.0, 0.3, 0.2, 0.3, 0.2, 0.3, 0.5])
    t = np.linspace(0.0, 6.0, 6001)
    q = np.interp(t, np.arange(7.0), turns)
    series = series_of(t, q, np.gradient(q, t))
    found = np.asarray(law_torque(LAW, VALUES, series))
    assert found[3000] == pytest.approx(found[5000], abs=1e-2)
    assert found[2000] == pytest.approx(found[4000], abs=1e-2)
    assert found[-1] == pytest.approx(8.0)


def test_every_log_begins_with_elements_at_rest():
    t, q, dq = motion()
    one = np.asarray(law_torque(LAW, VALUES, series_of(t, q, dq)))
    both = series_of(*(np.concatenate([x, x]) for x in (t, q, dq)))
    found = np.asarray(law_torque(LAW, VALUES, both))
    np.testing.assert_allclose(found, np.concatenate([one, one]), rtol=0, atol=1e-12)


@settings(max_examples=25, deadline=None)
@given(level=st.floats(0.1, 50.0), way=st.floats(0.02, 0.6), part=st.floats(0.02, 0.8))
def test_an_element_that_is_alone_may_go_by_the_name_of_either(level, way, part):
    second = {"fc1": 0.0, "fc2": level, "x1": way, "part": part}
    first = LAW.exchanged(second)
    assert first["fc1"] == level and first["fc2"] == 0.0
    assert first["x1"] == pytest.approx(way * part)
    series = series_of(*motion())
    one, two = (np.asarray(law_torque(LAW, values, series)) for values in (first, second))
    np.testing.assert_allclose(one, two, rtol=0, atol=1e-9 * level)


def left(column_of, ways, levels, tried):
    """Part that a law leaves of what dry and viscous friction leave of elements."""
    t, q, dq = motion()
    plain = np.stack([np.tanh(dq / 0.01), dq, np.ones_like(q)], axis=1)
    basis = np.linalg.qr(plain)[0]
    free = slipping(q, ways) @ levels
    free -= basis @ (basis.T @ free)
    parts = []
    for values in tried:
        columns = np.asarray(law_columns(get_law(column_of), values, series_of(t, q, dq)))
        columns = columns - basis @ (basis.T @ columns)
        rest_of = free - columns @ np.linalg.lstsq(columns, free)[0]
        parts.append(np.linalg.norm(rest_of) / np.linalg.norm(free))
    return min(parts)


@pytest.mark.parametrize("count", [4, 6])
def test_two_elements_stand_for_many_better_than_a_bristle(count):
    ways, levels = 0.2 * np.arange(1, count + 1) / count, np.ones(count)
    bristle = left("hysteresis", ways, levels, [{"x0": x} for x in np.linspace(0.02, 0.3, 15)])
    pairs = [{"x1": x, "part": p} for x in (0.12, 0.15, 0.18, 0.2) for p in (0.3, 0.4, 0.5)]
    assert left("maxwell_slip", ways, levels, pairs) < 0.6 * bristle


def test_a_simulated_joint_carries_them_both():
    plant = make_plant(rx60(), [Acting(LAW.name, 0, values=VALUES), Acting("hysteresis", 1)])
    start = rest(plant, jnp.zeros(3))
    assert start.memory.shape == (3,)
    push = 12.0 * np.sin(2.0 * np.pi * np.arange(400) * 2e-3)[:, None] * np.array([1.0, 0.0, 0.0])
    run = jax.jit(lambda tau: simulate(plant, start, tau, dt=2e-3))(jnp.asarray(push))
    wanted = slipping(np.asarray(run.q)[:, 0], [0.12, 0.03])
    last = np.asarray(run.state.memory)[:2]
    # The trajectory ends where its last step begins.
    assert np.abs(wanted).max() == 1.0
    np.testing.assert_allclose(last, wanted[-1], atol=2e-2)
