r"""What a wrong encoder says too much along a motion.

The excess e is a function of what encoders say, :math:`e(q, q_o)`, so that the joint stands at :math:`q - e`
and moves with :math:`\dot q - \dot e`, :math:`\ddot q - \ddot e`; both derivatives follow from those of the
motion along :math:`q + s\,\dot q + s^2\,\ddot q/2`.
"""

from collections.abc import Mapping

import jax

from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.programs import program


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
        here = q + s * dq + 0.5 * s * s * ddq
        return law.excess(p, here[:, 0], here[:, 1])

    def rate(s):
        return jax.jvp(at, (s,), (1.0,))

    # One pass along one direction; nested Jacobians take several times as long to trace.
    (excess, slope), (_, bend) = jax.jvp(rate, (0.0,), (1.0,))
    return excess, slope, bend


@program("law")
def misreading_slopes(law: MeasurementLaw, p: Mapping, motion: tuple) -> tuple[dict, ...]:
    """Derivatives of :func:`misreading` by every parameter, dictionaries of (T,) by name."""
    return jax.jacfwd(lambda values: misreading(law, values, motion))(p)
