"""Whether a fit of everything confirms an addition.

What was worth much beside a model that stood still may be worth little once all is fitted with it, and little
beside the noise, which holds what is unknown of the motion. It is asked over all rows and over those in which
the joint moves: at rest dry friction leaves it at any torque up to its level. A joint that stood for a third of
a log left 0.083 N m there; viscous friction that took what it left in motion from 0.0305 to 0.0266 N m, its
noise, took 3 % off all rows.
"""

import numpy as np

from jaxswarm.diagnose.decision.rules import GAIN, Rules
from jaxswarm.diagnose.folds.noise import row_noise
from jaxswarm.diagnose.selection.elsewhere import rms, rows_of_both
from jaxswarm.identify.estimation.estimate import Estimate


def unconfirmed(before: Estimate, after: Estimate, joint: int, rules: Rules) -> str | None:
    """Why a fit of everything does not confirm an addition; None if it does.

    Args:
        before, after: The fits without and with it.
        joint: Where it acts, or shows most.
        rules: Thresholds.
    """
    own = before.model.robot.joints[joint]
    used = rows_of_both(before, after)[:, joint]
    left = [e.fit.residual[:, joint] for e in (before, after)]
    noise, lower = row_noise(before)[:, joint], False
    for rows in (used, used & before.regression.moving[:, joint]):
        if not rows.any():
            continue
        one, two = (rms(x[rows]) for x in left)
        falls = bool(two <= GAIN * one)
        if falls and np.sqrt(one**2 - two**2) >= rules.over_noise * rms(noise[rows]):
            return None
        lower |= falls
    if lower:
        return f"takes little beside the noise off the error of {own} once all is fitted with it"
    return f"does not lower the error of {own} once all is fitted with it"
