"""What dry friction may hold where a joint hardly moves: any torque within it, which no law tells."""

from dataclasses import replace

import numpy as np

from jaxswarm.identify.estimation.standing import standing
from jaxswarm.identify.forward.metrics import slow_speed
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.logs.motion import Motion

# Part of its top speed within which a joint reverses. The carriage of a clean gantry left 8 times its noise at
# five reversals, and nothing elsewhere: it was told as coupled by its gears, at p = 2e-7.
_REVERSES = 0.05


def rest_noise(model: Model, motion: Motion) -> np.ndarray:
    """Standard deviation (T', n) of what holds a joint that hardly moves: any torque within its friction.

    A joint with true stiction stops for a tenth of a second while its drive winds up: what holds it then was
    told as a push. So was a rest in which others moved it at five times the width of its sign.

    Args:
        model: With its friction.
        motion: A log.
    """
    width, (rest,) = np.asarray(model.width), standing([motion])
    moving = _half(model, motion, width)
    if not rest.any():
        return moving
    return np.where(rest, _half(model, motion, np.maximum(width, slow_speed(motion.dq))), moving)


def reversal_noise(model: Model, motion: Motion) -> np.ndarray:
    """The same wherever a joint is slow enough to reverse, for however short a time."""
    return _half(model, motion, _REVERSES * np.abs(motion.dq).max(axis=0))


def _half(model: Model, motion: Motion, width: np.ndarray) -> np.ndarray:
    """Half of what friction changes by between speeds (n,) below and above those of a log, (T', n)."""
    own = replace(model, terms=tuple(t for t in model.terms if t.law.uses_direction), smooth=())
    moved = (replace(motion, dq=motion.dq + s * width) for s in (1.0, -1.0))
    up, down = (model_torque(own, m) for m in moved)
    return np.abs(motion.decimator.apply(0.5 * (up - down)))
