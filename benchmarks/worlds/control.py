"""Controllers at a drive's rate: PD with inexact feed-forward, computed torque, cascaded P-PI.

What they know of the arm is wrong: bodies and friction of an inner model are drawn beside the true ones.
Each is a function ``(k, q, dq) -> torque`` of the tick, the encoder's position and the velocity.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pinocchio

from benchmarks.worlds.arm import Arm, pin_model
from benchmarks.worlds.families import joint_scales

KINDS = ("pd", "computed", "cascade")
RATES = (500, 1000, 2000, 4000)
# How wrong the inner model's masses are, as a standard deviation of their logarithm.
_WRONG = 0.2


@dataclass(frozen=True)
class Control:
    """Kind, rate [Hz], seed of the inner model's errors, and bandwidth [rad/s]."""

    kind: str
    rate: int
    seed: int
    bandwidth: float


def inner_arm(control: Control, arm: Arm) -> Arm:
    """The arm as the controller believes it to be."""
    rng = np.random.default_rng(control.seed)
    n = arm.size
    factor = np.exp(_WRONG * rng.normal(size=n))
    return replace(
        arm,
        mass=arm.mass * factor,
        com=arm.com * (1 + 0.1 * rng.normal(size=(n, 3))),
        inertia=arm.inertia * factor[:, None, None],
        rotor=arm.rotor * rng.uniform(0.7, 1.2, n),
        coulomb=arm.coulomb * rng.uniform(0.3, 1.1, n),
        viscous=arm.viscous * rng.uniform(0.3, 1.1, n),
    )


def make_controller(control: Control, arm: Arm, ref: tuple) -> Callable:
    """The control law along a reference ``(q, dq, ddq)`` sampled at the control rate."""
    inner = inner_arm(control, arm)
    inertia = joint_scales(inner)[0]
    friction = ref[1] * inner.viscous + np.tanh(ref[1] / (3 * inner.width)) * inner.coulomb
    maker = {"pd": _pd, "computed": _computed, "cascade": _cascade}[control.kind]
    return maker(control, inner, inertia, friction, ref)


def _pd(control, inner, inertia, friction, ref):
    rq, rdq, rddq = ref
    forward = _inverse_dynamics(inner, ref) + friction
    kp = inertia * control.bandwidth**2
    kd = inertia * 1.4 * control.bandwidth

    def law(k, q, dq):
        return forward[k] + kp * (rq[k] - q) + kd * (rdq[k] - dq)

    return law


def _computed(control, inner, inertia, friction, ref):
    rq, rdq, rddq = ref
    model = pin_model(inner)
    data = model.createData()
    kp, kd, rotor = control.bandwidth**2, 1.4 * control.bandwidth, inner.rotor

    def law(k, q, dq):
        wanted = rddq[k] + kp * (rq[k] - q) + kd * (rdq[k] - dq)
        return pinocchio.rnea(model, data, q, dq, wanted) + rotor * wanted + friction[k]

    return law


def _cascade(control, inner, inertia, friction, ref):
    rq, rdq, rddq = ref
    outer, kv = 0.5 * control.bandwidth, inertia * 1.4 * control.bandwidth
    ki = kv * 0.3 * control.bandwidth / control.rate
    # Drives of this kind know the inertia of their own axis and the weight, at most.
    model = pin_model(inner)
    data = model.createData()
    weight = np.array([pinocchio.computeGeneralizedGravity(model, data, q) for q in rq[::20]])
    forward = np.repeat(weight, 20, axis=0)[: len(rq)] + 0.8 * inertia * rddq
    stored = np.zeros(inner.size)

    def law(k, q, dq):
        nonlocal stored
        error = rdq[k] + outer * (rq[k] - q) - dq
        stored = stored + ki * error
        return forward[k] + kv * error + stored

    return law


def _inverse_dynamics(arm, ref):
    model = pin_model(arm)
    data = model.createData()
    rows = [pinocchio.rnea(model, data, *row).copy() for row in zip(*ref, strict=True)]
    return np.array(rows) + arm.rotor * ref[2]
