"""Laws of the load, seen with the load of a model that holds them.

A law goes by the load, or by the torque, of a model that lacks it and took up of it what it could. A dead band
of 1.5 N m was asked with a torque that changed its sign elsewhere: it took 0.62 off its joint's squared error,
at p = 2e-4, and with the torque of the model beside it 0.97, at 2e-24.

Turn by turn that leads to the right load where the wrong one is not far. A torque that crosses zero slowly
does so elsewhere by much more: a dead band of 1.5 N m, all of seven times the noise, took 0.02 off. Where the
law goes by the torque of the joint, what was measured of it in the rows that are fitted tells where to begin.
"""

from collections.abc import Callable

import numpy as np

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.refine import left_by
from jaxswarm.diagnose.folds.partial_out import Fold

# How often columns are made with the load that the model has beside them.
_TURNS = 6
# Share of the joint's squared error below which a law is not looked at more closely: half of what it has to
# take off, see Rules.share. And the part of what is left that a turn has to gain.
_WORTH, _SETTLED = 0.1, 1e-3
# Parts of what the model takes up that are tried: seen with a wrong load a law seems larger or smaller.
_PARTS = (1.0, 0.5, 0.25)


def with_own_load(
    lin: Linearization,
    fold: Fold,
    joint: int,
    columns: np.ndarray,
    build: Callable[[Linearization], np.ndarray],
    measured: np.ndarray | None = None,
) -> np.ndarray:
    """Columns (T', n, k) of a law on a joint as the model beside it, fitted to a fold, would have them.

    Args:
        lin: The model without the law.
        fold: The rows to which both are fitted.
        joint: Whose law it is.
        columns: Those with the load as it is.
        build: Makes them for a model with other linear parameters.
        measured: Those with the torque that was measured, where the law goes by that: they tell another model
            to begin with, and no more.
    """
    left, found = _settled(lin, fold, joint, columns, build)
    if measured is None:
        return found
    taken = measured @ left_by(fold, measured, joint)[1]
    begin = build(_without_taken_up(lin, fold, joint, taken))
    other, again = _settled(lin, fold, joint, begin, build)
    return again if other < (1.0 - _SETTLED) * left else found


def _settled(
    lin: Linearization,
    fold: Fold,
    joint: int,
    columns: np.ndarray,
    build: Callable[[Linearization], np.ndarray],
) -> tuple[float, np.ndarray]:
    """What the joint's training rows are left with, and the columns, turn by turn from some to begin with."""
    left, a = left_by(fold, columns, joint)
    if left > (1.0 - _WORTH) * float((fold.residual[fold.train, joint] ** 2).sum()):
        return left, columns
    for _ in range(_TURNS):
        for part in _PARTS:
            again = build(_without_taken_up(lin, fold, joint, columns @ a, part))
            found, b = left_by(fold, again, joint)
            if found < (1.0 - _SETTLED) * left:
                break
        else:
            break
        columns, left, a = again, found, b
    return left, columns


def _without_taken_up(
    lin: Linearization, fold: Fold, joint: int, torque: np.ndarray, part: float = 1.0
) -> Linearization:
    """The model, for laws on a joint, without a part of what it takes up of a weighted torque (T', n)."""
    return lin.changed_by(-part * lin.found.fit.base.expand(fold.absorbed(torque)), joint)
