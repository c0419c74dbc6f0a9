r"""From a log to the motion a model is evaluated on: uniform clock, filtered, differentiated.

Steps of :func:`prepare`: put irregular samples on a uniform clock (cubic for positions, linear for
torque), low-pass the positions where they become noise, differentiate, keep a working rate of at least
eight times the motion's band, and design the decimator that torque and model columns share.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy import interpolate

from jaxswarm.errors import InputError
from jaxswarm.logs.bands import TORQUE_BAND, Band, find_band
from jaxswarm.logs.clock import with_sample_times
from jaxswarm.logs.encoder import between_counts
from jaxswarm.logs.filtering import Decimator, derivatives, design_decimator, white_noise
from jaxswarm.logs.log import Log
from jaxswarm.logs.sampling import usual_period
from jaxswarm.logs.smoothing import smooth

# Working rate per band of the motion: friction jumps where a joint reverses, and a jump between samples
# folds back into the band, which moves the sign's width and every delay.
_RATE = 16.0


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
        motion_cutoff: Zero-phase low-pass of positions [Hz], the same for every joint and log; None: of
            every joint and log its own.
        torque_cutoff: Shared low-pass of torque and columns [Hz].
        use_logged_velocity: Whether a logged ``dq`` is used beside ``q``; None: where both tell one
            motion.
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
        motion_cutoff: The low-pass of every joint's motion [Hz], (n,).
        torque_cutoff: That of torque and columns [Hz].
        asked: What was asked for.
        position_noise: Standard deviation of the white noise of every joint's position on the working
            clock, before smoothing [rad or m], (n,); None: unknown.
        velocity_ratio: Its variance over that of the logged velocity [s^2], (n,); None: none was used.
        interval: Median sampling interval of the log [s].
        skew: Time by which the motion was moved against the torque [s].
        torque_noise: Standard deviation of the torque's noise below the torque cutoff [N m or N],
            (n,): that of the sample-to-sample noise, taken as white; None without torque.
        model_noise: What the doubt of the motion makes of a model's torque on every decimated row,
            (T', n) [N m or N]; None: not known yet.
        sharp_noise: What is sharper than the motion is known makes of it, likewise.
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
    motion_cutoff: tuple[float, ...]
    torque_cutoff: float
    interval: float
    torque_noise: np.ndarray | None
    notes: tuple[str, ...] = field(default=())
    skew: float = 0.0
    asked: Filtering = Filtering()
    position_noise: np.ndarray | None = None
    velocity_ratio: np.ndarray | None = None
    model_noise: np.ndarray | None = None
    sharp_noise: np.ndarray | None = None

    @property
    def filtering(self) -> Filtering:
        """How another log has to be prepared to be compared with this one."""
        return replace(self.asked, torque_cutoff=self.torque_cutoff, skew=self.skew)

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
    log = with_sample_times(log)
    full_clock, rate = _uniform(log)
    q = _resample(log.t, between_counts(log.t, log.q), full_clock, cubic=True)
    logged = None
    if log.dq is not None and filtering.use_logged_velocity is not False:
        logged = _resample(log.t, log.dq, full_clock, cubic=False)
    measured = None if log.tau is None else _resample(log.t, log.tau, full_clock, cubic=False)
    band = _band(filtering, find_band(q, rate, log.joints, logged, measured))
    torque_cutoff = band.torque
    if not 0.0 < torque_cutoff <= 0.5 * rate:
        raise InputError(
            f"{log.source}: torque cutoff {torque_cutoff:g} Hz is outside (0, {0.5 * rate:g}] Hz, "
            "half the sampling rate; choose a lower one"
        )
    stride = max(1, int(rate / (_RATE * band.motion.max())))
    thinned_away = stride > 1 and len(full_clock) < _LEAST_THINNED
    if thinned_away or len(full_clock[::stride]) < _LEAST_WORKING:
        least = max(_LEAST_THINNED, _LEAST_WORKING * stride) / rate
        raise TooShort(
            f"{log.source}: {log.t[-1] - log.t[0]:.3g} s are too short for motion below "
            f"{band.motion.max():.3g} Hz; log at least {least:.2g} s, or raise --motion-cutoff"
        )
    working = rate / stride
    clock = full_clock[::stride]
    velocity = None if band.ratio is None else _thin(logged, rate, stride)
    q = smooth(_thin(q, rate, stride), working, band.motion, velocity, band.ratio)
    dq, ddq = derivatives(q, working, 2)
    if log.ddq is not None:
        given = _resample(log.t, log.ddq, full_clock, cubic=False)
        ddq = smooth(_thin(given, rate, stride), working, band.motion)
    tau = noise = None
    if measured is not None:
        noise = white_noise(measured) * np.sqrt(torque_cutoff / (0.5 * rate))
        tau = _thin(measured, rate, stride)
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
        motion_cutoff=tuple(map(float, band.motion)),
        torque_cutoff=float(torque_cutoff),
        interval=1.0 / rate,
        torque_noise=noise,
        notes=(*log.notes, *band.notes),
        asked=replace(filtering, skew=0.0),
        # Thinning keeps the density of the noise, not its variance.
        position_noise=band.noise / np.sqrt(stride),
        velocity_ratio=band.ratio,
    )
    return shift_motion(motion, filtering.skew) if filtering.skew else motion


def _band(filtering: Filtering, found: Band) -> Band:
    """The frequencies asked for, else those found."""
    if filtering.motion_cutoff:
        motion = np.full(len(found.motion), filtering.motion_cutoff)
        torque = TORQUE_BAND * filtering.motion_cutoff
        found = replace(found, motion=motion, torque=torque)
    return replace(found, torque=filtering.torque_cutoff or found.torque)


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
    from scipy import signal  # loads for half a second what a log at a low rate does not need

    sections = signal.butter(6, 0.4 * rate / stride, fs=rate, output="sos")
    return signal.sosfiltfilt(sections, x, axis=0)[::stride]
