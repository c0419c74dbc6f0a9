r"""An encoder disc or a last gear that does not run true: its angle errs once and twice per turn.

A disc off its axis by a part of its radius reads :math:`q + a \sin q + b \cos q`; an oval one, or two heads
that do not quite cancel, add the second harmonic. The error is as large as that of a wrong zero and changes
with the position: the true joint is also faster and slower than it says. Told from ``encoder_offset``, which
has one parameter and says the same where the joint turns little.

References: R. P. Judd, A. B. Knasinski, "A technique to calibrate industrial robots with experimental
verification", IEEE Trans. Robotics Automation 6(1) (1990) (harmonics of the gears' errors);
N. Hagiwara, Y. Suzuki, H. Murase, IEEE Trans. Instrum. Meas. 41(1) (1992).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.parameter import Parameter


def _harmonics(p, q, q_other):
    once = p["s1"] * jnp.sin(q) + p["c1"] * jnp.cos(q)
    return once + p["s2"] * jnp.sin(2.0 * q) + p["c2"] * jnp.cos(2.0 * q)


register(
    MeasurementLaw(
        name="encoder_eccentricity",
        scope="joint",
        parameters=tuple(
            Parameter(name, "rad", -0.2, 0.2, False, 0.0, f"amplitude of {wave}")
            for name, wave in (
                ("s1", "sin q"),
                ("c1", "cos q"),
                ("s2", "sin 2q"),
                ("c2", "cos 2q"),
            )
        ),
        summary="measured position = position + s1 sin q + c1 cos q + s2 sin 2q + c2 cos 2q",
        reference="Judd, Knasinski 1990, IEEE Trans. Robotics Automation 6(1)",
        meaning=(
            "The encoder's disc or the last gear runs out of true, so the position errs once or twice "
            "a turn; have the encoder centered, or correct it by these waves."
        ),
        excess=_harmonics,
        turning=True,
        shown_against="position",
        derived=lambda p: {
            "once": (jnp.hypot(p["s1"], p["c1"]), "rad"),
            "twice": (jnp.hypot(p["s2"], p["c2"]), "rad"),
        },
    )
)
