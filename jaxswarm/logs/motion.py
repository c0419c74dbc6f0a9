r"""From a log to the motion a model is evaluated on: uniform clock, filtered, differentiated.

Steps of :func:`prepare`: put irregular samples on a uniform clock (cubic for positions, linear for
torque), low-pass the positions where they become noise, differentiate, keep a working rate of at least
eight times the motion's band, and design the decimator that torque and model columns share.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from jaxswarm.logs.bands import TORQUE_BAND, Band, checked_cutoff, find_band
from jaxswarm.logs.bridging import bridged, lost_rows, lost_samples
from jaxswarm.logs.encoder import between_counts
from jaxswarm.logs.filtering import Decimator, derivatives, design_decimator, white_noise
from jaxswarm.logs.log import Log
from jaxswarm.logs.resampling import (
    bridged_samples,
    earlier,
    resample,
    stride_for,
    thin,
    uniform_clock,
)
from jaxswarm.logs.smoothing import smooth


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
        weight_skew: Time by which the weight within that torque lags by itself [s]: a slower computer tells
            it, and holds it until it tells the next one.
    """

    motion_cutoff: float | None = None
    torque_cutoff: float | None = None
    use_logged_velocity: bool | None = None
    skew: float = 0.0
    weight_skew: float = 0.0


