r"""Friction whose bristles bend before they slide, and hold more at creeping speed: LuGre.

The mean bend of the bristles obeys :math:`\dot z = \dot q - |\dot q|\,z/(x_0\,g(\dot q))` and gives
:math:`f_c\,z/x_0`, with :math:`g = 1 + r\,e^{-(\dot q/v_s)^2}`: at steady speed Coulomb's and Stribeck's
friction in one, and after a reversal the spring of ``hysteresis``, to which it comes down for r = 0. It is
asked beside that one alone: what the rise at creeping speed adds has to be worth as much as any other effect.
Told from ``hysteresis`` with ``stribeck_friction``, whose rise jumps with the sign of the velocity before a
bristle has bent. Micro-damping is left out: the filter of a log takes it away.

References: C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, "A new model for control of systems with
friction", IEEE Trans. Automatic Control 40(3) (1995), eq. 2-4.
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter


def _rate(p, s):
    held = 1.0 + p["rise"] * jnp.exp(-((s.dq / p["vs"]) ** 2))
    return (s.dq - jnp.abs(s.dq) * s.state / held) / p["x0"]


register(
    TorqueLaw(
        name="lugre_friction",
        scope="joint",
        parameters=(
            Parameter("fc", "N m", 0.0, 1e4, True, 1.0, "dry friction while it slides"),
            Parameter("x0", "rad", 1e-4, 1.0, False, 0.05, "bend of the bristles, sliding", "log"),
            Parameter("rise", "1", 0.05, 5.0, False, 0.5, "more at creeping speed, of fc", "log"),
            Parameter("vs", "rad/s", 0.005, 1.0, False, 0.1, "Stribeck velocity", "log"),
        ),
        summary="fc z/x0, dz/dt = dq - |dq| z/(x0 (1 + rise exp(-(dq/vs)^2))): bristles that slip early",
        reference="Canudas de Wit, Olsson, Astrom, Lischinsky 1995, IEEE TAC 40(3), eq. 2-4",
        meaning=(
            "The joint winds up before it slides and sticks hardest when it creeps: it hunts around its "
            "goal; compensate by this law, or avoid creeping through reversals."
        ),
        torque=lambda p, s: p["fc"] * s.state,
        rate=_rate,
        forgets="x0",
        contains=("hysteresis", "stribeck_friction"),
        extends=("hysteresis",),
        shown_against="position",
        derived=lambda p: {
            "sigma": (p["fc"] / p["x0"], "N m/rad"),
            "fs": (p["fc"] * (1.0 + p["rise"]), "N m"),
        },
    )
)
