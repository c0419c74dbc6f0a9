r"""Zero-phase filtering, differentiation and decimation that treat both sides of the model alike.

A torque model is compared with data only where its motion is known. Positions carry noise of spectral
density :math:`S_n`; two differentiations amplify it by :math:`(2\pi f)^4`. Above the valley of the
acceleration's spectrum (:func:`acceleration_valley`) it is noise,
so the motion is low-passed below it (:mod:`jaxswarm.logs.smoothing`, no phase), and torque *and* every
model column pass the same decimating low-pass below it (:class:`Decimator`): the "parallel filter" of
M. Gautier, "Dynamic identification of robots with power model", ICRA 1997.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy

from jaxswarm.logs.smoothing import WHOLE_BAND

# Densities within this factor of the lowest count as the valley's floor.
_FLAT = 1.5


def derivatives(x: np.ndarray, rate: float, order: int) -> list[np.ndarray]:
    """Derivatives 1 to ``order`` of a smooth, uniformly sampled signal, by a quintic spline.

    >>> first, second = derivatives(np.arange(8.0) ** 2, 1.0, 2)
    >>> np.allclose(first, 2 * np.arange(8.0)), np.allclose(second, 2.0)
    (True, True)
    """
    clock = np.arange(len(x)) / rate
    spline = scipy.interpolate.make_interp_spline(clock, x, k=5)
    return [spline.derivative(k)(clock) for k in range(1, order + 1)]


def acceleration_valley(position: np.ndarray, rate: float) -> np.ndarray:
    """Find the frequency [Hz] at which differentiation noise overtakes a motion, joint by joint.

    The density of the acceleration, that of the position times (2 pi f)^4, falls with the motion and
    rises again with the noise; its lowest stretch, in third-octave averages, lies between them whether
    the noise is white, quantized or colored. The end of that stretch is returned: before it the
    density may dip between the harmonics of a motion.

    Args:
        position: Shape (T,) or (T, n).
        rate: Sampling rate [Hz].

    Returns:
        Shape (n,); 47.5 % of the sampling rate for a joint at rest.
    """
    frequency, density, _ = noise_floor(position, rate)
    density = density * (2.0 * np.pi * frequency[:, None]) ** 4
    grid = np.geomspace(max(4.0 * frequency[1], 1e-9), 0.45 * rate, 60)
    valleys = np.full(density.shape[1], WHOLE_BAND * rate)
    for j, power in enumerate(density.T):
        if power[1:].max(initial=0.0) <= 0.0:
            continue
        near = [(frequency >= f / 1.19) & (frequency <= f * 1.19) for f in grid]
        average = np.array([power[m].mean() if m.any() else np.inf for m in near])
        # Motion peaks in the low decade of the band; the valley comes after.
        peak = int(np.argmax(np.where(grid <= 10.0 * grid[0], average, 0.0)))
        low = np.flatnonzero(average[peak:] <= _FLAT * average[peak:].min())
        valleys[j] = grid[peak + low[-1]]
    return valleys


def noise_floor(x: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Power density of a signal and of its noise, the median over the upper half of the band.

    Args:
        x: Shape (T,) or (T, n).
        rate: Sampling rate [Hz].

    Returns:
        Frequencies (m,), densities (m, n), floors (n,), densities in the signal's unit^2/Hz.
    """
    columns = np.asarray(x, dtype=float).reshape(len(x), -1)
    frequency, density = power_density(columns, rate, min(len(columns), int(4 * rate)))
    return frequency, density, np.median(density[frequency > 0.25 * rate], axis=0)


def power_density(x: np.ndarray, rate: float, length: int) -> tuple[np.ndarray, np.ndarray]:
    """Power density of a signal (T, n) by Welch's method: frequencies (m,) and unit^2/Hz, (m, n).

    Segments of ``length`` samples that overlap by half, freed of their straight line, Hann window. What
    :mod:`scipy.signal` has for it takes, with all it loads, a tenth of a short command's time.
    """
    frequency, spectra = stretch_spectra(x, rate, length)
    total, count = np.zeros((len(frequency), x.shape[1])), 0
    for density in spectra:
        total += density
        count += 1
    return frequency, total / count


