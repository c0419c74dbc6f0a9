r"""A filter in the torque's channel: what is written down follows the torque with a time constant.

:math:`t_c\,\dot y + y = \tau(t - \theta)`: the filter of a drive or a sensor, with a delay as well. Below its
corner a filter delays by :math:`t_c` what passes, and to first order that is all. It is told from
``time_delay``, which it contains and beside which alone it is asked, by what it takes off fast torques,
:math:`t_c^2 \omega^2/2` of them, such as the jump of dry friction at a reversal.

Reference: K. J. Astrom, R. M. Murray, "Feedback Systems" (2008), ch. 8 (first-order lag and delay).
"""

import jax
import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.measurement import shift
from jaxswarm.effects.parameter import Parameter


@jax.jit
def lag(x: jax.Array, seconds: jax.Array, step: float) -> jax.Array:
    """First-order low-pass of a uniformly sampled signal along the first axis, exact for straight lines.

    It starts settled on the line through the first two samples. ``step`` is the sampling interval [s].

    >>> x = jnp.arange(4.0)
    >>> lag(x, 0.5, 1.0)
    Array([-0.5,  0.5,  1.5,  2.5], dtype=float64)
    """
    x = jnp.asarray(x)
    rate = step / jnp.maximum(seconds, 1e-3 * step)
    keep = jnp.exp(-rate)
    new = 1.0 - (1.0 - keep) / rate

    def follow(y, pair):
        before, now = pair
        y = keep * y + (1.0 - keep - new) * before + new * now
        return y, y

    start = x[0] - jnp.maximum(seconds, 1e-3 * step) / step * (x[1] - x[0])
    _, rest = jax.lax.scan(follow, start, (x[:-1], x[1:]))
    return jnp.concatenate([start[None], rest])


def filtered(x: jax.Array, seconds: jax.Array, step: float) -> jax.Array:
    """The same as :func:`lag`, and the signal itself for a time constant of zero."""
    return jnp.where(seconds > 0.0, lag(x, seconds, step), x)


def _report(p, x, step):
    return filtered(shift(jnp.asarray(x), p["seconds"], step), p["tc"], step)


register(
    MeasurementLaw(
        name="torque_lag",
        scope="global",
        parameters=(
            Parameter("tc", "s", 0.0, 0.2, False, 0.0, "time constant of the filter"),
            Parameter(
                "seconds",
                "s",
                -0.05,
                0.05,
                False,
                0.0,
                "by which the torque is late too",
                usual=True,
            ),
        ),
        summary="tc d(measured)/dt + measured = torque(t - seconds): filtered torque channel",
        reference="Astrom, Murray 2008, Feedback Systems, ch. 8",
        meaning=(
            "The torque is written down through a low-pass that the positions do not pass; switch "
            "the filter off, or pass both through the same one."
        ),
        report=jax.jit(_report),
        alike=True,
        late=lambda p: p["tc"] + p["seconds"],
        # The slope at zero is that of the delay: drawn to a common time constant it is the filter's own.
        probe={"tc": 0.01},
        contains=("time_delay",),
        extends=("time_delay",),
        shown_against="torque rate",
    )
)
