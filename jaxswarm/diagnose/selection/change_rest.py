"""Where friction holds joints, asked again for every change that an earlier model is found to lack."""

from collections.abc import Sequence

from jaxswarm.diagnose.selection.earlier_model import freeze, with_doubt
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.sticking import loud_joints, without_sticks
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.standing import held, leave_out, mixed_with, standing
from jaxswarm.logs.motion import Motion


def without_held(search: Search) -> tuple[Estimate, Estimate] | None:
    """The model with its changes, and the earlier one, without rows in which friction holds joints.

    Those are the rest of joints, by what is left now, or where they hardly move: what an earlier model says
    where a joint starts, stops or reverses is the sign of another motion. Before a load was found, motion left
    as much as rest, and none was held; what then was left at rest of a measured wrist that carried 2.8 kg was
    told as a spring with a dead zone of 6600 N m/rad.

    Returns:
        Both; None where friction holds none in further rows.
    """
    current, earlier = search.current, search.declared.model

    def fitted(motions: Sequence[Motion]) -> Estimate:
        told = with_doubt(freeze(earlier, motions), search.seed)
        return freeze(current.model, told.motions)

    rest = standing(current.motions)
    joints = held(current.fit.residual, rest, mixed_with(current.motions, rest))
    after = (
        fitted(leave_out(current.motions, rest, joints))
        if joints.any()
        else without_sticks(search, loud_joints(search), fitted)
    )
    return None if after is None else (after, freeze(earlier, after.motions))
