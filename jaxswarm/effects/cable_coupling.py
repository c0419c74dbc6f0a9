r"""A cable or a hose that two joints stretch together.

Taut from its fixed end over both joints, it is longer by :math:`q + c q_o` and pulls with
:math:`k (q + c q_o - q_0)`; here with :math:`k_c = k c` and :math:`\tau_0 = -k q_0`, so that all is linear and
nothing is searched. It pulls at the partner too: there it is a second term, of the same :math:`k_c`. Told from
``joint_spring``, which does not know the partner and has fewer parameters, and from ``transmission_coupling``,
which goes with velocities. Where both joints carry gravity about parallel axes the
weight takes up much of it.

Reference: W. Khalil, E. Dombre 2002, ch. 9 (springs); the energy is k/2 (q + c q_o - q0)^2.
"""

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter

register(
    TorqueLaw(
        name="cable_coupling",
        scope="pair",
        parameters=(
            Parameter("kc", "N m/rad", -1e6, 1e6, True, 5.0, "stiffness, per partner's position"),
            Parameter("k", "N m/rad", 0.0, 1e6, True, 5.0, "stiffness, per own position"),
            Parameter("tau0", "N m", -1e6, 1e6, True, 0.0, "torque at q = q_other = 0"),
        ),
        summary="k q + kc q_other + tau0: cable over two joints",
        reference="Khalil, Dombre 2002, ch. 9",
        meaning=(
            "A cable or a hose runs over both joints and pulls when either moves; look at how it is "
            "led and give it slack, or compensate it in both joints."
        ),
        torque=lambda p, s: p["kc"] * s.q_other + p["k"] * s.q + p["tau0"],
        derived=lambda p: (
            {"c": (p["kc"] / p["k"], "1"), "q0": (-p["tau0"] / p["k"], "rad")} if p["k"] else {}
        ),
        mutual=True,
        contains=("joint_spring", "torque_offset"),
        shown_against="position",
    )
)
