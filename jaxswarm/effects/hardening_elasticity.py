r"""A gear or belt that is soft at small torques and stiffens as it winds up.

The spring of ``joint_elasticity`` with a cubic part, :math:`k\,e\,(1 + (e/e_h)^2) + d\,\dot e`: at the twist
:math:`e_h` it pushes twice as hard as its first stiffness alone, and its slope is four times that. Few teeth of
a harmonic drive mesh without load, more as it winds up; timing belts, rubber couplings and series springs do
alike. It is asked beside ``joint_elasticity`` or ``backlash``, either of which may be found first, and replaces
it: a straight spring has the stiffness of the usual load, and the link of a dead zone is free without load,
where this one is held softly and crosses without an impact.

References: T. D. Tuttle, W. P. Seering, "A nonlinear model of a harmonic drive gear transmission", IEEE Trans.
Robotics and Automation 12(3) (1996), for the cubic stiffness; M. Spong, J. Dyn. Sys. Meas. Control 109 (1987),
for the motion of the link.
"""

import numpy as np

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TransmissionLaw
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.transmission import DAMPING, STIFFNESS

# Parts of the usual stiffness, damping ratios, and multiples of the usual twist that are tried: what hardens
# beyond the last hardly hardens on that log.
_SOFTER, _DAMPED, _TWISTS = (0.2, 0.35, 0.5, 0.65, 0.8, 0.9), (0.03, 0.1, 0.3), (0.5, 1.0, 2.0, 4.0)


def _around(inertia: float, k: float, twist: float) -> list[dict[str, float]]:
    swinging = 2.0 * np.sqrt(k * inertia)
    return [
        {"k": s * k, "eh": t * twist, "d": r * swinging}
        for s in _SOFTER
        for r in _DAMPED
        for t in _TWISTS
    ]


register(
    TransmissionLaw(
        name="hardening_elasticity",
        scope="joint",
        parameters=(
            Parameter("k", "N m/rad", *STIFFNESS, False, 5e3, "stiffness without load", "log"),
            Parameter("eh", "rad", 1e-5, 1.0, False, 0.01, "twist of twice the torque", "log"),
            Parameter("d", "N m s/rad", *DAMPING, False, 5.0, "damping", "log"),
        ),
        summary="as joint_elasticity, stiffening: k e (1 + (e/eh)^2) + d de/dt = torque of the link",
        reference="Tuttle, Seering 1996, IEEE Trans. Robotics and Automation 12(3)",
        meaning=(
            "The gear is soft around zero torque and stiffens as it winds up, as harmonic drives, belts and "
            "rubber couplings are; a first stiffness far below the data sheet means worn or loose teeth."
        ),
        contains=("joint_elasticity", "backlash"),
        extends=("joint_elasticity", "backlash"),
        spring=lambda p: (p["k"], p["d"]),
        hardening=lambda p: p["k"] / p["eh"] ** 2,
        around=_around,
        shown_against="acceleration",
        derived=lambda p: {"k3": (p["k"] / p["eh"] ** 2, "N m/rad^3")},
    )
)
