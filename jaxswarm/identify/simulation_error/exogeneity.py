"""The test that asks whether a regression needs instruments.

Least squares of y on columns W is biased where these are noisy and their errors follow those of y
(:mod:`jaxswarm.identify.simulation_error.instrumental`). The Durbin-Wu-Hausman test: without such errors the
part V of W that the instruments do not explain adds nothing to the regression of y on [W, V].

Reference: A. Janot, P.-O. Vandanjon, M. Gautier, "A revised Durbin-Wu-Hausman test for industrial robot
identification", Control Engineering Practice 48, 2016.
"""

import dataclasses

import numpy as np
import scipy

from jaxswarm.decomposition import lstsq, thin_svd
from jaxswarm.identify.simulation_error.instrumental import check_shapes


@dataclasses.dataclass(frozen=True)
class Exogeneity:
    """Result of the test.

    Attributes:
        statistic: F statistic of the added columns.
        p_value: Probability of a larger one if least squares is unbiased.
        num_added: Number of added columns.
        biased: Whether ``p_value`` lies below the level: use instruments.
    """

    statistic: float
    p_value: float
    num_added: int
    biased: bool


def exogeneity_test(
    columns: np.ndarray,
    target: np.ndarray,
    instruments: np.ndarray,
    *,
    level: float = 0.01,
    effective_samples: float | None = None,
) -> Exogeneity:
    """Test whether least squares on W is unbiased, by regressing on [W, V].

    Args:
        columns: W, (r, p), rows whitened (one scale per joint).
        target: y, (r,).
        instruments: Z, (r, p).
        level: Probability of a false alarm, in (0, 1).
        effective_samples: Number of independent samples among the r, for autocorrelated residuals;
            default r.

    Raises:
        InputError: If shapes differ.
    """
    check_shapes(columns, target, instruments)
    basis = np.linalg.qr(instruments)[0]
    rest = columns - basis @ (basis.T @ columns)
    # Columns the instruments reproduce exactly (an offset) have nothing left to test.
    scale = np.linalg.norm(columns, axis=0)
    left, singular, _ = thin_svd(rest / scale)
    added = left[:, singular > 1e-8]
    num = len(target) if effective_samples is None else effective_samples
    freedom = num - columns.shape[1] - added.shape[1]
    if added.shape[1] == 0 or freedom <= 0:
        return Exogeneity(0.0, 1.0, added.shape[1], False)

    def unexplained(regressors):
        error = target - regressors @ lstsq(regressors, target)
        return float(error @ error)

    scaled = columns / scale
    without, within = unexplained(scaled), unexplained(np.hstack([scaled, added]))
    statistic = (without - within) / added.shape[1] / (within / freedom)
    p_value = float(scipy.special.fdtrc(added.shape[1], freedom, statistic))
    return Exogeneity(statistic, p_value, added.shape[1], p_value < level)
