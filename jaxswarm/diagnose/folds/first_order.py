r"""The density of noise that a filter of first order lets through, from what octaves of frequencies hold.

At a frequency f it is :math:`S(f) = S_0 / (1 + (f / f_c)^2)`.
"""

import numpy as np

# Octaves above the band and in it, from the upper one down, over the cutoff: where the low-pass has left
# nothing of the band, and what it passes.
ABOVE = (1.5, 3.0)
WITHIN = ((0.5, 1.0), (0.25, 0.5), (0.125, 0.25), (0.0, 0.125))
# Those that tell the filter: the octave above and the upper two within.
_TELLING = (ABOVE, *WITHIN[:2])
# Squared misfit of the octaves above the band and in it, in standard errors, up to which they are those of one
# filter of first order.
_MISFIT = 4.0
# Relative difference of filters of first order in the octave above the band: an average of past samples, one of
# the past and present sample, and one of continuous time.
_OF_SHAPE = 0.2
# Squared ratio of the cutoff to the corner: those that are asked.
_STEEP = np.geomspace(1e-3, 1e3, 241)


def density_of(above: float, within: np.ndarray, even: np.ndarray, doubt: np.ndarray) -> float:
    """Mean density below the cutoff of noise with the densities of the octave above (infinite: not known) and
    of three octaves within, from the upper one down, each of which is filled evenly or not.

    Args:
        above, within, even: As said.
        doubt: Relative standard errors of the octave above and of the upper two within, (3,).
    """
    upper, second, third = within
    if np.isnan(upper) or not even[0]:
        return 0.0 * float(upper)
    steep, told = _fitted(np.array([above, upper, second]), doubt)
    if told > 0.0 and np.isfinite(above):
        # Three octaves tell the size of noise; the slowest two hold no more than is found there.
        upper, above = told, np.inf
    elif not even[1]:
        steep = _STEEP[0]
    beyond, first, *below = [_means(np.array(steep), octave) for octave in (ABOVE, *WITHIN)]
    upper = min(upper, above * first / beyond)
    per_upper = np.array(below) / first
    slow = min(third, per_upper[1] * upper)
    parts = (upper, per_upper[0] * upper, slow, slow * per_upper[2] / per_upper[1])
    return float(sum(part * (b - a) for part, (a, b) in zip(parts, WITHIN, strict=True)))


def _fitted(told: np.ndarray, doubt: np.ndarray) -> tuple[float, float]:
    """Steepness and upper octave's density of the first-order filter nearest to the densities (3,) told.

    Where none is near to them the density is zero, and the steepness that of the two within.
    """
    shape, known = np.array([_means(_STEEP, octave) for octave in _TELLING]), np.isfinite(told)
    off = (np.log(np.maximum(told, 1e-300))[:, None] - np.log(shape))[known]
    weight = doubt[known, None] ** -2.0
    size = (weight * off).sum(axis=0) / weight.sum()
    misfit = (weight * (off - size) ** 2).sum(axis=0)
    best = int(np.argmin(misfit))
    if misfit[best] < _MISFIT and best < len(_STEEP) - 1:
        return _STEEP[best], float(np.exp(size[best]) * shape[1, best])
    rise, rises = told[2] / max(told[1], 1e-300), shape[2] / shape[1]
    # More than that filter's is what a law leaves; of noise the band holds at least what its upper octave does.
    return float(np.interp(rise, rises, _STEEP) if rise < rises[-1] else _STEEP[0]), 0.0


def standard_errors(periods: float, quiet: float) -> np.ndarray:
    """Relative standard errors (3,) of what a quiet part tells of the octave above and of the upper two within.

    Of a part p of n lines, each exponentially distributed: sqrt(p / (n (1 - p))) / log(1 / (1 - p)).
    Stretches that overlap by half count as one and a quarter that do not. What filters pass near half the
    rate differs.

    Args:
        periods: Length of the log in periods of the cutoff.
        quiet: The part.
    """
    of_one = np.sqrt(quiet / (1.0 - quiet)) / -np.log1p(-quiet)
    widths = np.array([b - a for a, b in _TELLING])
    return np.hypot(of_one / np.sqrt(1.25 * periods * widths), [_OF_SHAPE, 0.0, 0.0])


def _means(steep: np.ndarray, octave: tuple[float, float]) -> np.ndarray:
    """Mean of 1 / (1 + steep f^2) over frequencies f [cutoffs] of an octave."""
    begin, end = octave
    root = np.sqrt(steep)
    return (np.arctan(root * end) - np.arctan(root * begin)) / (root * (end - begin))
