"""One run of a world in MuJoCo: the controller's ticks outside, friction at every step of the simulation.

The sign of friction is steep, so its slope is given to MuJoCo as damping, which its Euler integrator treats
implicitly, and the rest of the torque as an applied force; both together are the law at the step's begin. On an
arm whose friction holds, dry friction is MuJoCo's constraint instead, of the level that all laws together have.
The torque is held between ticks. What is returned is sampled at the ticks: state at the tick, torque
of the tick, mean acceleration of the first step of the tick.
"""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import mujoco
import numpy as np

from benchmarks.worlds.arm import GRAVITY, Arm, mjcf
from benchmarks.worlds.bodies import BODY_FIELDS, askew, carried, loaded
from benchmarks.worlds.control import Control, make_controller
from benchmarks.worlds.laws import IN_BODY, LAWS, Effect, is_torque, torque_of
from benchmarks.worlds.motion import Motion, reference
from benchmarks.worlds.reading import said

RUN_IN = 1.0
# Longest step [s]; a tick has at least two.
_STEP = 2.5e-4
# Tracking error [rad, m] and torque (in RMS torques of usual motion) beyond which a world is refused.
_LOST = (0.5, 0.1)
# Stiffness of a gear's closed flank: natural frequency [Hz] of the link on it, and its damping ratio.
_FLANK, _FLANK_DAMPING = 60.0, 0.3


class DivergedError(Exception):
    """The arm did not follow: the world is drawn again."""


@dataclass(frozen=True)
class Run:
    """A run at the control ticks; times before zero are left out.

    Attributes:
        t: (T,) [s].
        q, dq, ddq: As the encoder sees them (motor side), (T, n).
        tau: Motor torque, held until the next tick, (T, n).
        parts: Torque of each effect that is a torque, (E, T, n).
    """

    t: np.ndarray
    q: np.ndarray
    dq: np.ndarray
    ddq: np.ndarray
    tau: np.ndarray
    parts: np.ndarray


def find(effects: tuple[Effect, ...], kind: str) -> list[Effect]:
    return [e for e in effects if e.kind == kind]


def simulate(
    arm: Arm,
    effects: tuple[Effect, ...],
    control: Control,
    motion: Motion,
    quantum: np.ndarray,
    compliance: np.ndarray,
) -> Run:
    """Follow a motion in closed loop.

    Args:
        arm: With its true friction and rotors.
        effects: What acts besides.
        control: The controller.
        motion: The reference.
        quantum: Step of the encoders, (n,).
        compliance: Inertia behind each joint's gear, (n,), for the flank of a backlash.

    Raises:
        DivergedError: If the tracking error grows beyond all reason.
    """
    n, period = arm.size, 1.0 / control.rate
    substeps = max(2, int(np.ceil(period / _STEP)))
    h = period / substeps
    t = np.arange(-round(RUN_IN * control.rate), round(motion.seconds * control.rate) + 1) * period
    ref = reference(motion, arm, t)
    law = make_controller(control, arm, ref)
    rig = _Rig(arm, effects, h, compliance)
    rig.start(ref[0][0], ref[1][0])
    kept = np.flatnonzero(t >= -1e-9)
    run = Run(
        t[kept],
        *(np.zeros((len(kept), n)) for _ in range(4)),
        np.zeros((len(effects), len(kept), n)),
    )
    lost = np.where(arm.sliding, _LOST[1], _LOST[0])
    first, still = kept[0], np.zeros(n)
    for k in range(len(t)):
        q, dq = rig.q[rig.motor], rig.v[rig.motor]
        seen, speed, _ = said(effects, q, dq, still)
        measured = np.round(seen / quantum) * quantum
        if k % 64 == 0 and not (np.abs(q - ref[0][k]) < lost + np.abs(seen - q)).all():
            raise DivergedError
        tau = law(k, measured, speed)
        ddq = rig.step(tau, t[k])
        if k >= first:
            i = k - first
            run.q[i], run.dq[i], run.ddq[i] = said(effects, q, dq, ddq)
            run.tau[i] = tau
            run.parts[:, i] = rig.parts
            for row, e in enumerate(effects):
                if e.kind in IN_BODY:
                    run.parts[row, i, e.joint] = e.params["ia"] * ddq[e.joint]
        for part in range(1, substeps):
            rig.step(tau, t[k] + part * h)
    return run