@dataclass(frozen=True)
class Motion:
    """A log on its working clock, ready for a model.

    Attributes:
        source: Where it came from.
        joints: Names, n of them.
        t: Working clock [s], shape (T,), uniform.
        q, dq, ddq: Filtered motion, shape (T, n).
        tau: Measured torque on the same clock, (T, n), or None.
        channels: Further channels on the same clock, those with a column (T, n) for every joint: no law reads
            one that belongs to no joint, such as the temperature of a room.
        decimator: The low-pass and decimation shared by torque and columns.
        motion_cutoff: The low-pass of every joint's motion [Hz], (n,).
        torque_cutoff: That of torque and columns [Hz].
        asked: What was asked for.
        position_noise: Standard deviation of the white noise of every joint's position on the working
            clock, before smoothing [rad or m], (n,); None: unknown.
        velocity_ratio: Its variance over that of the logged velocity [s^2], (n,); None: none was used.
        interval: Median sampling interval of the log [s].
        skew: Time by which the motion was moved against the torque [s].
        weight_skew: Time by which the weight lags in the torque beyond that [s].
        torque_noise: Standard deviation of the torque's noise below the torque cutoff [N m or N],
            (n,): that of the sample-to-sample noise, taken as white; None without torque.
        model_noise: What the doubt of the motion makes of a model's torque on every decimated row,
            (T', n) [N m or N]; None: not known yet.
        sharp_noise: What is sharper than the motion is known makes of it, likewise.
        steady_noise: Below the torque cutoff, what is as strong at all times there or just above and not
            made by the doubt of the motion [N m or N], (n,); NaN: too short to tell; None: not known yet.
        bounded_noise: ``torque_noise`` or, where clearly less, what a model leaves beside the cutoff, (n,).
        jump_noise: What the times of jumps of the torque, unknown between samples, make of it, likewise.
        event_noise: What joints that stick and samples that are missing make of it beyond that, likewise.
        bridged: Whether a sample of the working clock lies where the log has none, (T,); None: nowhere.
        lost: Whether a sample of the working clock lies in a gap that is short against the motion: what stands
            there is put in, (T,); None: nowhere.
        held: Whether a joint stands on a decimated row, held by dry friction at a torque that no law tells,
            (T', n); None: not known yet.
        loose: How much a decimated row counts where friction holds a joint, (T', n); None: all of each.
        driven: Whether a drive's torque was sampled beside it, so that dry friction may turn between two
            samples of a fast reversal; of a made motion it is known at every sample.
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
    weight_skew: float = 0.0
    asked: Filtering = Filtering()
    position_noise: np.ndarray | None = None
    velocity_ratio: np.ndarray | None = None
    model_noise: np.ndarray | None = None
    sharp_noise: np.ndarray | None = None
    steady_noise: np.ndarray | None = None
    bounded_noise: np.ndarray | None = None
    jump_noise: np.ndarray | None = None
    event_noise: np.ndarray | None = None
    bridged: np.ndarray | None = None
    lost: np.ndarray | None = None
    held: np.ndarray | None = None
    loose: np.ndarray | None = None
    driven: bool = False

    @property
    def filtering(self) -> Filtering:
        """How another log has to be prepared to be compared with this one."""
        return replace(
            self.asked,
            torque_cutoff=self.torque_cutoff,
            skew=self.skew,
            weight_skew=self.weight_skew,
        )

    @property
    def rate(self) -> float:
        """Working rate [Hz]."""
        return 1.0 / (self.t[1] - self.t[0])

    @property
    def sensor_noise(self) -> np.ndarray:
        """Noise of the torque below its cutoff as far as it is known, (n,)."""
        assert self.torque_noise is not None, f"{self.source} has no torque"
        return self.torque_noise if self.bounded_noise is None else self.bounded_noise

    @property
    def low_torque(self) -> np.ndarray:
        """The measured torque below the torque cutoff, on the decimated clock, (T', n)."""
        assert self.tau is not None, f"{self.source} has no torque"
        return self.decimator.apply(self.tau)

    @property
    def lost_rows(self) -> np.ndarray:
        """Decimated rows that see too much of gaps, (T',): neither fitted nor scored."""
        return lost_rows(self.lost, self.decimator, len(self.t))

    @property
    def known_torque(self) -> np.ndarray:
        """:attr:`low_torque` as pictures show it: NaN in rows that are lost, where a line ends, (T', n)."""
        return np.where(self.lost_rows[:, None], np.nan, self.low_torque)

    def __repr__(self) -> str:
        return f"Motion({self.source!r}, {len(self.t)} samples at {self.rate:.4g} Hz)"


def prepare(log: Log, filtering: Filtering | None = None) -> Motion:
    """Turn a log into the :class:`Motion` a model is evaluated on.

    Args:
        log: A checked log.
        filtering: Frequencies to use instead of those found from the data.

    Raises:
        InputError: If the log is too short to filter.
    """
    filtering = filtering or Filtering()
    log, full_clock, rate = uniform_clock(log)

    def resampled(x: np.ndarray, clock: np.ndarray = full_clock) -> np.ndarray:
        return resample(log.t, np.asarray(x, dtype=float), clock, cubic=False)

    measured = None if log.tau is None else resampled(log.tau)
    q, logged, lost, band = _known(log, full_clock, rate, filtering, measured)
    torque_cutoff = checked_cutoff(log.source, band.torque, rate)
    stride = stride_for(log, len(full_clock), rate, band.motion.max())
    working, clock = rate / stride, full_clock[::stride]
    velocity = None if band.ratio is None or logged is None else thin(logged, rate, stride)
    q = smooth(thin(q, rate, stride), working, band.motion, velocity, band.ratio)
    dq, ddq = derivatives(q, working, 2)
    if log.ddq is not None:
        ddq = smooth(thin(resampled(log.ddq), rate, stride), working, band.motion)
    decimator = design_decimator(working, torque_cutoff)
    if len(decimator.kept(len(clock))) < 10:
        decimator = Decimator(np.ones(1), 1)
    tau = noise = None
    if measured is not None:
        # Of a log too short to decimate nothing is taken off.
        passed = torque_cutoff / (0.5 * rate) if len(decimator.taps) > 1 else 1.0
        noise = white_noise(measured) * np.sqrt(passed)
        tau = thin(measured, rate, stride)
    own = clock - log.t[0]
    q, dq, ddq = (earlier(own, x, filtering.skew) for x in (q, dq, ddq))
    return Motion(
        source=log.source,
        joints=log.joints,
        t=own,
        q=q,
        dq=dq,
        ddq=ddq,
        tau=tau,
        channels={n: resampled(x, clock) for n, x in log.channels.items() if x.ndim == 2},
        decimator=decimator,
        motion_cutoff=tuple(map(float, band.motion)),
        torque_cutoff=float(torque_cutoff),
        interval=1.0 / rate,
        torque_noise=noise,
        notes=(*log.notes, *band.notes),
        skew=filtering.skew,
        weight_skew=filtering.weight_skew,
        asked=replace(filtering, skew=0.0, weight_skew=0.0),
        # Thinning keeps the density of the noise, not its variance.
        position_noise=band.noise / np.sqrt(stride),
        velocity_ratio=band.ratio,
        bridged=bridged_samples(log.t, clock, 1.0 / rate),
        lost=None if lost is None else lost[::stride],
        driven=True,
    )


def _known(
    log: Log, clock: np.ndarray, rate: float, filtering: Filtering, measured: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray | None, np.ndarray | None, Band]:
    """Positions and velocities (T, n) on a uniform clock, what of it is lost (T,), and the motion's band."""
    lost = lost_samples(log, clock)
    q = resample(log.t, between_counts(log.t, log.q), clock, cubic=True)
    logged = None
    if log.dq is not None and filtering.use_logged_velocity is not False:
        logged = resample(log.t, np.asarray(log.dq, dtype=float), clock, cubic=False)
    q, logged = bridged(q, logged, lost, rate)
    band = _band(filtering, find_band(q, rate, log.joints, logged, measured))
    return *bridged(q, logged, lost, rate, band.motion), lost, band


def _band(filtering: Filtering, found: Band) -> Band:
    """The frequencies asked for, else those found."""
    if filtering.motion_cutoff:
        motion = np.full(len(found.motion), filtering.motion_cutoff)
        torque = TORQUE_BAND * filtering.motion_cutoff
        found = replace(found, motion=motion, torque=torque)
    return replace(found, torque=filtering.torque_cutoff or found.torque)
