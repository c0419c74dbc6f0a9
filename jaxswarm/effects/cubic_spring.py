r"""A spring that hardens: a rubber stop, a cable, a dress pack that is bent.

It must be told from ``joint_spring``. Where the joint carries gravity the two look alike: the weight takes
up a sine, and :math:`k_3 x^3 \approx 6 k_3 (x - \sin x)` up to the fifth power of the way x from rest, so
that a wide motion is needed. Both spend two parameters: what predicts unseen time better is named. The one
parameter that is not linear, the position of rest, is what is searched; the free polynomial of third degree
would spend four and lose against the straight spring.

Reference: I. Kovacic, M. J. Brennan, "The Duffing Equation" (2011), ch. 2 (hardening springs).
"""

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter

register(
    TorqueLaw(
        name="cubic_spring",
        scope="joint",
        parameters=(
            Parameter("k3", "N m/rad^3", 0.0, 1e6, True, 10.0, "stiffness per squared deflection"),
            # About a point far beyond all positions it is a linear one.
            Parameter(
                "q0",
                "rad",
                -3.2,
                3.2,
                False,
                0.0,
                "position of rest",
                another_at=("lower", "upper"),
            ),
        ),
        summary="k3 (q - q0)^3: hardening spring",
        reference="Kovacic, Brennan 2011, The Duffing Equation, eq. 2.1",
        meaning=(
            "Something resists the more the further it is bent: a rubber stop, a dress pack, a cable "
            "bundle; look at what is stretched or squeezed at the ends of the motion."
        ),
        torque=lambda p, s: p["k3"] * (s.q - p["q0"]) ** 3,
        shown_against="position",
        # A smooth torque of one valley: points lie 0.2 rad apart.
        grid_size=32,
    )
)
