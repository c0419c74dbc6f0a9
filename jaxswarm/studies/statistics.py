r"""Comparing two optimizers over many runs: rank test, effect size, correction for many questions.

The final values of a swarm span decades, so only their order counts. The Mann-Whitney test asks whether
one sample tends to be smaller; the effect size of Vargha and Delaney is

.. math:: A_{12} = P(X < Y) + \tfrac12 P(X = Y),

here for "smaller is better": 0.5 no difference, 1.0 the first always wins; 0.56, 0.64, 0.71 are called
small, medium, large. Many comparisons are corrected by Holm's step-down rule.

References: H. B. Mann, D. R. Whitney, Ann. Math. Stat. 18 (1947); A. Vargha, H. D. Delaney, J. Educ. Behav.
Stat. 25 (2000), doi 10.3102/10769986025002101; S. Holm, Scand. J. Stat. 6 (1979).
"""

from collections.abc import Sequence

import numpy as np
from scipy import stats

LARGE_EFFECT = 0.71


def effect_size(first: np.ndarray, second: np.ndarray) -> float:
    """How often a value of ``first`` is below one of ``second``, ties half.

    >>> effect_size([1.0, 2.0], [2.0, 3.0])
    0.875
    """
    first, second = np.asarray(first)[:, None], np.asarray(second)[None]
    return float(np.mean((first < second) + 0.5 * (first == second)))


def compare(first: np.ndarray, second: np.ndarray) -> dict:
    """Two-sided p value and effect size, "first is smaller"."""
    first, second = np.asarray(first, float), np.asarray(second, float)
    same = np.ptp(np.concatenate([first, second])) == 0.0
    p = 1.0 if same else float(stats.mannwhitneyu(first, second).pvalue)
    return {"p": p, "effect": effect_size(first, second)}


def holm(p: Sequence[float] | np.ndarray) -> np.ndarray:
    """Holm's adjusted p values, in the given order.

    >>> holm([0.01, 0.04, 0.03]).round(4).tolist()
    [0.03, 0.06, 0.06]
    """
    p = np.asarray(p, float)
    order = np.argsort(p)
    stepped = np.maximum.accumulate(p[order] * (p.size - np.arange(p.size)))
    adjusted = np.empty_like(p)
    adjusted[order] = np.minimum(stepped, 1.0)
    return adjusted


def verdict(p: float, effect: float, level: float = 0.05) -> str:
    """The outcome of a comparison in a word: better, worse or not told apart.

    >>> verdict(0.001, 0.9), verdict(0.2, 0.9), verdict(0.001, 0.1)
    ('better', 'not told apart', 'worse')
    """
    if p >= level:
        return "not told apart"
    return "better" if effect > 0.5 else "worse"
