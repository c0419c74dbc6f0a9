"""A plain identification of this suite's own: zero-phase filters, Pinocchio's regressor, least squares.

It serves as the oracle (declared model fitted with the undeclared torque known) whose error on unseen
motion is the floor every other error is divided by, and as the base the rivals start from. It knows what no
user knows: the widths of the sign and the lag of the torque channel.
"""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage, signal

from benchmarks.worlds.rigid import Absorber, declared_columns, rms

# Cutoffs [Hz]: of the motion (the one that leaves least on the fitted log is taken), and of the comparison.
MOTION, BAND = (8.0, 15.0, 30.0, 60.0), 8.0
# Cutoffs at most, in sampling rates.
_SHARE = 0.35
ENDS = 0.5  # s at both ends that filters reach
_SPIKE = 8.0  # median absolute deviations from a running median


@dataclass(frozen=True)
class Prepared:
    """A log on a uniform clock, filtered: states (T, n), torque (T, n), and known undeclared torque."""

    t: np.ndarray
    q: np.ndarray
    dq: np.ndarray
    ddq: np.ndarray
    tau: np.ndarray
    effect: np.ndarray
    rate: float


def low_pass(x: np.ndarray, rate: float, cutoff: float) -> np.ndarray:
    """Fourth-order zero-phase low-pass along time."""
    sections = signal.butter(2, min(cutoff, _SHARE * rate), fs=rate, output="sos")
    return signal.sosfiltfilt(sections, x, axis=0)


def inner(x: np.ndarray, rate: float) -> np.ndarray:
    """Without the ends that filters reach."""
    cut = int(ENDS * rate)
    return x[cut:-cut]


def band_noise(world) -> np.ndarray:
    """RMS of the torque noise below the band errors are compared in, (n,)."""
    rate = world.logging.rate
    noise = np.hypot(1.0, world.logging.coarse / np.sqrt(12.0)) * world.logging.noise
    return noise * np.sqrt(min(BAND, _SHARE * rate) / (0.5 * rate))


def prepare(world, log: dict, hidden: dict, cutoff: float) -> Prepared:
    """Filter a log; the lag of its torque channel and the hold of the torque over a tick are undone."""
    rate = float(world.logging.rate)
    t = np.arange(log["t"][0], log["t"][-1] + 1e-9, 1.0 / rate)
    lag = world.logging.lag - 0.5 / world.control.rate
    tau = log["tau"]
    smooth = ndimage.median_filter(tau, size=(5, 1))
    spread = np.median(np.abs(tau - smooth), axis=0) + world.logging.noise
    tau = np.where(np.abs(tau - smooth) > _SPIKE * spread, smooth, tau)

    def on(x, late=0.0):
        return np.column_stack([np.interp(t + late, log["t"], column) for column in x.T])

    q = low_pass(on(log["q"]), rate, cutoff)
    dq = np.gradient(q, 1.0 / rate, axis=0)
    ddq = np.gradient(dq, 1.0 / rate, axis=0)
    tau, effect = on(tau, lag), on(hidden["tau_effect"])
    return Prepared(t, q, dq, ddq, tau, effect, rate)


def band_columns(columns: np.ndarray, rate: float) -> np.ndarray:
    """Columns below the band, thinned to what it holds, without the ends, (T', n, p)."""
    return inner(low_pass(columns, rate, BAND), rate)[:: max(1, int(rate / (5 * BAND)))]


class Plain:
    """The declared model with values fitted to a training log.

    ``known``: undeclared torque that is taken away before the fit, (T, n), or None.
    """

    def __init__(self, world, train: Prepared, known: np.ndarray | None = None):
        self.arm, self.declared = world.arm, world.declared
        self.noise, self.rate = world.logging.noise, train.rate
        self.columns = band_columns(self.raw(train), train.rate)
        self.absorber = Absorber(self.columns, self.noise)
        tau = train.tau if known is None else train.tau - known
        self.target = band_columns(tau[:, :, None], train.rate)[:, :, 0]
        self.values = self.absorber.fit(self.target)

    def raw(self, log: Prepared) -> np.ndarray:
        """Columns along a log before they are filtered, (T, n, p)."""
        return declared_columns(self.arm, self.declared, log.q, log.dq, log.ddq)

    @property
    def left(self) -> np.ndarray:
        """What the fit leaves of the training log, below the band, (T', n)."""
        return self.absorber.left(self.target)


def best_cutoff(world, log: dict, hidden: dict, known: bool) -> float:
    """The cutoff of the motion that leaves least of the training log, weighted by the noise."""

    def cost(cutoff):
        train = prepare(world, log, hidden, cutoff)
        left = Plain(world, train, train.effect if known else None).left
        return float(rms(left / world.logging.noise).sum())

    usable = [c for c in MOTION if c < _SHARE * world.logging.rate] or [MOTION[0]]
    return min(usable, key=cost)


def oracle_error(world, logs: dict[str, tuple]) -> dict[str, np.ndarray]:
    """Error per joint of the oracle on each log ``name: (log, hidden)``, below the band."""
    cutoff = best_cutoff(world, *logs["train"], known=True)
    train = prepare(world, *logs["train"], cutoff)
    oracle = Plain(world, train, train.effect)
    errors = {}
    for name, (log, hidden) in logs.items():
        clean = prepare(world, {**log, "tau": hidden["tau_clean"]}, hidden, cutoff)
        rest = clean.tau - clean.effect - oracle.raw(clean) @ oracle.values
        errors[name] = rms(inner(low_pass(rest, clean.rate, BAND), clean.rate))
    return errors


def prediction_error(t: np.ndarray, predicted: np.ndarray, clean: np.ndarray, rate: float):
    """RMS per joint of a prediction against the torque without noise, below the band, (n,)."""
    grid = np.arange(t[0], t[-1] + 1e-9, 1.0 / rate)
    rest = predicted - clean
    rest = np.column_stack([np.interp(grid, t, column) for column in rest.T])
    return rms(inner(low_pass(rest, rate, BAND), rate))