def stretches(count: int, length: int) -> Iterator[slice]:
    """Stretches of a signal of so many samples that overlap by half.

    >>> [(s.start, s.stop) for s in stretches(10, 4)]
    [(0, 4), (2, 6), (4, 8), (6, 10)]
    """
    for start in range(0, count - length + 1, length - length // 2):
        yield slice(start, start + length)


def stretch_spectra(
    x: np.ndarray, rate: float, length: int
) -> tuple[np.ndarray, Iterator[np.ndarray]]:
    """Frequencies (m,) and, stretch by stretch, the power densities (m, n) that :func:`power_density` averages.

    One stretch at a time: together they take twice the memory of the log.
    """
    window = np.sin(np.pi * np.arange(length) / length) ** 2
    line = np.stack([np.ones(length), np.linspace(-1.0, 1.0, length)], axis=1)
    line, _ = np.linalg.qr(line)
    # Only zero and half the rate have no twin among the negative frequencies.
    twins = np.full(length // 2 + 1, 2.0)
    twins[[0, -1] if length % 2 == 0 else [0]] = 1.0
    scale = twins[:, None] / (rate * (window**2).sum())

    def spectra() -> Iterator[np.ndarray]:
        for rows in stretches(len(x), length):
            part = x[rows]
            part = (part - line @ (line.T @ part)) * window[:, None]
            yield scale * np.abs(np.fft.rfft(part, axis=0)) ** 2

    return np.fft.rfftfreq(length, 1.0 / rate), spectra()


def white_noise(x: np.ndarray) -> np.ndarray:
    """Standard deviation of the sample-to-sample noise of every column of a signal (T, n), shape (n,).

    From the median absolute third difference, which neither the signal's slow course nor its rare
    jumps move.

    >>> noise = np.random.default_rng(0).normal(size=(4000, 1))
    >>> bool(abs(white_noise(0.1 * noise + np.linspace(0, 9, 4000)[:, None])[0] - 0.1) < 0.01)
    True
    """
    usual = [np.median(np.abs(np.diff(column, 3))) for column in x.T]
    return 1.4826 * np.array(usual) / np.sqrt(20.0)


def energy_band(x: np.ndarray, rate: float, share: float) -> float:
    """Frequency [Hz] below which every column of a signal holds the given share of its variance.

    >>> t = np.arange(0, 20, 0.01)
    >>> 2.0 < energy_band(np.sin(2 * np.pi * 2 * t)[:, None], 100.0, 0.99) < 3.0
    True
    """
    frequency, density, _ = noise_floor(x, rate)
    growing = np.cumsum(density, axis=0)
    reached = np.argmax(growing >= share * np.maximum(growing[-1], 1e-300), axis=0)
    return float(frequency[reached].max())


@dataclass(frozen=True)
class Decimator:
    """A symmetric FIR low-pass followed by keeping every ``factor``-th sample; no phase.

    Attributes:
        taps: Odd number of filter coefficients that sum to one.
        factor: Every how many samples one is kept.
    """

    taps: np.ndarray
    factor: int

    @property
    def margin(self) -> int:
        """Samples lost at either end, where the filter would need data from outside the log."""
        return len(self.taps) // 2

    def kept(self, length: int) -> np.ndarray:
        """Return the indices of the samples kept of a signal of the given length."""
        return np.arange(self.margin, length - self.margin, self.factor)

    def blocks(self, length: int, samples: int) -> Iterator[slice]:
        """Stretches of about so many samples of a signal, that overlap as the filter needs.

        What :meth:`apply` gives of each in turn is what it gives of the whole.

        >>> low = Decimator(np.ones(5) / 5, 3)
        >>> x = np.arange(50.0) ** 2
        >>> parts = [low.apply(x[part]) for part in low.blocks(50, 16)]
        >>> len(parts), bool(np.array_equal(np.concatenate(parts), low.apply(x)))
        (4, True)
        """
        taps = len(self.taps)
        rows, each = (length - taps) // self.factor + 1, max(1, (samples - taps) // self.factor + 1)
        for first in range(0, rows, each):
            last = min(first + each, rows) - 1
            yield slice(first * self.factor, last * self.factor + taps)

    def apply(self, x: np.ndarray) -> np.ndarray:
        """Filter and decimate along the first axis: (T, ...) -> (len(kept(T)), ...)."""
        if len(self.taps) == 1:
            return np.asarray(x)[:: self.factor]
        flat = np.asarray(x, dtype=float).reshape(len(x), -1)
        # Only what is kept is computed, on a view: three to ten times faster than by Fourier transform.
        spans = np.lib.stride_tricks.sliding_window_view(flat, len(self.taps), axis=0)
        low = spans[:: self.factor] @ self.taps
        return low.reshape(-1, *np.shape(x)[1:])


def design_decimator(rate: float, cutoff: float, oversampling: float = 2.5) -> Decimator:
    """Design the low-pass at ``cutoff`` [Hz] and the decimation to about ``oversampling * cutoff``.

    Kaiser window, 70 dB, transition of half the cutoff. A cutoff near the Nyquist frequency gives the
    identity.
    """
    if cutoff >= 0.4 * rate:
        return Decimator(np.ones(1), 1)
    taps = _low_pass(cutoff / (0.5 * rate), 70.0, 0.5 * cutoff / (0.5 * rate))
    # A rate that is off by rounding must not change the factor.
    return Decimator(taps / taps.sum(), max(1, int(rate / (oversampling * cutoff) + 0.01)))


def _low_pass(cutoff: float, ripple: float, width: float) -> np.ndarray:
    """Taps of a low-pass by Kaiser's window, an odd number of them.

    J. F. Kaiser, Proc. IEEE Int. Symp. Circuits and Systems (1974).

    Args:
        cutoff, width: Half-amplitude frequency and transition, as shares of half the sampling rate.
        ripple: Attenuation [dB], above 50.
    """
    length = int(np.ceil((ripple - 7.95) / 2.285 / (np.pi * width) + 1)) | 1
    place = np.arange(length) - 0.5 * (length - 1)
    return np.sinc(cutoff * place) * np.kaiser(length, 0.1102 * (ripple - 8.7))
