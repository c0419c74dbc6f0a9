r"""A spring that is slack in the middle: an end stop of rubber, a hose or a dress pack that is pulled taut.

.. math:: \tau = k\,(\max(x - g, 0) + \min(x + g, 0)), \qquad x = q - q_0

Where only one end lies within the motion, its place :math:`q_0 + g` or :math:`q_0 - g` is told and the other is
anywhere beyond. It must be told from
``joint_spring``, which it is without a slack part and so takes the place of, and from ``cubic_spring``, whose
torque has no kink. What a ``contact`` does in a window of time it does at a position, whenever the joint comes
there.

Reference: J.-J. E. Slotine, W. Li, "Applied Nonlinear Control" (1991), section 5.2 (dead zone).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter


def _torque(p, s):
    x = s.q - p["q0"]
    return p["k"] * (jnp.maximum(x - p["gap"], 0.0) + jnp.minimum(x + p["gap"], 0.0))


register(
    TorqueLaw(
        name="dead_zone_spring",
        scope="joint",
        parameters=(
            Parameter("k", "N m/rad", 0.0, 1e6, True, 10.0, "stiffness where it is taut"),
            Parameter("q0", "rad", -3.2, 3.2, False, 0.0, "middle of the slack part", lies="place"),
            Parameter(
                *("gap", "rad", 0.0, 3.2, False, 0.3, "slack to either side"),
                lies="width",
                another_at=("lower",),
            ),
        ),
        summary="k (abs(q - q0) - gap) sign(q - q0) beyond the gap: end stop, taut hose",
        reference="Slotine, Li 1991, Applied Nonlinear Control, sec. 5.2",
        meaning=(
            "Something is slack in the middle of the motion and pulls or pushes at its ends: a rubber "
            "stop, a hose or a cable bundle pulled taut; look at what tightens or is reached there."
        ),
        torque=_torque,
        contains=("joint_spring",),
        derived=lambda p: {"low": (p["q0"] - p["gap"], "rad"), "high": (p["q0"] + p["gap"], "rad")},
        shown_against="position",
        # A torque with two kinks: points lie a fifteenth of the motion apart in both directions.
        grid_size=256,
    )
)
