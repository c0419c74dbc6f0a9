"""The elbow on a base that gives way, and with a soft joint, both moved by Pinocchio."""

from collections.abc import Callable

import numpy as np
import pinocchio as pin
from elbow import elbow
from planted import NOISE

from jaxswarm.identify.synthetic import fourier_motion
from jaxswarm.logs.log import Log

RATE, SUBSTEPS, DURATION, SPEED = 125.0, 4, 12.0, 4.0
FRICTION, WIDTH = 2.0, 0.01


def on_hinges(turns: int = 2) -> pin.Model:
    """The elbow on so many hinges without mass: about base x, then y."""
    arm, model = elbow(), pin.Model()
    model.gravity.linear = np.asarray(arm.gravity, float)
    above = 0
    for hinge, name in ((pin.JointModelRX(), "x"), (pin.JointModelRY(), "y"))[:turns]:
        above = model.addJoint(above, hinge, pin.SE3.Identity(), name)
    for j, name in enumerate(arm.joints):
        hinge = pin.JointModelRevoluteUnaligned(np.asarray(arm.axis[j], float))
        place = pin.SE3(np.asarray(arm.rotation[j], float), np.asarray(arm.translation[j], float))
        above = model.addJoint(above, hinge, place, name)
        body = pin.Inertia.FromDynamicParameters(np.asarray(arm.parameters[j], float))
        model.appendBodyToJoint(above, body, pin.SE3.Identity())
    return model


def given_motion() -> tuple[np.ndarray, ...]:
    """t (T,), q, dq, ddq (T, 3) of the motors, on the steps of the integration."""
    return fourier_motion(3, np.random.default_rng(1), DURATION, RATE * SUBSTEPS, SPEED)


def integrated(free: Callable, x: np.ndarray, v: np.ndarray, steps: int) -> tuple[np.ndarray, ...]:
    """Positions, velocities and accelerations (steps, k) of what moves freely: semi-implicit Euler.

    ``free(k, x, v)`` is the acceleration (k,) at a step.
    """
    h = 1.0 / (RATE * SUBSTEPS)
    told = []
    for k in range(steps):
        a = free(k, x, v)
        told.append((x, v, a))
        v = v + h * a
        x = x + h * v
    return tuple(np.array(part) for part in zip(*told, strict=True))


def log_of(torque: np.ndarray, t, q, dq) -> Log:
    """What an arm with usual friction and noise logs of a torque (T, 3) on the integration's steps."""
    kept, rng = slice(None, None, SUBSTEPS), np.random.default_rng(1)
    tau = torque + FRICTION * (dq + np.tanh(dq / WIDTH))
    q, tau = q[kept], tau[kept]
    return Log(
        source="moved by Pinocchio",
        joints=elbow().joints,
        t=t[kept],
        q=q + NOISE.position * rng.normal(size=q.shape),
        tau=tau + NOISE.torque * rng.normal(size=q.shape),
    )


def log_on_soft_base(cx: float, cy: float, inertia: float = 0.0) -> Log:
    """The base, of an inertia [kg m^2], swings on springs of 1/c [N m/rad], damped to a tenth."""
    model = on_hinges()
    model.armature = np.r_[inertia, inertia, np.zeros(3)]
    data = model.createData()
    t, q, dq, ddq = given_motion()
    stiffness, none = 1.0 / np.array([cx, cy]), np.zeros(2)

    def free(k, x, v):
        place, speed = np.concatenate([x, q[k]]), np.concatenate([v, dq[k]])
        held = pin.rnea(model, data, place, speed, np.concatenate([none, ddq[k]]))[:2]
        mass = pin.crba(model, data, place)[:2, :2]
        mass = np.triu(mass) + np.triu(mass, 1).T
        damping = 0.2 * np.sqrt(stiffness * np.diag(mass))
        return np.linalg.solve(mass, -stiffness * x - damping * v - held)

    rest = pin.rnea(model, data, np.concatenate([none, q[0]]), np.zeros(5), np.zeros(5))[:2]
    sway = integrated(free, -rest / stiffness, none, len(t))
    whole = [np.column_stack(pair) for pair in zip(sway, (q, dq, ddq), strict=True)]
    torque = [pin.rnea(model, data, *x)[2:] for x in zip(*whole, strict=True)]
    return log_of(np.array(torque), t, q, dq)


def log_with_soft_joint(joint: int, k: float, d: float) -> Log:
    """A link behind its motor on a spring; the motor moves as given."""
    model = on_hinges(0)
    data = model.createData()
    t, q, dq, ddq = given_motion()

    def free(step, x, v):
        place, speed, push = q[step].copy(), dq[step].copy(), ddq[step].copy()
        place[joint], speed[joint], push[joint] = x[0], v[0], 0.0
        held = pin.rnea(model, data, place, speed, push)[joint]
        mass = pin.crba(model, data, place)[joint, joint]
        spring = k * (q[step, joint] - x[0]) + d * (dq[step, joint] - v[0])
        return np.array([(spring - held) / mass])

    pressed = pin.rnea(model, data, q[0], dq[0], ddq[0])[joint]
    link = integrated(free, q[0, [joint]] - pressed / k, dq[0, [joint]], len(t))
    moved = [np.array(x) for x in (q, dq, ddq)]
    for own, one in zip(moved, link, strict=True):
        own[:, joint] = one[:, 0]
    torque = [pin.rnea(model, data, *x) for x in zip(*moved, strict=True)]
    return log_of(np.array(torque), t, q, dq)
