r"""A spring that lets go with time: hoses, cables and rubber that creep while they are held.

A spring in series with a damper, the element of Maxwell: its twist follows the joint and dies away,
:math:`\dot z = \dot q - z/t_c`, and the motor supplies :math:`k z`. A motion much faster than :math:`t_c` meets
a spring about wherever the joint was before, a much slower one viscous friction of :math:`k t_c`; in between,
torque lags behind position by an angle that a spring with a damper beside it (``joint_spring`` and
``viscous_friction``) has at one frequency only. Told from ``hysteresis``, whose element holds for ever and
slides at a level: this one knows no level, and forgets while the joint stands.

A log begins amid a motion: the twist of its first sample is taken as that of a velocity held for long,
:math:`t_c \dot q`, which is right at rest, and what that is wrong by is gone after some :math:`t_c`.

References: J. C. Maxwell, "On the dynamical theory of gases", Phil. Trans. 157 (1867) (relaxation of stress);
W. N. Findley, J. S. Lai, K. Onaran, "Creep and Relaxation of Nonlinear Viscoelastic Materials" (1976), section
5.2 (Maxwell model).
"""

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter

register(
    TorqueLaw(
        name="relaxing_spring",
        scope="joint",
        parameters=(
            Parameter("k", "N m/rad", 0.0, 1e5, True, 10.0, "stiffness against a fast motion"),
            Parameter(
                *("tc", "s", 0.02, 10.0, False, 0.3, "time after which it lets go", "log"),
                # Below a motion's times it is viscous friction, beyond a log's a spring.
                another_at=("lower", "upper"),
            ),
        ),
        summary="k z, dz/dt = dq - z/tc: a spring that lets go with time",
        reference="Maxwell 1867; Findley, Lai, Onaran 1976, section 5.2",
        meaning=(
            "Hoses, cables or rubber beside the joint are wound up by motion and creep back while it stands: "
            "torque at a place depends on how the arm came there; look at the dress pack, or compensate it."
        ),
        torque=lambda p, s: p["k"] * s.state,
        rate=lambda p, s: s.dq - s.state / p["tc"],
        start=lambda p, s: p["tc"] * s.dq,
        shown_against="position",
        derived=lambda p: {"d": (p["k"] * p["tc"], "N m s/rad")},
    )
)
