r"""A force that comes and goes with a period of its own: a machine beside the arm, an unbalanced tool, a fan.

:math:`a \sin(2\pi f t + \varphi)` on a joint, in one log: the next log meets it at another phase. Its
frequency is read off the spectrum of what the model leaves, so that nothing is searched. Told from
``torque_ripple``, which goes with the position; where the motion repeats itself with a multiple of its period
nothing tells it from a law that is missing, and it is not asked. Nor is it where it is not the larger part of
what is left.

Reference: G. L. Bretthorst, "Bayesian Spectrum Analysis and Parameter Estimation" (1988), ch. 2.
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import PHASE, Parameter


def _swinging(p, s):
    angle = 2.0 * jnp.pi * p["hertz"] * s.t
    return p["sine"] * jnp.sin(angle) + p["cosine"] * jnp.cos(angle)


register(
    TorqueLaw(
        name="periodic_force",
        scope="joint",
        parameters=(
            Parameter("sine", "N m", -1e4, 1e4, True, 0.5, "amplitude of sin(2 pi hertz t)"),
            Parameter("cosine", "N m", -1e4, 1e4, True, 0.5, "amplitude of cos(2 pi hertz t)"),
            Parameter("hertz", "Hz", 0.05, 100.0, False, 2.0, "frequency", "log"),
            Parameter(
                "log", "1", 0.0, 1e6, False, 0.0, "number of its log, from zero", fitted=False
            ),
        ),
        summary="a sin(2 pi hertz t + phase) in one log: force with a period of its own",
        reference="Bretthorst 1988, Bayesian Spectrum Analysis, ch. 2",
        meaning=(
            "Something shakes the arm at a frequency of its own: a machine nearby, an unbalanced tool, a "
            "controller near its limit; find what runs at that frequency and record without it."
        ),
        torque=_swinging,
        tone="hertz",
        reference_only=True,
        identity=("log",),
        shown_against="time",
        derived=lambda p: {
            "a": (jnp.hypot(p["sine"], p["cosine"]), "N m"),
            "phase": (jnp.arctan2(p["cosine"], p["sine"]), PHASE),
        },
    )
)
