r"""A base that gives way: anchor bolts, a pedestal, a gantry or a cart that bends under the arm.

The base turns by :math:`\theta` about its x and y axes, M the moment [N m] that it has to exert on a base that
stands, from the rigid body as any load:

.. math:: c\,(I(q) - \bar I)\,\ddot\theta + \frac{\ddot\theta}{\omega^2}
    + \frac{2\zeta}{\omega}\dot\theta + \theta = -c\,M,\qquad \omega = 2\pi f,

with the inertia I(q) of the arm about both axes and its mean over all turns of the joints (slides at zero): f
is the frequency at which the arm swings in a pose of that inertia. The arm then stands askew in gravity, and is
turned along by :math:`\dot\theta, \ddot\theta`, both to first order. A frequency at its upper bound is none
beside the motion: :math:`\theta = -c\,M`. What the joints do not feel of the first links (the moment of a mass
beside the first axis) is part of M only as far as the sway shows it; on an arm whose axes are all upright that
is most of it: c is hardly told, and without a swing nothing shows.
Told from ``base_tilt``, which does not follow the load, and from ``joint_elasticity`` of the second joint,
which does much the same in a vertical plane but is not felt by the first.

The simulation is exact: two hinges on springs, at the frequency that is told, else without a mass of their own.

Reference: S. Moberg, J. Ohr, S. Gunnarsson, "A benchmark problem for robust control of a multivariable
nonlinear flexible manipulator", IFAC (2008) (elasticity across the driven axes as further joints).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.parameter import Parameter

# Up to a hundredth of what holds a small arm upright; a steel pedestal has 1e-7 to 1e-5.
_MOST = 1e-2
# Frequencies [Hz] of an arm on a cart and beyond what a motion makes swing; damping ratios of bolted steel and
# of rubber, beyond which nothing swings that a soft joint would not explain as well.
_SLOW, _FAST, _DAMPING, _LOOSE = 1.0, 100.0, 0.03, 0.25

register(
    BodyChange(
        name="base_compliance",
        scope="global",
        parameters=(
            Parameter("cx", "rad/(N m)", 0.0, _MOST, True, 1e-5, "turn about base x per moment"),
            Parameter("cy", "rad/(N m)", 0.0, _MOST, True, 1e-5, "turn about base y per moment"),
            Parameter(
                "fx", "Hz", _SLOW, _FAST, False, _FAST, "swing about base x, mean inertia", "log"
            ),
            Parameter(
                "fy", "Hz", _SLOW, _FAST, False, _FAST, "swing about base y, mean inertia", "log"
            ),
            Parameter(
                "zeta", "1", 1e-3, _LOOSE, False, _DAMPING, "damping ratio of the swing", "log"
            ),
        ),
        summary="the base turns about its x and y axes by c times the moment it holds, and may swing",
        reference="Moberg, Ohr, Gunnarsson 2008, IFAC World Congress (further joints that no motor drives)",
        meaning=(
            "The base gives way under the arm: loose anchor bolts, a soft floor, cart or gantry; fasten "
            "and stiffen it, or move more gently."
        ),
        compliance=lambda p: jnp.array([p["cx"], p["cy"]]),
        swing=("fx", "fy", "zeta"),
        uses_load=True,
        min_joints=2,
        shown_against="acceleration",
        derived=lambda p: {f"k{a}": (1.0 / p[f"c{a}"], "N m/rad") for a in "xy" if p[f"c{a}"]},
    )
)
