r"""The smoothest motion that the data support: penalized least squares with the penalty found from the data.

The position y is the minimizer of

.. math:: \|q - y\|^2 + \rho\,\|\dot q - D y\|^2 + \lambda\,\|\Delta^4 y\|^2 ,

q the logged positions, :math:`\dot q` logged velocities where there are any, D a sixth-order difference,
:math:`\Delta^4` the fourth difference. Inside a log its response to q is
:math:`1/(1 + (\omega/\omega_c)^8)`, that of a fourth-order Butterworth filter run forward and backward; at
the ends it needs no made-up samples, where padding spoils accelerations (P. H. C. Eilers, Anal. Chem. 75
(2003)). :math:`\rho` is the ratio of the two channels' noise variances, so that each counts where it is the
cleaner one: a differentiated position at low, a measured velocity at high frequencies.

The minimizer is the posterior mean of a motion whose fourth difference is white, and :math:`\omega_c` is
where motion and noise are equally strong: the same smoothing is best for position, velocity and acceleration.
:mod:`jaxswarm.logs.cutoffs` finds it.
"""

from typing import NamedTuple

import numpy as np
import scipy

# Differences of the penalty, and the stencil of the velocity, sixth order in the sampling interval.
_PENALTY = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
_SLOPE = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
# Its one-sided forms at the first three samples; at the last three they are mirrored, with the other sign.
_SLOPE_AT_START = np.array(
    [
        np.linalg.solve(np.vander(np.arange(7.0) - k, increasing=True).T, np.eye(7)[1])
        for k in range(3)
    ]
)
# Above this share of the sampling rate there is nothing to smooth.
WHOLE_BAND = 0.475
# Below this share of the rate a motion is smoothed on fewer samples, so many in a period of its cutoff and at
# least so many in all: the condition of the system grows with the eighth power of their number in a period.
# With 125 a position [rad] was off by 4e-4, its acceleration by 20 times what the noise of its encoder makes.
_SPARSE, _SAMPLES, _FEWEST = 0.02, 16.0, 50
# Every how many-th sample is kept at most at a time, and up to which share of the lower rate what they say.
_THINNED, _KEPT = 12.0, 0.25
# Weight of the velocity beside the position at most, where both are per sample: beyond, the system loses its
# digits. Encoders and velocity channels of arms make a hundred.
_STRONGEST = 1e9


def smooth(
    x: np.ndarray,
    rate: float,
    cutoff: float | np.ndarray,
    velocity: np.ndarray | None = None,
    ratio: np.ndarray | None = None,
) -> np.ndarray:
    """Low-pass along the first axis without phase; see the module text.

    Args:
        x: Signal, shape (T, ...).
        rate: Sampling rate [Hz].
        cutoff: Frequency [Hz] at which the amplitude is halved, one or one per column; at or above
            47.5 % of the sampling rate a column without velocity is returned as it is.
        velocity: Measured derivative of ``x`` per second, (T, n).
        ratio: rho in s^2, variance of the noise of ``x`` over that of ``velocity``, (n,).

    >>> t = np.arange(0, 2, 0.01)
    >>> slow, fast = np.sin(2 * np.pi * t), np.sin(2 * np.pi * 40 * t)
    >>> bool(np.abs(smooth(slow + fast, 100.0, 10.0) - slow)[20:-20].max() < 1e-2)
    True
    """
    if len(x) <= 8:
        return np.array(x, dtype=float)
    flat = np.array(x, dtype=float).reshape(len(x), -1)
    cutoffs = np.broadcast_to(np.asarray(cutoff, dtype=float), flat.shape[1])
    rho = np.zeros(flat.shape[1]) if ratio is None else np.asarray(ratio)
    for one in sorted({*zip(cutoffs.tolist(), rho.tolist(), strict=True)}):
        own = (cutoffs == one[0]) & (rho == one[1])
        if one[0] >= WHOLE_BAND * rate and one[1] == 0.0:
            continue
        given = None if velocity is None else velocity[:, own]
        flat[:, own] = _smoothed(flat[:, own], given, rate, *one)
    return flat.reshape(np.shape(x))


