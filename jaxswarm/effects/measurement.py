r"""What the drives and their clock write down: another scale, another time.

References: A. Janot, M. Gautier, M. Brunot 2019 (time skew on the EMPS); M. Gautier, S. Briot,
"Global identification of joint drive gains and dynamic parameters of robots", J. Dyn. Sys. Meas.
Control 136 (2014).
"""

import jax
import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.parameter import Parameter
from jaxswarm.programs import Program


def shift(x: jax.Array, seconds: jax.Array, step: float) -> jax.Array:
    """Delay a uniformly sampled signal: ``x(t - seconds)`` along the first axis, cubic in between.

    Catmull-Rom interpolation, ends held. ``step`` is the sampling interval [s].

    >>> x = jnp.arange(6.0)[:, None]
    >>> shift(x, 0.5, 1.0)[2:4, 0]
    Array([1.5, 2.5], dtype=float64)
    """
    length = x.shape[0]
    place = jnp.arange(length) - seconds / step
    base = jnp.floor(place).astype(jnp.int32)
    u = (place - base).reshape(-1, *(1,) * (x.ndim - 1))
    p0, p1, p2, p3 = (x[jnp.clip(base + k, 0, length - 1)] for k in (-1, 0, 1, 2))
    return p1 + 0.5 * u * (
        p2 - p0 + u * (2 * p0 - 5 * p1 + 4 * p2 - p3 + u * (3 * (p1 - p2) + p3 - p0))
    )


shifted = Program(shift)

register(
    MeasurementLaw(
        name="drive_gain",
        scope="joint",
        parameters=(Parameter("gain", "1", 0.5, 2.0, False, 1.0, "measured over true torque"),),
        summary="measured torque = gain x torque",
        reference="Gautier, Briot 2014, J. Dyn. Sys. Meas. Control 136(5)",
        meaning=(
            "The torque is scaled: a wrong torque constant, gear ratio or unit of one drive; "
            "check the setting of the drive before the model is trusted."
        ),
        report=lambda p, x, step: p["gain"] * x,
        scales=True,
        min_joints=2,
        shown_against="model torque",
    )
)

register(
    MeasurementLaw(
        name="time_delay",
        scope="global",
        parameters=(
            Parameter("seconds", "s", -0.05, 0.05, False, 0.0, "by which the torque clock lags"),
        ),
        summary="torque measured at t belongs to the motion at t - seconds",
        reference="Janot, Gautier, Brunot 2019 (EMPS, time skew)",
        meaning=(
            "Torque and positions are stamped by clocks that differ, or one is filtered more; "
            "correct the stamps, or the filter of the drive."
        ),
        report=lambda p, x, step: shifted(x, p["seconds"], step),
        clock=True,
        alike=True,
        shown_against="torque rate",
    )
)
