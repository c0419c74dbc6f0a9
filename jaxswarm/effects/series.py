r"""A law along a whole log: its torque and its columns, sample by sample or with its memory.

A memoryless law is vmapped over samples. A law with memory integrates its state by exponential Euler
(Rosenbrock) steps, :math:`z_{k+1} = z_k + h\,\varphi_1(h a)\,\dot z(z_k)` with :math:`a` the
derivative of the rate, :math:`\varphi_1(x) = (e^x - 1)/x`: exact for a rate linear in the state over
a step of constant motion, which a Dahl bristle is, and stable for any step (Hochbruck, Ostermann,
"Exponential integrators", Acta Numerica 2010, eq. 2.17).
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.sample import Sample


def remembered(law: TorqueLaw, one: Any) -> Any:
    """``one`` as the memory of a law: itself, or a tuple of it for every memory that the law has."""
    return one if law.memories == 1 else (one,) * law.memories


def grown(law: TorqueLaw, rate: Callable[[Any], Any], z: Any, h: Any) -> Any:
    """A memory, or a tuple of them, a time h later: each by its own rate's derivative, no further than it goes.

    Args:
        law: Whose memory it is.
        rate: ``rate(z)``, at the mean motion of the step.
        z: At the begin of the step.
        h: Its length [s].
    """
    speed, slope = jax.jvp(rate, (z,), (jax.tree.map(jnp.ones_like, z),))

    def ahead(z, speed, slope):
        x = h * slope
        small = jnp.abs(x) < 1e-8
        safe = jnp.where(small, 1.0, x)
        moved = z + h * jnp.where(small, 1.0, jnp.expm1(safe) / safe) * speed
        return jnp.clip(moved, -law.most, law.most) if np.isfinite(law.most) else moved

    return jax.tree.map(ahead, z, speed, slope)


def states(law: TorqueLaw, parameters: dict, series: Sample) -> Any:
    """Integrate the state of ``law`` along a series from its start; where time falls another log begins.

    Args:
        law: A law with memory.
        parameters: Its parameters.
        series: Sample of (T,) arrays in order of time.

    Returns:
        The state at every sample, shape (T,); a tuple of them for a law with several memories.
    """

    def begin(sample):
        if law.start is not None:
            return jnp.asarray(law.start(parameters, sample), series.q.dtype)
        return remembered(law, jnp.zeros((), series.q.dtype))

    def step(z, pair):
        now, following = pair
        h = following.t - now.t
        # Midpoint motion: the state sees the mean velocity of the step.
        middle = jax.tree.map(lambda a, b: 0.5 * (a + b), now, following)
        later = grown(law, lambda x: law.rate(parameters, middle._replace(state=x)), z, h)
        z = jax.tree.map(lambda new, old: jnp.where(h < 0, new, old), begin(following), later)
        return z, z

    now = jax.tree.map(lambda x: x[:-1], series)
    following = jax.tree.map(lambda x: x[1:], series)
    start = begin(jax.tree.map(lambda x: x[0], series))
    _, rest = jax.lax.scan(step, start, (now, following))
    return jax.tree.map(lambda one, more: jnp.concatenate([one[None], more]), start, rest)


def law_torque(law: TorqueLaw, parameters: dict, series: Sample) -> jax.Array:
    """Torque of ``law`` along a series of (T,) arrays, shape (T,).

    >>> from jaxswarm.effects import get_law, make_sample
    >>> law_torque(get_law("viscous_friction"), {"b": 2.0}, make_sample(dq=jnp.array([1.0, 3.0])))
    Array([2., 6.], dtype=float64)
    """
    if law.rate is not None:
        series = series._replace(state=states(law, parameters, series))
    assert law.torque is not None  # a law without one is not registered
    return jax.vmap(partial(law.torque, parameters))(series)


def law_columns(law: TorqueLaw, nonlinear: dict, series: Sample) -> jax.Array:
    """Columns of a law's linear parameters along a series, shape (T, k).

    The torque is ``law_columns(...) @ linear``; the derivative with respect to linear parameters.
    A law whose memory depended on a linear parameter would break this; the contract of effects
    tests that none does.
    """
    if law.rate is not None:
        ones = {p.name: jnp.ones((), series.q.dtype) for p in law.linear}
        series = series._replace(state=states(law, {**ones, **nonlinear}, series))
    names = [p.name for p in law.linear]

    def torque(linear, sample):
        return law.torque({**dict(zip(names, linear, strict=True)), **nonlinear}, sample)

    zero = jnp.zeros(len(names), series.q.dtype)
    return jax.vmap(jax.jacfwd(torque), in_axes=(None, 0))(zero, series)
