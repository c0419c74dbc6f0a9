"""What the laws of a joint do to its torque when it moves otherwise than its encoder says, to first order.

Friction and rotors follow the true motion. Where an encoder turns out wrong they change with it: friction
reverses elsewhere, which shows as much as what the rigid body does.
"""

from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import of_kind
from jaxswarm.identify.forward.columns import term_columns

# Steps of the differences [rad or m, rad/s^2 or m/s^2]: laws are smooth over a milliradian, and rotors linear.
# Of the speed it is the width of the joint's sign.
_STEP_Q, _STEP_DDQ = 1e-3, 1.0


def own_slopes(lin: Linearization, joint: int, log: int) -> np.ndarray:
    """Derivatives (3, T) of a joint's own torque by its q, dq, ddq along a log.

    Laws with a memory are left out: what they do is no function of the moment.
    """
    known = lin.own_slopes
    if (joint, log) not in known:
        known[joint, log] = _differences(lin, joint, log)
    return known[joint, log]


def _differences(lin: Linearization, joint: int, log: int) -> np.ndarray:
    model, motion = lin.found.model, lin.true[log]
    steps = {"q": _STEP_Q, "dq": model.width[joint], "ddq": _STEP_DDQ}
    terms = [
        t
        for t in of_kind(model.terms, TorqueLaw)
        if t.joint == joint and t.law.rate is None and t.acts_in(log)
    ]

    def torque(name: str, step: float) -> np.ndarray:
        x = getattr(motion, name).copy()
        x[:, joint] += step
        moved = replace(motion, **{name: x})
        total = np.zeros(len(motion.t))
        for term in terms:
            values = [term.values[p.name] for p in term.law.linear]
            total += term_columns(term, moved, model.width, lin.loads[log]) @ values
        return total

    return np.stack([(torque(n, h) - torque(n, -h)) / (2.0 * h) for n, h in steps.items()])
