r"""The lag of a link behind its motor, where the encoder is.

With the encoder on the motor, the link of joint j lags by :math:`e = q_m - q_l`. The transmission carries
:math:`\tau_t = k\,z(e) + k_3\,z(e)^3 + d\,\dot e`, with :math:`z` the identity for a spring and a dead zone
of ``gap`` to either side for backlash, :math:`k_3` zero but for a spring that hardens. The link obeys its own
dynamics, so with :math:`RB_j` the rigid torque of joint j, linearized about the motor's motion,

.. math:: M_{jj} \ddot e + (d + C_j) \dot e + K_j e + k\,z(e) + k_3\,z(e)^3 = RB_j(q_m, \dot q_m, \ddot q_m),

:math:`M_{jj}, C_j, K_j` the derivatives of :math:`RB_j` with respect to acceleration, velocity and
position of joint j. It is integrated from the motor's side (:func:`deflection`); the quasi-static
correction would differentiate the noise twice more and fail near resonance. The stiffness of a gear with
backlash is told by the frequency ``flank`` at which the link swings on it when closed, with damping ratio
0.3; its lag is averaged over ``blur``, by which the moment of an impact may be off (zero: impacts where they
are predicted). The simulation knows neither of the two and takes a stiff flank. The rigid body then moves
by ``q - e``, friction and rotor inertia stay with the motor. Reference: M. W. Spong, J. Dyn. Sys. Meas.
Control 109 (1987); M. Nordin, P.-O. Gutman, Automatica 38 (2002), eq. 6 for the dead zone.
"""

import math

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.programs import program

# Longest step of the integrator [s], which keeps a stiff contact accurate, and the most of them in a sample.
_STEP, _MOST_SUBSTEPS = 1e-3, 4
# Damping ratio of a link on a closed gear: of 0.1 to 0.8 it leaves least of two logs with a known gap, one of
# another simulator (0.3 there), one of this one (damping that grows with the pressing).
_CONTACT_DAMPING = 0.3
# Second derivative of sixth order from samples.
_BEND = (1 / 90, -3 / 20, 3 / 2, -49 / 18, 3 / 2, -3 / 20, 1 / 90)
# Steps to the first equilibrium: far up a cubic each takes a third off, near its end they square the error.
_NEWTON = 16
# Time [s] whose torque says where a link starts: longer than the ends of a smoothing reach. On q10 of the
# practice logs the first sample said 49 N m where 37 held the link: a swing of its own, three times the noise.
_EARLY = 0.25


def substeps_of(interval: float, longer: float = 1.0) -> int:
    """Steps of the integrator within a sample.

    Four in a log at 250 Hz or less, one at 1 kHz: a sample ten times as short needs no more of them.

    Args:
        interval: Of the samples [s].
        longer: How many times longer the steps may be than a fit's.

    >>> [substeps_of(1 / rate) for rate in (100.0, 250.0, 500.0, 1000.0)], substeps_of(0.004, 2.0)
    ([4, 4, 2, 1], 2)
    """
    # A rate that is off by a little asks for no step more.
    most = max(1, round(_MOST_SUBSTEPS / longer))
    return min(most, max(1, math.ceil(interval / (longer * _STEP) - 0.01)))


