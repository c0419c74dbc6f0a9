r"""A base that gives way: anchor bolts, a pedestal, a gantry or a cart that bends under the arm.

The base turns by :math:`\theta = -c\,M` about its x and y axes, M the moment [N m] that it has to exert on
the arm there, from the rigid body as any load. The arm then stands askew in gravity, and is turned along by
:math:`\dot\theta, \ddot\theta`. Both are taken to first order and quasi-statically: below the frequency at
which the arm sways on its base. What the joints do not feel of the first links (the moment of a mass beside
the first axis) is no part of M; on an arm whose axes are all upright that is most of it, and nothing shows.
Told from ``base_tilt``, which does not follow the load, and from ``joint_elasticity`` of the second joint,
which does much the same in a vertical plane but is not felt by the first.

The simulation is exact: two hinges on springs.

Reference: S. Moberg, J. Ohr, S. Gunnarsson, "A benchmark problem for robust control of a multivariable
nonlinear flexible manipulator", IFAC (2008) (elasticity across the driven axes as further joints).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.parameter import Parameter

# Up to a hundredth of what holds a small arm upright; a steel pedestal has 1e-7 to 1e-5.
_MOST = 1e-2

register(
    BodyChange(
        name="base_compliance",
        scope="global",
        parameters=(
            Parameter("cx", "rad/(N m)", 0.0, _MOST, True, 1e-5, "turn about base x per moment"),
            Parameter("cy", "rad/(N m)", 0.0, _MOST, True, 1e-5, "turn about base y per moment"),
        ),
        summary="the base turns about its x and y axes by c times the moment it holds",
        reference="Moberg, Ohr, Gunnarsson 2008, IFAC World Congress (further joints that no motor drives)",
        meaning=(
            "The base gives way under the arm: loose anchor bolts, a soft floor, cart or gantry; fasten "
            "and stiffen it, or move more gently."
        ),
        compliance=lambda p: jnp.array([p["cx"], p["cy"]]),
        uses_load=True,
        min_joints=2,
        shown_against="acceleration",
        derived=lambda p: {f"k{a}": (1.0 / p[f"c{a}"], "N m/rad") for a in "xy" if p[f"c{a}"]},
    )
)