class _Rig:
    """MuJoCo's model with the effects around it."""

    def __init__(self, arm: Arm, effects: tuple[Effect, ...], h: float, compliance: np.ndarray):
        soft = tuple(sorted(e.joint for e in effects if e.kind in ("joint_elasticity", "backlash")))
        gravity = GRAVITY
        for e in find(effects, "base_tilt"):
            x, y = e.params["gx"], e.params["gy"]
            gravity = np.array([x, y, -np.sqrt(GRAVITY[2] ** 2 - x**2 - y**2)])
        for e in find(effects, "rotor_inertia"):
            arm = replace(arm, rotor=arm.rotor + e.params["ia"] * (np.arange(arm.size) == e.joint))
        built = askew(arm, effects)
        self.model = mujoco.MjModel.from_xml_string(mjcf(built, h, gravity, soft))
        self.bodies = [
            (e, *(_bodies(mjcf(x, h, gravity, soft)) for x in (built, loaded(built, e))))
            for e in find(effects, "payload_change")
        ]
        self.data = mujoco.MjData(self.model)
        self.arm, self.h = arm, h
        self.motor = np.array([j + sum(s < j for s in soft) for j in range(arm.size)])
        self.q, self.v = self.data.qpos, self.data.qvel
        self.torques = [
            (i, e) for i, e in enumerate(effects) if is_torque(e) and e.kind not in IN_BODY
        ]
        self.memory = {i: 0.0 for i, e in enumerate(effects) if LAWS[e.kind].memory}
        self.loads = any(e.kind == "load_dependent_friction" for e in effects)
        self.links = [
            (self.motor[e.joint] + 1, e, compliance[e.joint])
            for e in effects
            if e.kind in ("joint_elasticity", "backlash")
        ]
        self.parts = np.zeros((len(effects), arm.size))
        self.ddq = np.zeros(arm.size)
        self.rigid = np.zeros(self.model.nv)

    def start(self, q, dq):
        self.q[self.motor], self.v[self.motor] = q, dq
        mujoco.mj_forward(self.model, self.data)

    def step(self, tau: np.ndarray, t: float) -> np.ndarray:
        """One step under a torque; returns the mean acceleration of the motors, (n,)."""
        model, data, arm = self.model, self.data, self.arm
        for effect, *bodies in self.bodies:
            for name, values in bodies[int(carried(effect, t))].items():
                getattr(model, name)[:] = values
        dq = self.v[self.motor]
        sign = np.tanh(dq / arm.width)
        dry, rest = arm.coulomb.copy(), arm.viscous * dq
        if self.torques:
            self._effects(dq, sign, t, dry, rest)
        if arm.held:
            model.dof_frictionloss[self.motor] = np.maximum(dry, 0.0)
            dry = np.minimum(dry, 0.0)
        slope = np.maximum(dry, 0.0) * (1.0 - sign * sign) / arm.width + arm.viscous
        # Damping opposes slope * dq by itself: what is applied is the torque less the rest of the law.
        applied, damping = data.qfrc_applied, model.dof_damping
        applied[self.motor] = tau - dry * sign - rest + slope * dq
        damping[self.motor] = slope
        for dof, effect, inertia in self.links:
            applied[dof], damping[dof] = _link_torque(effect, inertia, self.q[dof])
        mujoco.mj_step(model, data)
        self.ddq = (self.v[self.motor] - dq) / self.h
        return self.ddq

    def _effects(self, dq, sign, t, dry, rest):
        s = SimpleNamespace(q=self.q[self.motor], dq=dq, ddq=self.ddq, sign=sign, t=t, load=None)
        if self.loads:
            s.load = self._load()
        for i, effect in self.torques:
            if i in self.memory:
                s.state, law = self.memory[i], LAWS[effect.kind]
                self.memory[i] = law.memory(effect.params, s.state, dq[effect.joint], self.h)
            for j, (a, b) in torque_of(effect, s).items():
                dry[j] += a
                rest[j] += b
                self.parts[i, j] = a * sign[j] + b

    def _load(self):
        """Torque of the rigid body at the present state and the latest acceleration, (n,)."""
        self.data.qacc[:] = 0.0
        self.data.qacc[self.motor] = self.ddq
        mujoco.mj_rne(self.model, self.data, 1, self.rigid)
        return self.rigid[self.motor]


def _bodies(text: str) -> dict[str, np.ndarray]:
    """The bodies of a model by the names of MuJoCo's fields."""
    model = mujoco.MjModel.from_xml_string(text)
    return {name: getattr(model, name).copy() for name in BODY_FIELDS}


def _link_torque(effect: Effect, inertia: float, e: float) -> tuple[float, float]:
    """Torque on the deflection of a link, and its damping coefficient."""
    if effect.kind == "joint_elasticity":
        return -effect.params["k"] * e, effect.params["d"]
    omega, gap = 2 * np.pi * _FLANK, effect.params["gap"]
    beyond = e - gap if e > gap else e + gap if e < -gap else 0.0
    return -inertia * omega**2 * beyond, 2 * _FLANK_DAMPING * omega * inertia * (beyond != 0.0)
