"""What an addition does to the error on stretches of one log, each fitted to the others."""

import numpy as np

from jaxswarm.diagnose.decision.rules import GAIN, IN_ALL_CUTS, KNOWN, PREDICTABLE, STRETCHES
from jaxswarm.diagnose.selection.elsewhere import added_columns, rms, rows_of_both
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.validate import held_out_residual, least_known, time_blocks


def on_stretches(before: Estimate, after: Estimate, joint: int) -> tuple[bool, bool]:
    """Whether some cut of the log predicts its stretches, and whether the addition raises an error there.

    A cut counts where the rest of the log predicts its stretches and knows the addition. Both are so where it
    leaves less of them than the fit without it leaves where it was fitted: two laws took 99.7 % off a joint's
    error on every third of a log that no model without them predicted.

    What raises the error in one cut is right all the same where that in all of them falls by much: where more
    is missing, a third may be told wrongly by the rest. A joint's viscous friction left 1.13 of it in thirds,
    0.36 in halves and 0.73 in quarters.

    Both are weighed as the addition leaves it: what a joint lacks makes its rows say little, and a part of the
    links that they alone tell stays where it is. A ripple that took 0.96 off four times the noise left a fourth
    of the error in quarters; it was refused for a third that no fit with these weights predicts.

    Args:
        before, after: The fits without and with the addition.
        joint: Where it acts, or shows most.
    """
    added = added_columns(before, after)
    used = rows_of_both(before, after)[:, joint]
    fitted, counted, every = rms(before.fit.residual[used, joint]), [], []
    sigma = after.fit.sigma
    for count in STRETCHES:
        stretch = time_blocks(before.regression.log, count)
        left = (held_out_residual(e, block=stretch, sigma=sigma) for e in (before, after))
        pair = [rms(x[used, joint]) for x in left]
        every.append(pair)
        known = pair[0] < PREDICTABLE * fitted and least_known(after, added, stretch) > KNOWN
        if known or pair[1] < GAIN * fitted:
            counted.append(pair)
    without, beside = rms(np.array(every))
    raises = any(two > one for one, two in counted) and beside > IN_ALL_CUTS * without
    return bool(counted), bool(raises)
