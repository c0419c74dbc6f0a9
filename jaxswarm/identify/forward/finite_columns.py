"""Columns that a fit can use: more rows than columns, and all of them finite."""

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.logs.motion import Motion

# Squares of larger numbers, summed over a log, leave the finite numbers.
_MOST = 1e140


class Diverged(InputError):
    """The torque of a model leaves the finite numbers along a log: as a link that runs away."""


def check_rows(columns: np.ndarray, source: str) -> None:
    """Refuse columns (T, n, p) of which there are more than rows."""
    rows, joints, count = columns.shape
    if rows * joints < count:
        raise InputError(
            f"{source}: {rows} independent samples of {joints} joints are fewer than the {count} "
            "parameters; log a longer motion or declare fewer effects"
        )


def check_finite(columns: np.ndarray, terms: tuple[Term, ...], motion: Motion) -> None:
    """Name the terms that may have driven columns (T', n, p) of a log out of the finite numbers."""
    # Smallest and largest are NaN where any is, and take no copy.
    least, most = (f(columns, axis=(0, 2), initial=0.0) for f in (np.min, np.max))
    bad = ~((least > -_MOST) & (most < _MOST))
    if not bad.any():
        return
    joints = np.flatnonzero(bad)
    behind = [t for t in terms if t.joint is None or t.joint in joints]
    raise Diverged(
        f"{motion.source}: the model has no finite torque on "
        f"{', '.join(motion.joints[j] for j in joints)} with "
        f"{', '.join(t.label(motion.joints) for t in behind) or 'these parameters'}; "
        "log a stronger motion, or leave one of these effects out"
    )
