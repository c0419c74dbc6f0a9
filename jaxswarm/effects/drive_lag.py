r"""A filter in the torque's channel of one drive: what is written down follows its torque with a time constant.

:math:`t_c\,\dot y + y = \tau` on one joint. ``torque_lag`` is the same filter in all channels, with a clock's
delay; a drive whose filter is set otherwise than its sisters' has this one, and its torque alone is late. Told
from ``joint_elasticity`` and ``backlash``, whose links are late while their motor's torque is not, by what it
takes off the friction and the rotor's torque too; from ``hysteresis``, whose friction turns over a distance
after each reversal, by the time that it turns over, and by the weight, which a bristle leaves as it is.

Reference: K. J. Astrom, R. M. Murray, "Feedback Systems" (2008), ch. 8 (first-order lag).
"""

import jax
import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.torque_lag import filtered


def _report(p, x, step):
    return filtered(jnp.asarray(x), p["tc"], step)


register(
    MeasurementLaw(
        name="drive_lag",
        scope="joint",
        parameters=(
            Parameter("tc", "s", 0.0, 0.2, False, 0.0, "time constant of the drive's filter"),
        ),
        summary="tc d(measured)/dt + measured = torque: filtered torque channel of one drive",
        reference="Astrom, Murray 2008, Feedback Systems, ch. 8",
        meaning=(
            "The torque of one drive is written down through a low-pass that the others' are not; set "
            "its filter as theirs."
        ),
        report=jax.jit(_report),
        probe={"tc": 0.002},
        slow=True,
        # Of one joint alone it is that of all.
        min_joints=2,
        shown_against="torque rate",
    )
)
