r"""What sits between motor and link: flexible joints and backlash.

References: M. Spong, "Modeling and control of elastic joint robots", J. Dyn. Sys. Meas. Control 109
(1987); M. Nordin, P.-O. Gutman, Automatica 38(10) (2002).
"""

import numpy as np

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TransmissionLaw
from jaxswarm.effects.parameter import Parameter

# Frequencies [Hz] of a link on its spring that are tried, dampings as multiples of 20 sqrt(k times inertia).
# Stiffnesses that are the same for all joints began at 25 Hz for links of a wrist: one of 5 Hz was told at the
# bound.
_FREQUENCIES, _DAMPINGS = np.geomspace(0.87, 87.0, 17), (0.003, 0.01, 0.03, 0.1)
# What the gears of a finger and of the axis of a heavy arm may have [N m/rad, N m s/rad].
STIFFNESS, DAMPING = (0.1, 1e7), (1e-4, 1e5)
# Gaps [rad] that are tried.
_GAPS = np.geomspace(2e-4, 0.06, 44)


def _springs(inertia):
    swinging = 2.0 * np.pi * _FREQUENCIES
    return [{"k": inertia * w**2, "d": 20.0 * r * inertia * w} for w in swinging for r in _DAMPINGS]


register(
    TransmissionLaw(
        name="joint_elasticity",
        scope="joint",
        parameters=(
            Parameter("k", "N m/rad", *STIFFNESS, False, 1e4, "stiffness", "log"),
            Parameter("d", "N m s/rad", *DAMPING, False, 5.0, "damping", "log"),
        ),
        summary="encoder on the motor: the link lags by e with k e + d de/dt = torque of the link",
        reference="Spong 1987, J. Dyn. Sys. Meas. Control 109(4)",
        meaning=(
            "The link swings on the spring of its gear behind the motor, where the encoder is; a "
            "stiffness below the data sheet means a loose belt or coupling or a worn gear."
        ),
        spring=lambda p: (p["k"], p["d"]),
        lattice=_springs,
        softer=lambda p, times: {"k": p["k"] / times, "d": p["d"] / np.sqrt(times)},
        shown_against="acceleration",
    )
)

# Without better knowledge: frequency of the link on a closed gear [Hz], doubt about an impact's moment [s].
_FLANK, _BLUR = 30.0, 0.12

register(
    TransmissionLaw(
        name="backlash",
        scope="joint",
        parameters=(
            Parameter("gap", "rad", 1e-5, 0.2, False, 0.005, "dead zone to either side", "log"),
            Parameter(
                "flank",
                "Hz",
                10.0,
                100.0,
                False,
                _FLANK,
                "of the link on a closed gear",
                "log",
                # A torque averaged over the moment of an impact says nothing of the flank.
                hidden_by="blur",
            ),
            Parameter(
                "blur",
                "s",
                0.0,
                1.0,
                False,
                _BLUR,
                "time a predicted impact may be off",
                fitted=False,
            ),
        ),
        summary="encoder on the motor: dead zone in the transmission",
        reference="Nordin, Gutman 2002, Automatica 38(10)",
        meaning=(
            "The gear has backlash, so the link lags by the gap at every reversal; a gap above the "
            "data sheet means wear, or preload to be set."
        ),
        gap=lambda p: p["gap"],
        lattice=lambda inertia: [{"gap": g, "flank": _FLANK, "blur": _BLUR} for g in _GAPS],
        stepwise=True,
        shown_against="position",
    )
)
