"""Who could have done it: every law of the registry on every joint where it says something new."""

import numpy as np

from jaxswarm.effects import REGISTRY
from jaxswarm.effects.term import Term
from jaxswarm.effects.warps import LAGGING
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Motion

# Laws that contain others: declaring or adding the right one makes the left ones redundant.
CONTAINS = {
    "asymmetric_friction": ("viscous_friction", "coulomb_friction"),
    "joint_spring": ("torque_offset",),
}


def list_suspects(
    model: Model, motions: tuple[Motion, ...], against_model: bool = False
) -> tuple[Term, ...]:
    """Every term that could be added to a model.

    Args:
        model: The current model; what it holds is not asked again.
        motions: The logs; a law that needs a temperature is asked only where one was logged.
        against_model: Whether the model is an earlier one that is not refitted: then a payload is a
            suspect, and so is a change of what the model already holds.
    """
    joints = model.robot.num_joints
    present = {(t.effect, t.joint, t.other) for t in model.terms}
    contained = {
        (inner, t.joint, None) for t in model.terms for inner in CONTAINS.get(t.effect, ())
    }
    # A play has a spring on its flanks: one transmission, one of the two.
    soft = {(t.joint, None) for t in model.terms if t.law.warp in LAGGING}
    contained |= {
        (law.name, *place) for law in REGISTRY.values() if law.warp in LAGGING for place in soft
    }
    moves = np.any([np.ptp(m.q, axis=0) > 1e-3 for m in motions], axis=0)
    suspects = []
    for law in REGISTRY.values():
        if law.name == "payload" and not against_model:
            continue
        if not all(name in m.channels for name in law.requires for m in motions):
            continue
        if law.scope == "global":
            places = [(None, None)]
        elif law.scope == "joint":
            places = [(j, None) for j in range(joints) if moves[j]]
        else:
            places = [(j, o) for j in range(joints) for o in range(joints) if j != o and moves[o]]
        for joint, other in places:
            key = (law.name, joint, other)
            # Several touches are possible; and an earlier model's friction may have changed.
            again = law.recurring or (against_model and law.torque is not None)
            if (key in present or key in contained) and not again:
                continue
            if joints == 1 and law.name == "drive_gain" and not against_model:
                continue  # the scale of a single joint is in its parameters
            suspects.append(Term(law.name, joint, other))
    return tuple(suspects)