def _smoothed(
    x: np.ndarray, velocity: np.ndarray | None, rate: float, cutoff: float, rho: float
) -> np.ndarray:
    """Columns (T, m) of one cutoff, on as many samples as the system keeps its digits with.

    A joint's motion is then the same beside a faster one, for whose sake all are sampled more often.
    """
    stride = 1.0 if cutoff >= _SPARSE * rate else min(rate / (_SAMPLES * cutoff), _THINNED)
    kept = int((len(x) - 1) / stride)
    if stride == 1.0 or kept < _FEWEST:
        return solve(x, velocity, rate, cutoff, rho).mean
    # From the first sample to the last one: nothing is prolonged. What would fold back is smoothed away before,
    # by the same least squares, which keep cubics up to the ends.
    clock, sparse = np.arange(float(len(x))), np.linspace(0.0, len(x) - 1.0, kept + 1)
    slower = rate / sparse[1]

    def thinned(signal: np.ndarray) -> np.ndarray:
        low = solve(signal, None, rate, _KEPT * slower, 0.0).mean
        return scipy.interpolate.make_interp_spline(clock, low, k=5)(sparse)

    given = None if velocity is None or rho == 0.0 else thinned(velocity)
    mean = _smoothed(thinned(x), given, slower, cutoff, rho)
    return scipy.interpolate.make_interp_spline(sparse, mean, k=5)(clock)


class Solution(NamedTuple):
    """The smoothed columns, half the log-determinant of the system, and the least sum of squares per column."""

    mean: np.ndarray
    half_log_det: float
    squares: np.ndarray


def solve(
    x: np.ndarray,
    velocity: np.ndarray | None,
    rate: float,
    cutoff: float,
    rho: float,
    known: np.ndarray | None = None,
) -> Solution:
    """Minimize the penalized squares for columns (T, m) that share cutoff and rho.

    Of a log with gaps only over the samples that are known, (T,): across the others goes the smoothest course.
    """
    weights = np.ones(len(x)) if known is None else known.astype(float)
    length = len(x)
    middle = x.mean(axis=0) if known is None else x[known].mean(axis=0)
    # What stands is kept to the last digit, where the system would lose six of them.
    x = (x - middle) * weights[:, None]
    weight = (2.0 * np.sin(np.pi * min(cutoff / rate, 0.5))) ** -8
    bands = _gram(_PENALTY, length, weight, 5 if rho == 0.0 else 7)
    bands[-1] += weights
    right = x.copy()
    if rho > 0.0:
        assert velocity is not None  # a ratio of noises is that of a logged velocity
        strength = min(rho * rate * rate, _STRONGEST)
        bands += _gram(_SLOPE, length, strength, 7)
        right += _transposed(_SLOPE, velocity[3:-3] / rate, length) * strength
        for row, columns, stencil in _ends(length):
            for i, a in enumerate(stencil):
                j = np.arange(i, 7)
                bands[6 - (j - i), columns[j]] += strength * a * stencil[j]
            right[columns] += strength * stencil[:, None] * velocity[row] / rate
    factor = scipy.linalg.cholesky_banded(bands, check_finite=False)
    mean = scipy.linalg.cho_solve_banded((factor, False), right, check_finite=False)
    squares = ((x - weights[:, None] * mean) ** 2).sum(axis=0) + weight * (
        np.diff(mean, 4, axis=0) ** 2
    ).sum(axis=0)
    if rho > 0.0:
        assert velocity is not None
        slope = sum(c * mean[k : length - 6 + k] for k, c in enumerate(_SLOPE))
        squares += strength * ((velocity[3:-3] / rate - slope) ** 2).sum(axis=0)
        for row, columns, stencil in _ends(length):
            squares += strength * (velocity[row] / rate - stencil @ mean[columns]) ** 2
    return Solution(mean + middle, float(np.log(factor[-1]).sum()), squares)


def _ends(length: int):
    """The velocity's rows at both ends of a log: sample, the seven positions it takes, their weights."""
    first = np.arange(7)
    for k, stencil in enumerate(_SLOPE_AT_START):
        yield k, first, stencil
        yield length - 1 - k, length - 7 + first, -stencil[::-1]


def _gram(stencil: np.ndarray, length: int, weight: float, rows: int) -> np.ndarray:
    """Upper bands (rows, T) of ``weight D'D`` for the difference D with a stencil, full rows only."""
    bands = np.zeros((rows, length))
    last = length - len(stencil)
    for i, a in enumerate(stencil):
        for j in range(i, len(stencil)):
            bands[rows - 1 - (j - i), j : last + j + 1] += weight * a * stencil[j]
    return bands


def _transposed(stencil: np.ndarray, y: np.ndarray, length: int) -> np.ndarray:
    """``D' y`` of a difference D with a stencil, (T, m)."""
    out = np.zeros((length, y.shape[1]))
    for k, c in enumerate(stencil):
        out[k : k + len(y)] += c * y
    return out
