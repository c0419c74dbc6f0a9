"""Who could have done it: every effect of the registry on every joint where it says something new."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.candidates.position_laws import leaves_room
from jaxswarm.effects import REGISTRY
from jaxswarm.effects.base import Effect
from jaxswarm.effects.kinds import BodyChange, MeasurementLaw, TorqueLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.metrics import is_moving
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Motion


def eligible_terms(
    model: Model, motions: tuple[Motion, ...], against_model: bool = False
) -> tuple[Term, ...]:
    """Every term that could be added to a model.

    Args:
        model: The current model; what it holds is not asked again.
        motions: The logs; an effect that needs a channel is asked only where all of them have it.
        against_model: Whether the model is an earlier one that is not refitted: then a body on the last
            link is a candidate, and so is a change of what the model already holds.
    """
    joints = model.robot.num_joints
    moves = np.any([np.ptp(m.q, axis=0) > 1e-3 for m in motions], axis=0)
    eligible = []
    for law in REGISTRY.values():
        if law.reference_only and not law.in_one_log and not against_model:
            continue
        if joints < law.min_joints and not against_model:
            continue  # the rigid parameters say the same
        if against_model and isinstance(law, MeasurementLaw) and law.slow:
            continue  # drives keep their filters, and a torque that was measured holds all that changed
        if not all(name in m.channels for name in law.requires for m in motions):
            continue
        fits = [
            (not law.turning or kind == "revolute")
            and (not law.carried or model.robot.parents[j] >= 0)
            and (not law.rests or longest_rest(motions, j) >= law.rests)
            for j, kind in enumerate(model.robot.kinds)
        ]
        if law.scope == "global":
            places: list[tuple[int | None, int | None]] = [(None, None)]
        elif law.scope == "joint":
            places = [(j, None) for j in range(joints) if moves[j] and fits[j]]
        else:
            places = [(j, o) for j in range(joints) for o in range(joints) if j != o and moves[o]]
        # Several events are possible; and an earlier model's friction may have changed.
        again = law.recurring or (against_model and isinstance(law, TorqueLaw))
        terms = [Term(law.name, *place) for place in places]
        if law.extends:
            held = {t.place for t in model.terms}
            terms = [t for t in terms if held & {(n, t.joint, t.other) for n in law.extends}]
        present = [t for t in model.terms if not (t.law is law and _has_room(t, model, motions))]
        eligible += [t for t in terms if again or not _is_settled(t, law, present)]
    return tuple(eligible)


def _has_room(term: Term, model: Model, motions: tuple[Motion, ...]) -> bool:
    """Whether beside a term there may be one like it: an order, or the tone or load of a log that has none."""
    law = term.law
    if (isinstance(law, TorqueLaw) and law.tone) or (isinstance(law, BodyChange) and law.window):
        return sum(t.place == term.place for t in model.terms) < len(motions)
    return leaves_room(term, motions)


def longest_rest(motions: tuple[Motion, ...], joint: int) -> float:
    """Longest time [s] that a joint stands still between two of its motions, in any of the logs."""
    longest = 0.0
    for motion in motions:
        t = motion.t[is_moving(motion.dq[:, joint])]
        longest = max(longest, float(np.diff(t).max()) if len(t) > 1 else 0.0)
    return longest


def _is_settled(term: Term, law: Effect, present: Sequence[Term]) -> bool:
    """Whether a model's terms hold, contain or rule out this one."""
    return any(
        t.place == term.place
        or (
            t.joint == term.joint
            and (law.excludes(t.law) or (law.name in t.law.contains and term.other is None))
        )
        for t in present
    )
