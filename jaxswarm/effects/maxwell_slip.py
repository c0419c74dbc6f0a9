r"""Two elements that stick and slip each by itself: generalized Maxwell slip where presliding shows.

Each element is a spring with a slider. It follows the joint, :math:`\dot z_i = \dot q / x_i`, until it is bent
as far as it can be, :math:`|z_i| \le 1`, slides there, and holds again from the next reversal on; together they
give :math:`f_1 z_1 + f_2 z_2`. Small loops inside of large ones close where they began, which one bristle
(``hysteresis``) cannot remember: its loops drift. It is asked beside that one alone, so that what the sharper
flank and the second way add has to be worth as much as any other effect.

Why two: along the motion of a simulated log a bristle leaves 5 to 26 % of the torque that dry and viscous
friction leave of one to six elements. Two elements with ways of their own leave 0.1 % of one, 0.5 % of two, and
2 to 11 % of four to six; four whose ways halve and whose levels follow a power leave 2 to 10 % of each. What
rises slowly while an element slides (the model's third equation) is left to ``stribeck_friction``. Told from
``lugre_friction``, whose loops drift like those of a bristle, and which holds most at creeping speed.

An element is known by its way: what slips last is the first of the two. Where one level is not told from zero
the law is one element, which either of them could stand for; it is told as what slips last, by ``fc1`` and
``x1``, and the way of the other is not told.

References: F. Al-Bender, V. Lampaert, J. Swevers, "The generalized Maxwell-slip model: a novel model for
friction simulation and compensation", IEEE Trans. Automatic Control 50(11) (2005).
"""

from collections.abc import Mapping

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter


def _exchanged(p: Mapping) -> dict[str, float]:
    """What slips first in place of what slips last, and an element without a level before it."""
    return {**p, "fc1": p["fc2"], "fc2": 0.0, "x1": p["part"] * p["x1"]}


register(
    TorqueLaw(
        name="maxwell_slip",
        scope="joint",
        parameters=(
            Parameter("fc1", "N m", 0.0, 1e4, True, 1.0, "level of what slips last"),
            Parameter("fc2", "N m", 0.0, 1e4, True, 1.0, "level of what slips first"),
            Parameter(
                *("x1", "rad", 1e-4, 1.0, False, 0.05, "way after which the last slips", "log"),
                shown_by=("fc1",),
            ),
            Parameter(
                *("part", "1", 0.02, 0.8, False, 0.3, "way of the first, of x1", "log"),
                shown_by=("fc1", "fc2"),
            ),
        ),
        summary="fc1 z1 + fc2 z2, dz/dt = dq/x, |z| <= 1, x = x1 and part x1: elements that stick and slip",
        reference="Al-Bender, Lampaert, Swevers 2005, IEEE TAC 50(11)",
        meaning=(
            "Part of the joint's friction is held by stiff, part by soft contacts, and each lets go at its own "
            "way: torque after a reversal depends on where it turned before; compensate it by this law."
        ),
        torque=lambda p, s: p["fc1"] * s.state[0] + p["fc2"] * s.state[1],
        rate=lambda p, s: (s.dq / p["x1"], s.dq / (p["part"] * p["x1"])),
        memories=2,
        most=1.0,
        forgets="x1",
        exchanged=_exchanged,
        contains=("hysteresis",),
        extends=("hysteresis",),
        shown_against="position",
        derived=lambda p: {
            "k1": (p["fc1"] / p["x1"], "N m/rad"),
            "k2": (p["fc2"] / (p["part"] * p["x1"]), "N m/rad"),
        },
    )
)
