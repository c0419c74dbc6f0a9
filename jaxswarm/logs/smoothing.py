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
where motion and noise are equally strong. :func:`find_cutoffs` takes the :math:`\lambda` of greatest
restricted likelihood, joint by joint (G. Wahba, Annals of Statistics 13 (1985); S. Wood, J. R. Stat. Soc. B
73 (2011)): the same smoothing is then best for position, velocity and acceleration.
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
# Cutoffs tried, from this share of the rate (below it the system loses its digits), and the samples that
# are looked at: likelihoods are sharp long before that many.
_TRIED, _LEAST, _BLOCK, _BLOCKS = 20, 0.008, 8000, 3
# Weight of the velocity beside the position at most, where both are per sample: beyond, the system loses its
# digits. Encoders and velocity channels of arms make a hundred.
_STRONGEST = 1e9
# Above this rate [Hz] samples are averaged before cutoffs are looked for, so many left of a short stretch.
_ENOUGH, _FEWEST = 300.0, 50


class Cutoffs(NamedTuple):
    """What the data say about a motion.

    Attributes:
        cutoff: Frequency [Hz] at which motion and noise are equally strong, (n,).
        noise: Standard deviation of the position's white noise [rad or m], (n,).
    """

    cutoff: np.ndarray
    noise: np.ndarray


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
        flat[:, own] = _solve(flat[:, own], given, rate, *one).mean
    return flat.reshape(np.shape(x))


def find_cutoffs(
    q: np.ndarray,
    rate: float,
    velocity: np.ndarray | None = None,
    ratio: np.ndarray | None = None,
) -> Cutoffs:
    """Cutoffs of greatest restricted likelihood, joint by joint.

    Args:
        q: Uniformly sampled positions, (T, n).
        rate: Sampling rate [Hz].
        velocity, ratio: As for :func:`smooth`.

    >>> t, rng = np.arange(4000) / 200.0, np.random.default_rng(0)
    >>> found = find_cutoffs(np.sin(2 * np.pi * t)[:, None] + 1e-3 * rng.normal(size=(4000, 1)), 200.0)
    >>> bool(1.0 < found.cutoff[0] < 10.0), round(float(found.noise[0]), 4)
    (True, 0.001)
    """
    group = max(1, min(int(rate / _ENOUGH), len(q) // _FEWEST))
    whole = WHOLE_BAND * rate
    if group > 1:
        q, rate = _averaged(q, group), rate / group
        velocity = None if velocity is None else _averaged(velocity, group)
    blocks = [slice(None)]
    if len(q) > _BLOCK * _BLOCKS:
        starts = np.linspace(0, len(q) - _BLOCK, _BLOCKS).astype(int)
        blocks = [slice(s, s + _BLOCK) for s in starts]
    highest = WHOLE_BAND * rate
    tried = np.geomspace(_LEAST * rate, highest, _TRIED)
    cutoff, noise = np.full(q.shape[1], whole), np.zeros(q.shape[1])
    rhos = np.zeros(q.shape[1]) if ratio is None else np.asarray(ratio, dtype=float)
    moving = np.ptp(q, axis=0) > 0.0
    for rho in sorted({*rhos[moving].tolist()}):
        # Joints of one ratio share the system: it is factored once for all of them.
        own = np.flatnonzero(moving & (rhos == rho))
        # A column in one piece is summed as it would be alone.
        x = np.asfortranarray(q[:, own])
        v = None if velocity is None else np.asfortranarray(velocity[:, own])
        parts = [(x[b], None if v is None else v[b]) for b in blocks]
        costs = [sum(_evidence(*part, rate, f, rho)[0] for part in parts) for f in tried]
        for k, (j, cost) in enumerate(zip(own, np.array(costs).T, strict=True)):
            cutoff[j] = float(np.exp(_vertex(np.log(tried), cost)))
            alone = [(x[:, [k]], None if v is None else v[:, [k]]) for x, v in parts]
            noise[j] = np.median([_evidence(*part, rate, cutoff[j], rho)[1] for part in alone])
            if cutoff[j] >= highest:
                cutoff[j] = whole
    return Cutoffs(cutoff, noise * np.sqrt(group))


def _averaged(x: np.ndarray, group: int) -> np.ndarray:
    """Means of so many samples each: white noise stays white."""
    kept = len(x) // group
    return x[: kept * group].reshape(kept, group, -1).mean(axis=1)


class _Solution(NamedTuple):
    """The smoothed columns, half the log-determinant of the system, and the least sum of squares per column."""

    mean: np.ndarray
    half_log_det: float
    squares: np.ndarray


def _solve(
    x: np.ndarray, velocity: np.ndarray | None, rate: float, cutoff: float, rho: float
) -> _Solution:
    """Minimize the penalized squares for columns (T, m) that share cutoff and rho."""
    length, middle = len(x), x.mean(axis=0)
    x = x - middle  # what stands is kept to the last digit, where the system would lose six of them
    weight = (2.0 * np.sin(np.pi * min(cutoff / rate, 0.5))) ** -8
    bands = _gram(_PENALTY, length, weight, 5 if rho == 0.0 else 7)
    bands[-1] += 1.0
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
    squares = ((x - mean) ** 2).sum(axis=0) + weight * (np.diff(mean, 4, axis=0) ** 2).sum(axis=0)
    if rho > 0.0:
        assert velocity is not None
        slope = sum(c * mean[k : length - 6 + k] for k, c in enumerate(_SLOPE))
        squares += strength * ((velocity[3:-3] / rate - slope) ** 2).sum(axis=0)
        for row, columns, stencil in _ends(length):
            squares += strength * (velocity[row] / rate - stencil @ mean[columns]) ** 2
    return _Solution(mean + middle, float(np.log(factor[-1]).sum()), squares)


def _evidence(
    x: np.ndarray, velocity: np.ndarray | None, rate: float, cutoff: float, rho: float
) -> tuple[np.ndarray, np.ndarray]:
    """Minus twice the restricted log-likelihood of a cutoff for columns (T, m), and the noise it implies."""
    found = _solve(x, velocity, rate, cutoff, rho)
    count = len(x) - 4 + (len(x) if rho > 0.0 else 0)
    weight = -8.0 * np.log(2.0 * np.sin(np.pi * min(cutoff / rate, 0.5)))
    variance = np.maximum(found.squares / count, 1e-300)
    cost = count * np.log(variance) + 2.0 * found.half_log_det - (len(x) - 4) * weight
    return cost, np.sqrt(variance)


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


def _vertex(x: np.ndarray, cost: np.ndarray) -> float:
    """Minimum of a sampled cost by a parabola through its three lowest neighbors; ends stay ends."""
    best = int(np.argmin(cost))
    if not 0 < best < len(x) - 1:
        return float(x[best])
    a, b, _ = np.polyfit(x[best - 1 : best + 2] - x[best], cost[best - 1 : best + 2], 2)
    return float(x[best] - b / (2.0 * a)) if a > 0 else float(x[best])
