r"""Which frequencies of a log are used: where a motion is known, and over which band torques are compared.

A motion is kept up to :data:`MOTION_BAND` times the frequency at which it is as strong as its noise
(:func:`jaxswarm.logs.cutoffs.find_cutoffs`), joint by joint; where friction turns round it is sharper than
on the whole, and what is lost there is not won back. Noise that is not white, such as that of a filtered
or interpolated position, would make a likelihood trust all of it: the valley of the acceleration's spectrum
bounds the cutoff, but where the torque goes with what lies beyond it (:mod:`jaxswarm.logs.driven`), as with the
impacts in a gear. Torques are compared over :data:`TORQUE_BAND` of the band of the median joint up to its
valley, and no further than that of any joint that moves.

Where a velocity is logged, both channels make one motion: the position at low, the velocity at high
frequencies, by their noise. A velocity that is not the derivative of the position is left out, and told; so is
one that is late, as a filter makes it: its noise is not white, and beside it all of a torque seems to be early.
"""

from dataclasses import dataclass

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.cutoffs import find_cutoffs
from jaxswarm.logs.driven import driven_share
from jaxswarm.logs.filtering import acceleration_valley, derivatives, energy_band, noise_floor
from jaxswarm.logs.smoothing import smooth

# Measured on p01 and q01-q04 of the practice logs: 1.4 lowers the error on unseen motion of p01 by a third
# against 1.0 and moves that of the others by less than 3 %; 2.0 gains nothing further.
MOTION_BAND = 1.4
# Motion is kept up to this multiple of the valley between motion and noise.
_VALLEY_BAND = 1.3
# On the same logs the residual over the torque's noise is 0.94 to 1.14 at 0.6, and up to 1.5 at 1.0.
TORQUE_BAND = 0.6
# A joint moves if it goes through so many times the noise of its position.
_MOVES = 100.0
# Beyond the valley there is a motion, such as what impacts in a gear leave, where at least this share of the
# acceleration goes with the torque: 0.55 to 0.97 on 14 joints of MuJoCo logs with backlash, 0 to 0.36 on three,
# 0.70 to 0.99 on five of a TX40, 0.60 on EMPS, 0 to 0.07 on a UR10e, whose positions were interpolated.
_DRIVEN = 0.5
# Share of the torque's variance that the compared band has to hold.
_TORQUE_ENERGY = 0.9999
# A velocity may differ from the derivative of the position by this share of its size below the cutoff.
_SAME_VELOCITY = 0.02
# Stretches of a log that tell how late a velocity is, and the standard errors by which that has to be beyond
# half a sample, which a difference of two positions is late by.
_STRETCHES, _SURE = 20, 3.0


@dataclass(frozen=True)
class Band:
    """What of a log is used.

    Attributes:
        motion: Cutoff of every joint's motion [Hz], (n,).
        torque: Cutoff of the shared low-pass of torque and columns [Hz].
        ratio: Variance of the position's noise over that of the velocity's [s^2], (n,); None: no
            velocity is used.
        noise: Standard deviation of the position's white noise [rad or m], (n,).
        notes: Sentences on what was left out.
    """

    motion: np.ndarray
    torque: float
    ratio: np.ndarray | None
    noise: np.ndarray
    notes: tuple[str, ...]


def find_band(
    q: np.ndarray,
    rate: float,
    joints: tuple[str, ...],
    velocity: np.ndarray | None = None,
    torque: np.ndarray | None = None,
) -> Band:
    """Find the band of a uniformly sampled log.

    Args:
        q: Positions (T, n).
        rate: Sampling rate [Hz].
        joints: Their names.
        velocity: Logged velocities (T, n), where they may be used.
        torque: Torque (T, n), where it was logged.
    """
    found = find_cutoffs(q, rate)
    ratio: np.ndarray | None = None
    notes: tuple[str, ...] = ()
    if velocity is not None:
        ratio, notes = _velocity(q, velocity, rate, found.cutoff, joints)
        if ratio is not None:
            found = find_cutoffs(q, rate, velocity, ratio)
    motion = np.minimum(MOTION_BAND * found.cutoff, 0.4 * rate)
    known = motion  # where no noise can be taken for a motion
    if ratio is None:  # the valley is that of the position alone
        valley = acceleration_valley(q, rate)
        known = np.minimum(motion, _VALLEY_BAND * valley)
        motion = np.where(_driven(q, torque, rate, valley, found.cutoff), motion, known)
    compared = TORQUE_BAND / MOTION_BAND * float(np.median(known))
    # Where a joint's own motion is not known its torque follows what is not in the model: compared up to 1.5
    # times its band, a clean joint was told as a soft one at its noise, with a quarter of its squared error.
    moves = np.ptp(q, axis=0) > _MOVES * found.noise
    compared = min(compared, *known[moves]) if moves.any() else compared
    if torque is not None:
        # Above the band that holds the torque, errors of phase and structure are all there is.
        compared = min(compared, energy_band(torque, rate, _TORQUE_ENERGY))
    return Band(motion, compared, ratio, found.noise, notes)


