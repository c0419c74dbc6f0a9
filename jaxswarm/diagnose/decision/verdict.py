"""The verdict: one of five words, and how far it is proven."""

from collections.abc import Sequence

from jaxswarm.diagnose.decision.remainder import Remainder
from jaxswarm.diagnose.decision.rules import HOPELESS
from jaxswarm.diagnose.decision.unexplained import Unexplained

NOTHING, EXPLAINED, PARTLY, UNEXPLAINED, CANNOT = (
    "nothing missing",
    "explained",
    "partly explained",
    "unexplained",
    "cannot be judged",
)
OTHER_MOTION, REGIONS, NO_PROOF = "other motion", "held-out regions", "none"


def verdict(
    added: int, left: Sequence[Unexplained], remains: Sequence[Remainder], beyond: bool = False
) -> str:
    """Nothing may be called explained that is not near the noise, here and on other motion.

    Args:
        added: How many effects were added or changed.
        left: Structure that no law explains.
        remains: What is left on every joint.
        beyond: Whether another log is left with far more than the fitted motion leaves open.
    """
    more = beyond or bool(left) or not all(r.near for r in remains)
    if added:
        return PARTLY if more else EXPLAINED
    return UNEXPLAINED if more else NOTHING


def hopeless(unseen: float, belongs: bool) -> str | None:
    """Why a log cannot be judged whose model leaves a share of all torque on unseen time; None: it can.

    ``belongs``: fitted to the whole log it is near the noise on every joint. Joints that move one by one leave
    sixteen times the torque of time held out, which no other time tells of.
    """
    if unseen < HOPELESS or belongs:
        return None
    return (
        f"the model leaves {100 * unseen:.0f} % of the torque on unseen time: torque and motion do not "
        "belong together; check units, signs and the order of the columns"
    )


def unpredicted(unseen: float, belongs: bool) -> str | None:
    """Why errors on held-out time tell nothing of a model that belongs to its log; None: they do."""
    if unseen < HOPELESS or not belongs:
        return None
    return (
        f"errors on held-out time ({100 * unseen:.0f} % of the torque) tell nothing: no part of the log tells "
        "all parameters, as where joints move one by one; record a motion of all joints at once"
    )
