"""What a law is about, and how much of what it leaves still follows that."""

from collections.abc import Iterator

import numpy as np

from jaxswarm.diagnose.decision.smooth_rows import (
    VARIES,
    SmoothOf,
    Variable,
    held_out_share,
    smooth_rows,
    table_of,
    variable,
    waves_of,
)
from jaxswarm.diagnose.folds.joint_rows import joint_rows
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.effects.direction import follows_direction
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate

# What a law is about by the axis of its picture: a quantity of its own joint or of its partner's.
_OWN = {"position": "q", "velocity": "dq", "acceleration": "ddq"}
_PARTNER = {"partner position": "q", "partner velocity": "dq"}
# Laws about these have no such quantity; how large their own torque is stands for it.
_LOADS = ("load", "model torque")


def left_of_own(
    found: Estimate, crossfit: CrossFit, term: Term, seed: int = 0
) -> tuple[float, float]:
    """Share of its joint's held-out squared error that a function of what a law is about takes off, and p.

    Nothing, of chance one, for what is about time, remembers, or acts on the whole arm.

    Args:
        found: A fit that holds the term.
        crossfit: Its folds.
        term: The term with its fitted values.
        seed: Of the features.
    """
    inputs = _variables(found, term)
    if not inputs:
        return 0.0, 1.0
    joint = term.index
    weight = crossfit.weight[:, joint, None]
    halves = [joint_rows(fold, joint) for fold in crossfit.halves]
    tried = [
        held_out_share(halves, crossfit.block, rows * weight)
        for rows in _functions(inputs, torque_at_joint(found, term), seed)
    ]
    best = max(tried)
    return best.share, min(1.0, len(tried) * best.p_value)


def _functions(inputs: dict[str, Variable], torque: np.ndarray, seed: int) -> Iterator[np.ndarray]:
    """Features (T, f) of what a law of a torque (T,) may leave by what it is about.

    Of two variables any function has 96 numbers, which a short log does not tell: of drags between two angles
    that were told as friction by the position none left any. So it is asked for one of each alone, too, and for
    one of each times the law's own torque: dry friction has a level that no speed changes.
    """
    names = tuple(inputs)
    asked = [SmoothOf(names), *(SmoothOf((name,)) for name in names if len(names) > 1)]
    if len(names) == 1:
        asked.append(SmoothOf(names, narrow=True))
    for of in asked:
        rows = smooth_rows([inputs[name] for name in of.names], waves_of(of, seed))
        yield rows
        if len(of.names) < len(names):
            yield rows * torque[:, None]


def torque_at_joint(found: Estimate, term: Term) -> np.ndarray:
    """Decimated torque (T,) of a term of a fit, on its own joint [N m or N]."""
    names = found.regression.names
    own = [names.index(name) for name in term.columns(found.model.robot.joints)]
    values = np.array([term.values[p.name] for p in term.law.linear])
    return found.regression.columns[:, term.index, own] @ values


def _variables(found: Estimate, term: Term) -> dict[str, Variable]:
    """What a law is about, by name; empty: nothing that a function could be asked of."""
    law, joints = term.law, found.model.robot.joints
    if not isinstance(law, TorqueLaw) or law.rate is not None:
        return {}
    axis, own = law.shown_against, joints[term.index]
    if axis in _LOADS:
        torque = torque_at_joint(found, term)
        return {"own torque": variable(torque, None)} if np.ptp(torque) > VARIES else {}
    names = [f"{_OWN[axis]}_{own}"] if axis in _OWN else []
    if axis == "position" and follows_direction(law):
        names.append(f"dq_{own}")
    if term.other is not None:
        partner = _PARTNER.get(axis, _OWN.get(axis))
        names += [f"{partner}_{joints[term.other]}"] if partner else []
    table = table_of(found)
    return {name: table[name] for name in names if name in table}
