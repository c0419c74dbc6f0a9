"""What a model was not shown of a motion on which it is asked: ranges of found laws, a swing that had begun."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.identify.forward.link_lag import slope_terms, unseen_start
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Motion

# Share of a motion outside of a law's range from which on it is told: the range itself is that of all samples
# of another log, whose outermost ones any motion may pass.
_TOLD = 0.01
_MOTION = ("q", "dq", "ddq")


def beyond_seen(model: Model, motions: Sequence[Motion]) -> tuple[str, ...]:
    """A sentence on every law that was found as a formula and is asked where it was not seen.

    Of its variables positions, velocities and accelerations are looked at, of its joint and its partner.
    """
    told = []
    joints = model.robot.joints
    for term in model.terms:
        for name, low, high in term.formula.valid if term.formula is not None else ():
            place = term.other if name.endswith("_other") else term.joint
            kind = name.removesuffix("_other")
            if kind not in _MOTION or place is None:
                continue
            x = np.concatenate([getattr(m, kind)[:, place] for m in motions])
            share = float(((x < low) | (x > high)).mean())
            if share > _TOLD:
                told.append(
                    f"The law found on {joints[term.index]} is a guess in {100 * share:.0f} % of the samples: "
                    f"it was seen for {kind}_{joints[place]} from {low:.3g} to {high:.3g} only."
                )
    return tuple(told)


def begun_before(model: Model, motions: Sequence[Motion]) -> tuple[str, ...]:
    """A sentence on the time in which a link of the model may swing by what was before the motion."""
    if not slope_terms(model.terms):
        return ()
    return tuple(swing_note(start) for start in map(unseen_start, motions) if start > 0.0)


def swing_note(seconds: float) -> str:
    """What cannot be known of the first seconds of a log."""
    return (
        f"The first {seconds:.2g} s are neither fitted nor scored: the log begins in motion, and a link on a "
        "spring may still swing by what was before it. Begin logs at rest."
    )