@program("substeps")
def deflection(
    inertia: jax.Array,
    damping: jax.Array,
    stiffness: jax.Array,
    torque: jax.Array,
    k: jax.Array,
    d: jax.Array,
    gap: jax.Array,
    hard: jax.Array,
    step: jax.Array,
    calm: jax.Array | int = 0,
    substeps: int = _MOST_SUBSTEPS,
) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Integrate the lag of a link behind its motor along a log.

    Trapezoidal (Newmark) steps with the contact on the flank, and the slope of a spring that hardens, taken as
    they were: stable for any stiffness.

    Args:
        inertia, damping, stiffness: Derivatives of the joint's rigid torque by its own acceleration,
            velocity, position, each (T,).
        torque: Rigid torque on the motor's motion [N m], shape (T,).
        k: Stiffness of the transmission [N m/rad].
        d: Its damping [N m s/rad].
        gap: Dead zone to either side [rad]; zero for a spring.
        hard: What the spring gains on the cube of its twist [N m/rad^3]; zero for a straight one.
        step: Sampling interval [s].
        calm: Samples at the start in which a link on a spring settles to where its torque would hold it, with
            critical damping: nobody measured how it swung before. Zero where it begins in equilibrium.
        substeps: Integration steps per sample, :func:`substeps_of`.

    Returns:
        e [rad], its first and second derivative, each (T,), the second that of the samples of e. The start is
        the equilibrium of a spring under the mean torque of the first quarter second; with a gap it is on the
        flank that this torque presses.
    """
    h = step / substeps

    def advance(carry, given):
        more, ends = given
        quasi = (ends[3][1] - ends[3][0]) / (k + ends[2][1]) / step

        def small(index, state):
            e, v, a = state
            part = (index + 1) / substeps  # what drives the lag runs straight between samples
            m, c, s, tau = (old + part * (new - old) for old, new in ends)
            beyond = e - jnp.clip(e, -gap, gap)
            closed = (jnp.abs(beyond) > 0) | (gap <= 0)
            steeper = 3.0 * hard * beyond**2
            spring = s + jnp.where(closed, k + steeper, 0.0)
            damper = c + jnp.where(closed, d + more, 0.0)
            offset = jnp.where(closed, k * (e - beyond) + steeper * (e - beyond / 3.0), 0.0)
            predicted, speed = e + h * v + 0.25 * h * h * a, v + 0.5 * h * a
            force = tau + offset + more * quasi - damper * speed - spring * predicted
            a = force / (m + 0.5 * h * damper + 0.25 * h * h * spring)
            return predicted + 0.25 * h * h * a, speed + 0.5 * h * a, a

        # Written out: as a loop of the program these few operations took twice as long.
        for index in range(substeps):
            carry = small(index, carry)
        return carry, carry

    # The first samples of a filtered motion are the least certain: their sign may be wrong.
    early = jnp.arange(len(torque)) * step < _EARLY
    drive = jnp.where(early, torque, 0.0).sum() / early.sum()
    side = jnp.sign(drive)
    pressed = _pressed(drive, k + stiffness[0], hard)
    start = jnp.where(gap > 0, side * (gap + jnp.maximum(side * pressed, 0.0)), pressed)
    zero = jnp.zeros((), torque.dtype)
    m = jnp.maximum(inertia, 1e-6 * jnp.max(jnp.abs(inertia)) + 1e-12)
    driven = tuple((jnp.roll(x, 1).at[0].set(x[0]), x) for x in (m, damping, stiffness, torque))
    settles = (jnp.arange(len(torque)) < calm) & (gap <= 0)
    more = jnp.where(settles, jnp.maximum(2.0 * jnp.sqrt(k * m) - d, 0.0), 0.0)
    _, (e, v, a) = jax.lax.scan(advance, (start, zero, zero), (more, driven))
    return e, v, _bends(e, a, step)


def _bends(e: jax.Array, a: jax.Array, step: jax.Array) -> jax.Array:
    """The second derivative (T,) of a sampled lag; at the three samples of either end that of the integrator.

    An impact is over within a sample or two. Its force at the samples alone misses its impulse or counts it
    twice, which no filter mends; the lag is continuous and holds the impulse and its moment.
    """
    count, ends = len(e), len(_BEND) // 2
    if count < len(_BEND):
        return a
    bent = sum(c * e[k : count - 2 * ends + k] for k, c in enumerate(_BEND))
    return a.at[ends:-ends].set(bent / step**2)


def _pressed(torque: jax.Array, k: jax.Array, hard: jax.Array) -> jax.Array:
    """Twist at which a spring k e + hard e^3 holds a torque, by Newton's steps from that of a straight one."""

    def closer(_, e):
        return e - (k * e + hard * e**3 - torque) / (k + 3.0 * hard * e**2)

    return jax.lax.fori_loop(0, _NEWTON, closer, torque / k)


def contact_stiffness(
    inertia: jax.Array | np.ndarray, frequency: jax.Array | float
) -> tuple[jax.Array, jax.Array]:
    """Stiffness and damping of a closed gear, on which a link of inertia (T,) swings at a frequency [Hz].

    Arrays of NumPy give numbers of NumPy.
    """
    arrays = np if isinstance(inertia, np.ndarray) else jnp
    m, w = arrays.median(arrays.abs(inertia)) + 1e-9, 2 * np.pi * frequency
    return m * w**2, 2 * _CONTACT_DAMPING * m * w