def checked_cutoff(source: str, cutoff: float, rate: float) -> float:
    """The cutoff [Hz] of the torque, which a log at this rate [Hz] has to allow.

    Raises:
        InputError: If it is beyond half the rate.
    """
    if not 0.0 < cutoff <= 0.5 * rate:
        raise InputError(
            f"{source}: torque cutoff {cutoff:g} Hz is outside (0, {0.5 * rate:g}] Hz, "
            "half the sampling rate; choose a lower one"
        )
    return cutoff


def _driven(
    q: np.ndarray, torque: np.ndarray | None, rate: float, valley: np.ndarray, cutoff: np.ndarray
) -> np.ndarray:
    """Joints (n,) whose torque goes with most of what lies between their valley and their cutoff."""
    driven = np.zeros(len(cutoff), dtype=bool)
    if torque is not None:
        for j in np.flatnonzero(cutoff > valley):
            share = driven_share(q[:, j], torque[:, j], rate, valley[j], cutoff[j])
            driven[j] = share > _DRIVEN
    return driven


def _velocity(
    q: np.ndarray, velocity: np.ndarray, rate: float, cutoff: np.ndarray, joints: tuple[str, ...]
) -> tuple[np.ndarray | None, tuple[str, ...]]:
    """The noise of the positions over that of the velocities, where both tell one motion."""
    low = smooth(q, rate, cutoff)
    own = derivatives(low, rate, 1)[0]
    given = smooth(velocity, rate, cutoff)
    inside = slice(int(0.02 * len(q)), -int(0.02 * len(q)) or None)
    size = np.sqrt(np.mean(own[inside] ** 2, axis=0))
    apart = np.sqrt(np.mean((given - own)[inside] ** 2, axis=0))
    position, speed = noise_floor(q, rate)[2], noise_floor(velocity, rate)[2]
    # What noise of both channels makes of the difference below the cutoff.
    noise = np.sqrt(position * (2.0 * np.pi) ** 2 * cutoff**3 / 3.0 + speed * cutoff)
    wrong = apart > np.maximum(_SAME_VELOCITY * size, 3.0 * noise)
    if wrong.any():
        names = ", ".join(joints[j] for j in np.flatnonzero(wrong))
        share = float((apart / np.maximum(size, 1e-300))[wrong].max())
        return None, (
            f"dq of {names} is not the derivative of q (it differs by {100 * share:.3g} % of its size): "
            "logged velocities are not used",
        )
    late, doubt = _lateness(given[inside] - own[inside], own[inside], rate)
    slow = np.abs(late) - _SURE * doubt > 0.5 / rate
    if slow.any():
        names = ", ".join(joints[j] for j in np.flatnonzero(slow))
        usual = 1e3 * float(np.median(late[slow]))
        how = "late against q, as a filter makes it" if usual > 0.0 else "early against q"
        return None, (
            f"dq of {names} is {abs(usual):.3g} ms {how}: logged velocities are not used",
        )
    if (speed <= 0.0).any() or (position <= 0.0).any():
        return None, ()
    return position / speed, ()


def _lateness(apart: np.ndarray, own: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Time [s] by which velocities are late, and its standard error over stretches of a log, each (n,).

    Args:
        apart: What they are more than the derivatives of positions (T, n).
        own: These, (T, n): to first order ``apart`` is ``-late`` times their change.
        rate: Sampling rate [Hz].
    """
    change = derivatives(own, rate, 1)[0]
    square = np.maximum((change**2).sum(axis=0), 1e-300)
    late = -(change * apart).sum(axis=0) / square
    parts = np.array_split(change * (apart + late * change), _STRETCHES)
    return late, np.sqrt(sum(part.sum(axis=0) ** 2 for part in parts)) / square
