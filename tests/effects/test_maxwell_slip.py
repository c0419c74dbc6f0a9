"""Elements that stick and slip each by itself: how far they are the loops of a bristle, and where not."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.effects import get_law, make_sample
from jaxswarm.effects.series import law_columns
from jaxswarm.identify.synthetic import fourier_motion


def slipping(q, breaks):
    """Elements of equal stiffness that let go at their own bends, exactly, (T,)."""
    bend = np.zeros(len(breaks))
    torque = np.zeros_like(q)
    for k, step in enumerate(np.diff(q)):
        bend = np.clip(bend + step, -breaks, breaks)
        torque[k + 1] = bend.sum()
    return torque / breaks.sum()


def left(wide, breaks):
    """Part that the best bristle leaves of what dry and viscous friction leave of the elements."""
    t, q, dq, _ = fourier_motion(3, np.random.default_rng(0), 20.0, 250.0)
    q, dq = q[:, 1], dq[:, 1]
    series = make_sample(t=jnp.asarray(t), q=jnp.asarray(q), dq=jnp.asarray(dq))
    plain = np.stack([np.tanh(dq / 0.01), dq, np.ones_like(q)], axis=1)
    basis = np.linalg.qr(plain)[0]
    free = slipping(q, wide * np.asarray(breaks))
    free -= basis @ (basis.T @ free)
    parts = []
    for x0 in wide * np.linspace(0.5, 1.5, 11):
        column = np.asarray(law_columns(get_law("hysteresis"), {"x0": x0}, series))[:, 0]
        column = column - basis @ (basis.T @ column)
        rest = free - column * (column @ free) / (column @ column)
        parts.append(np.linalg.norm(rest) / np.linalg.norm(free))
    return min(parts)


SPREAD = {"evenly": np.arange(1, 7) / 6.0, "by halves": 0.5 ** np.arange(4)}


@pytest.mark.parametrize("spread", SPREAD)
def test_small_loops_are_those_of_a_bristle(spread):
    assert left(0.06, SPREAD[spread]) < 0.12


def test_wide_loops_are_not():
    assert left(0.2, SPREAD["evenly"]) > 0.13
