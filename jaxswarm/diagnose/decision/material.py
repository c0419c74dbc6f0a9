"""Which structure without a law counts: what stands out of the noise of its joint, sharp or not."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import MATERIAL, NEAR
from jaxswarm.diagnose.decision.sharpness import soft_folds, torque_left
from jaxswarm.diagnose.decision.unexplained import Unexplained, find_unexplained
from jaxswarm.diagnose.folds.noise import row_noise
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.identify.estimation.estimate import Estimate


def find_material(found: Estimate, crossfit: CrossFit, seed: int = 0) -> list[Unexplained]:
    """Structure that no law explains and that stands out of the noise of its joint.

    A joint within its noise is not looked at: of no more than all that is left there, none can stand out. On
    one near its noise it has to stand out as well where rows count by all their noise and the clock of each
    joint is free, as a law has to (:func:`jaxswarm.diagnose.decision.sharpness.only_sharp`): on a clean wrist
    two thirds of what was left, 1.4 times the noise, followed the speed of another joint; 0.8 times is left
    where that wrist's torque is early by a part of a sample.
    """
    over = over_noise(found)
    loud = [j for j, size in enumerate(over) if size > MATERIAL]
    items = [i for i in find_unexplained(found, crossfit, seed, loud) if is_material(i, over)]
    doubtful = [item.joint for item in items if over[item.joint] <= NEAR]
    if not doubtful:
        return items
    softer = soft_folds(found)
    left = found.regression.rms(torque_left(softer) / row_noise(found))
    again = find_unexplained(found, softer, seed, doubtful)
    clear = {item.joint for item in again if is_material(item, left)}
    return [item for item in items if item.joint not in doubtful or item.joint in clear]


def is_material(item: Unexplained, over: Sequence[float] | np.ndarray) -> bool:
    """Whether structure stands out of the noise of its joint; ``over``: what is left of every joint over it."""
    return bool(np.sqrt(item.share) * over[item.joint] > MATERIAL)
