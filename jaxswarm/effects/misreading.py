r"""What a wrong encoder says too much along a motion.

The excess e is a function of where the joint is, x, and of what its partner's encoder says: the encoder says
:math:`q = x + e(x, q_o)`. Where it says q, x is found by substitution; as e is told by q then, the joint moves
with :math:`\dot q - \dot e`, :math:`\ddot q - \ddot e`, and both derivatives follow from those of the motion
along :math:`q + s\,\dot q + s^2\,\ddot q/2`. Taken at q instead of x, waves of 0.08 rad came out 0.05 rad off.
"""

from collections.abc import Mapping

import jax

from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.programs import program

# Rounds of substitution: each shrinks the error by the slope of the excess. One of 0.25, far beyond any that is
# built, is then known to a part in sixty thousand, one of 0.05 to rounding.
ROUNDS = 8


def excess_of_said(
    law: MeasurementLaw, p: Mapping, said: jax.Array, partner: jax.Array
) -> jax.Array:
    """What an encoder says too much where it says this, and its partner that.

    >>> from jaxswarm.effects import get_law
    >>> law, waves = get_law("encoder_eccentricity"), {"s1": 0.1, "c1": 0.0, "s2": 0.0, "c2": 0.0}
    >>> x = jax.numpy.linspace(-1.0, 1.0, 3)
    >>> said = x + 0.1 * jax.numpy.sin(x)
    >>> abs(excess_of_said(law, waves, said, said) - (said - x)).max() < 1e-6
    Array(True, dtype=bool)
    """
    assert law.excess is not None  # the law is one of encoders
    excess = law.excess
    # One round in a loop: eight in a row, differentiated three times, took XLA 3.3 s to compile, this 0.7.
    true = jax.lax.fori_loop(0, ROUNDS, lambda _, x: said - excess(p, x, partner), said)
    return law.excess(p, true, partner)


@program("law")
def misreading(law: MeasurementLaw, p: Mapping, motion: tuple) -> tuple[jax.Array, ...]:
    """The excess of a law's encoder and its first and second derivative by time, each (T,).

    Args:
        law: A law with an ``excess``.
        p: Its parameters.
        motion: q, dq, ddq as said, each (T, 2): of the law's joint and of its partner.

    >>> from jaxswarm.effects import get_law
    >>> x = jax.numpy.ones((1, 2))
    >>> [float(e[0]) for e in misreading(get_law("encoder_offset"), {"dq0": 0.1}, (x, x, x))]
    [0.1, 0.0, 0.0]
    """
    q, dq, ddq = motion

    def at(s):
        said, partner = (q + s * dq + 0.5 * s * s * ddq).T
        return excess_of_said(law, p, said, partner)

    def rate(s):
        return jax.jvp(at, (s,), (1.0,))

    # One pass along one direction; nested Jacobians take several times as long to trace.
    (excess, slope), (_, bend) = jax.jvp(rate, (0.0,), (1.0,))
    return excess, slope, bend


@program("law")
def misreading_slopes(law: MeasurementLaw, p: Mapping, motion: tuple) -> tuple[dict, ...]:
    """Derivatives of :func:`misreading` by every parameter, dictionaries of (T,) by name."""
    return jax.jacfwd(lambda values: misreading(law, values, motion))(p)
