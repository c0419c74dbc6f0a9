r"""From a log to the motion a model is evaluated on: uniform clock, filtered, differentiated.

Steps of :func:`prepare`: put irregular samples on a uniform clock (cubic for positions, linear for
torque), low-pass the positions where they become noise, differentiate, keep a working rate of at least
eight times the motion's band, and design the decimator that torque and model columns share.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy import interpolate, signal

from jaxswarm.errors import InputError
from jaxswarm.logs.filtering import (
    Decimator,
    acceleration_valley,
    derivatives,
    design_decimator,
    energy_band,
    noise_floor,
    smooth,
    white_noise,
)
from jaxswarm.logs.log import Log
from jaxswarm.logs.sampling import usual_period

# Working rate per band of the motion: friction jumps where a joint reverses, and a jump between samples
# folds back into the band, which moves the sign's width and every delay.
_RATE = 16.0
# Motion is kept up to this multiple of the valley between motion and noise.
_MOTION_BAND = 1.3
# Share of the torque's variance that the compared band has to hold.
_TORQUE_ENERGY = 0.9999
# The torque is compared over this share of the band in which the motion is known.
_TORQUE_BAND = 0.6


# Samples that a spline of fifth order and the smoothing of a motion need at the working rate.
_LEAST_SAMPLES = 20
_LEAST_WORKING = 10
# The low-pass before thinning looks three filter lengths beyond either end.
_LEAST_THINNED = 28


class TooShort(InputError):
    """A log, or a stretch of one, with too few samples to filter."""


@dataclass(frozen=True)
class Filtering:
    """What to do with a log; None means: chosen from the data.

    Attributes:
        motion_cutoff: Zero-phase low-pass of positions [Hz].
        torque_cutoff: Shared low-pass of torque and columns [Hz].
        use_logged_velocity: Whether a logged ``dq`` is used in place of a differentiated ``q``.
        skew: Time by which the torque lags the positions [s], a fraction of the sampling interval: a
            torque that is sampled and held is late by up to half of it.
    """

    motion_cutoff: float | None = None
    torque_cutoff: float | None = None
    use_logged_velocity: bool | None = None
    skew: float = 0.0


@dataclass(frozen=True)
class Motion:
    """A log on its working clock, ready for a model.

    Attributes:
        source: Where it came from.
        joints: Names, n of them.
        t: Working clock [s], shape (T,), uniform.
        q, dq, ddq: Filtered motion, shape (T, n).
        tau: Measured torque on the same clock, (T, n), or None.
        channels: Further channels on the same clock.
        decimator: The low-pass and decimation shared by torque and columns.
        motion_cutoff, torque_cutoff: The frequencies used [Hz].
        interval: Median sampling interval of the log [s].
        skew: Time by which the motion was moved against the torque [s].
        torque_noise: Standard deviation of the torque's noise below the torque cutoff [N m or N],
            (n,): that of the sample-to-sample noise, taken as white; None without torque.
    """

    source: str
    joints: tuple[str, ...]
    t: np.ndarray
    q: np.ndarray
    dq: np.ndarray
    ddq: np.ndarray
    tau: np.ndarray | None
    channels: dict[str, np.ndarray]
    decimator: Decimator
    motion_cutoff: float
    torque_cutoff: float
    interval: float
    torque_noise: np.ndarray | None
    notes: tuple[str, ...] = field(default=())
    skew: float = 0.0

    @property
    def rate(self) -> float:
        """Working rate [Hz]."""
        return 1.0 / (self.t[1] - self.t[0])

    def __repr__(self) -> str:
        return f"Motion({self.source!r}, {len(self.t)} samples at {self.rate:.4g} Hz)"


def _uniform(log: Log) -> tuple[np.ndarray, float]:
    """A uniform clock at the log's usual rate, over the log's time."""
    step = usual_period(log.t)
    count = int(round((log.t[-1] - log.t[0]) / step)) + 1
    rate = (count - 1) / (log.t[-1] - log.t[0])
    return log.t[0] + np.arange(count) / rate, rate


def _resample(t: np.ndarray, x: np.ndarray, clock: np.ndarray, cubic: bool) -> np.ndarray:
    if len(t) == len(clock) and np.abs(t - clock).max() < 1e-3 * (clock[1] - clock[0]):
        return np.asarray(x, dtype=float)
    if cubic and np.isfinite(x).all():
        return interpolate.CubicSpline(t, x, axis=0)(clock)
    return interpolate.interp1d(t, x, axis=0)(np.clip(clock, t[0], t[-1]))


def prepare(log: Log, filtering: Filtering | None = None) -> Motion:
    """Turn a log into the :class:`Motion` a model is evaluated on.

    Args:
        log: A checked log.
        filtering: Frequencies to use instead of those found from the data.

    Raises:
        InputError: If the log is too short to filter.
    """
    filtering = filtering or Filtering()
    if len(log.t) < _LEAST_SAMPLES:
        raise TooShort(
            f"{log.source}: {len(log.t)} samples are too few to differentiate; log at least "
            f"{_LEAST_SAMPLES}"
        )
    full_clock, rate = _uniform(log)
    q = _resample(log.t, log.q, full_clock, cubic=True)
    motion_cutoff, torque_cutoff = _cutoffs(filtering, log, q, full_clock, rate)
    if not 0.0 < torque_cutoff <= 0.5 * rate:
        raise InputError(
            f"{log.source}: torque cutoff {torque_cutoff:g} Hz is outside (0, {0.5 * rate:g}] Hz, "
            "half the sampling rate; choose a lower one"
        )
    logged = None if log.dq is None else _resample(log.t, log.dq, full_clock, cubic=False)
    use_velocity = filtering.use_logged_velocity
    if use_velocity is None:
        use_velocity = logged is not None and _velocity_is_cleaner(q, logged, rate, motion_cutoff)
    stride = max(1, int(rate / (_RATE * motion_cutoff)))
    thinned_away = stride > 1 and len(full_clock) < _LEAST_THINNED
    if thinned_away or len(full_clock[::stride]) < _LEAST_WORKING:
        least = max(_LEAST_THINNED, _LEAST_WORKING * stride) / rate
        raise TooShort(
            f"{log.source}: {log.t[-1] - log.t[0]:.3g} s are too short for motion below "
            f"{motion_cutoff:.3g} Hz; log at least {least:.2g} s, or raise --motion-cutoff"
        )
    working = rate / stride
    clock = full_clock[::stride]
    q = smooth(_thin(q, rate, stride), working, motion_cutoff)
    dq, ddq = derivatives(q, working, 2)
    if use_velocity and logged is not None:
        dq = smooth(_thin(logged, rate, stride), working, motion_cutoff)
        ddq = derivatives(dq, working, 1)[0]
    if log.ddq is not None:
        given = _resample(log.t, log.ddq, full_clock, cubic=False)
        ddq = smooth(_thin(given, rate, stride), working, motion_cutoff)
    tau = noise = None
    if log.tau is not None:
        raw = _resample(log.t, log.tau, full_clock, cubic=False)
        noise = white_noise(raw) * np.sqrt(torque_cutoff / (0.5 * rate))
        tau = _thin(raw, rate, stride)
    decimator = design_decimator(working, torque_cutoff)
    if len(decimator.kept(len(clock))) < 10:
        decimator = Decimator(np.ones(1), 1)
    motion = Motion(
        source=log.source,
        joints=log.joints,
        t=clock - log.t[0],
        q=q,
        dq=dq,
        ddq=ddq,
        tau=tau,
        channels={
            name: _resample(log.t, np.asarray(x, dtype=float), clock, cubic=False)
            for name, x in log.channels.items()
        },
        decimator=decimator,
        motion_cutoff=float(motion_cutoff),
        torque_cutoff=float(torque_cutoff),
        interval=1.0 / rate,
        torque_noise=noise,
        notes=log.notes,
    )
    return shift_motion(motion, filtering.skew) if filtering.skew else motion


def _cutoffs(
    filtering: Filtering, log: Log, q: np.ndarray, clock: np.ndarray, rate: float
) -> tuple[float, float]:
    """Cutoffs [Hz] of motion and torque: those asked for, else found from the spectra."""
    motion = min(_MOTION_BAND * acceleration_valley(q, rate), 0.4 * rate)
    torque = _TORQUE_BAND * motion
    if log.tau is not None:
        # Above the band that holds the torque, errors of phase and structure are all there is.
        holds = energy_band(_resample(log.t, log.tau, clock, cubic=False), rate, _TORQUE_ENERGY)
        if holds < torque:
            torque, motion = holds, min(motion, 2.0 * holds)
    if filtering.motion_cutoff:
        motion, torque = filtering.motion_cutoff, _TORQUE_BAND * filtering.motion_cutoff
    return motion, filtering.torque_cutoff or torque


def shift_motion(motion: Motion, seconds: float) -> Motion:
    """The motion as it was ``seconds`` earlier, against an unmoved torque; a fraction of a sample."""

    def moved(x: np.ndarray) -> np.ndarray:
        return interpolate.CubicSpline(motion.t, x, axis=0)(motion.t - seconds)

    return replace(
        motion,
        q=moved(motion.q),
        dq=moved(motion.dq),
        ddq=moved(motion.ddq),
        skew=motion.skew + seconds,
    )


def _thin(x: np.ndarray, rate: float, stride: int) -> np.ndarray:
    """Keep every ``stride``-th sample, after a low-pass that removes what would fold back."""
    if stride == 1:
        return np.asarray(x, dtype=float)
    sections = signal.butter(6, 0.4 * rate / stride, fs=rate, output="sos")
    return signal.sosfiltfilt(sections, x, axis=0)[::stride]


def _velocity_is_cleaner(q: np.ndarray, dq: np.ndarray, rate: float, cutoff: float) -> bool:
    """Whether a logged velocity carries less noise below ``cutoff`` than the derivative of q.

    White position noise of density S gives S (2 pi)^2 cutoff^3 / 3 of velocity variance.
    """
    position, velocity = noise_floor(q, rate)[2], noise_floor(dq, rate)[2]
    return bool(np.median(velocity - position * (2.0 * np.pi * cutoff) ** 2 / 3.0) < 0.0)
