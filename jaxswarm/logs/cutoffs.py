"""The frequency at which a motion is as strong as its noise, from the data, joint by joint.

It is the cutoff of :mod:`jaxswarm.logs.smoothing` of greatest restricted likelihood (G. Wahba, Annals of
Statistics 13 (1985); S. Wood, J. R. Stat. Soc. B 73 (2011)).
"""

from typing import NamedTuple

import numpy as np

from jaxswarm.logs.smoothing import WHOLE_BAND, solve

# Cutoffs tried, from this share of the rate (below it the system loses its digits), and the samples that
# are looked at: likelihoods are sharp long before that many.
_TRIED, _LEAST, _BLOCK, _BLOCKS = 20, 0.008, 8000, 3
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
        velocity, ratio: As for :func:`jaxswarm.logs.smoothing.smooth`.

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


def _evidence(
    x: np.ndarray, velocity: np.ndarray | None, rate: float, cutoff: float, rho: float
) -> tuple[np.ndarray, np.ndarray]:
    """Minus twice the restricted log-likelihood of a cutoff for columns (T, m), and the noise it implies."""
    found = solve(x, velocity, rate, cutoff, rho)
    count = len(x) - 4 + (len(x) if rho > 0.0 else 0)
    weight = -8.0 * np.log(2.0 * np.sin(np.pi * min(cutoff / rate, 0.5)))
    variance = np.maximum(found.squares / count, 1e-300)
    cost = count * np.log(variance) + 2.0 * found.half_log_det - (len(x) - 4) * weight
    return cost, np.sqrt(variance)


def _vertex(x: np.ndarray, cost: np.ndarray) -> float:
    """Minimum of a sampled cost by a parabola through its three lowest neighbors; ends stay ends."""
    best = int(np.argmin(cost))
    if not 0 < best < len(x) - 1:
        return float(x[best])
    a, b, _ = np.polyfit(x[best - 1 : best + 2] - x[best], cost[best - 1 : best + 2], 2)
    return float(x[best] - b / (2.0 * a)) if a > 0 else float(x[best])
