"""The verdict: one of five words, and how far it is proven."""

from collections.abc import Sequence

from jaxswarm.diagnose.decision.remainder import Remainder
from jaxswarm.diagnose.decision.rules import HOPELESS
from jaxswarm.diagnose.decision.unexplained import Unexplained
from jaxswarm.identify.checks.sound import UNRELATED
from jaxswarm.identify.estimation.estimate import Estimate

NOTHING, EXPLAINED, PARTLY, UNEXPLAINED, CANNOT = (
    "nothing missing",
    "explained",
    "partly explained",
    "unexplained",
    "cannot be judged",
)
# A share of the torque beyond which its size tells nothing more.
_MUCH = 100
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


def belongs_together(found: Estimate, remains: Sequence[Remainder]) -> bool:
    """Whether a fit to the whole log explains the torque of every joint, or is near its noise.

    Of a slow log of 18 s whose joint 4 lacked a law, and of which no part told all parameters, the fit left
    less than its noise on all other joints, and ten thousand times the torque on unseen time.
    """
    left, torque = (found.regression.rms(x) for x in (found.fit.residual, found.regression.torque))
    return all(r.near or left[r.joint] < UNRELATED * torque[r.joint] for r in remains)


def hopeless(unseen: float, belongs: bool) -> str | None:
    """Why a log cannot be judged whose model leaves a share of all torque on unseen time; None: it can.

    ``belongs``: as :func:`belongs_together` tells. Joints that move one by one leave sixteen times the torque
    of time held out, which no other time tells of.
    """
    if unseen < HOPELESS or belongs:
        return None
    return (
        f"the model leaves {_much(unseen)} of the torque on unseen time: torque and motion do not "
        "belong together; check units, signs and the order of the columns"
    )


def _much(share: float) -> str:
    """A share in percent, of which nobody needs five digits."""
    return f"over {100 * _MUCH} %" if share > _MUCH else f"{100 * share:.0f} %"


def unpredicted(unseen: float, belongs: bool) -> str | None:
    """Why errors on held-out time tell nothing of a model that belongs to its log; None: they do."""
    if unseen < HOPELESS or not belongs:
        return None
    return (
        f"errors on held-out time ({_much(unseen)} of the torque) tell nothing: no part of the log tells "
        "all parameters, as where joints move one by one; record a motion of all joints at once"
    )
