r"""Breakaway that grows with rest: contacts age while a joint stands and are renewed as it moves.

The age of the contacts grows with time and is used up over a way :math:`x_0`,
:math:`\dot\theta = 1 - |\dot q|\,\theta/x_0`; friction is higher by
:math:`f_c (1 - e^{-\theta/t_r})\,\mathrm{sign}\,\dot q`, so that a rest much longer than :math:`t_r` gives
all of it, and after a way of some :math:`x_0` nothing is left. Told from ``stribeck_friction``, which knows
the velocity and not the rest before and is the same on both sides of a reversal, and from ``hysteresis``,
which winds up after any reversal. It is asked only where the joint rests.

References: A. Ruina, "Slip instability and state variable friction laws", J. Geophys. Res. 88(B12) (1983)
(ageing of contacts); B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30(7) (1994), section 2
(rising static friction).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter

register(
    TorqueLaw(
        name="dwell_friction",
        scope="joint",
        parameters=(
            Parameter("fc", "N m", 0.0, 1e4, True, 1.0, "dry friction more after a long rest"),
            Parameter("x0", "rad", 2e-3, 0.5, False, 0.05, "way over which it is used up", "log"),
            Parameter("tr", "s", 0.1, 30.0, False, 1.0, "time of rest in which it grows", "log"),
        ),
        summary="fc (1 - exp(-age/tr)) sign(dq), d age/dt = 1 - |dq| age/x0: breakaway after rest",
        reference="Ruina 1983, J. Geophys. Res. 88(B12); Armstrong-Helouvry et al. 1994, Automatica 30(7)",
        meaning=(
            "The longer the joint stands the harder it breaks away: grease is squeezed out or seals "
            "stick; move it before precise work, or look at seals and lubricant."
        ),
        torque=lambda p, s: -p["fc"] * jnp.expm1(-s.state / p["tr"]) * s.direction,
        rate=lambda p, s: 1.0 - jnp.abs(s.dq) * s.state / p["x0"],
        forgets="x0",
        shown_against="time",
        uses_direction=True,
        dissipative=True,
        # Shorter rests are those of any reversal.
        rests=0.4,
        # Eight ways, each 2.2 times the one before, and eight times.
        grid_size=64,
    )
)
