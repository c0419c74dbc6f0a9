"""Torques of effects along a finished run: of a law, of the declared model, and what a structure does."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from benchmarks.worlds.arm import Arm
from benchmarks.worlds.laws import LAWS, STRUCTURAL, Effect, torque_of
from benchmarks.worlds.memory import along
from benchmarks.worlds.record import measured_torque
from benchmarks.worlds.rigid import inverse_dynamics
from benchmarks.worlds.simulate import Run


def view(arm: Arm, run: Run, effect: Effect) -> SimpleNamespace:
    """A run as the laws read it: one row a joint."""
    s = SimpleNamespace(q=run.q.T, dq=run.dq.T, ddq=run.ddq.T, t=run.t)
    s.sign = np.tanh(run.dq / arm.width).T
    s.load = inverse_dynamics(arm, run.q, run.dq, run.ddq).T
    law = LAWS[effect.kind]
    if law.memory:
        s.state = along(law, effect.params, run.t, run.dq[:, effect.joint])
    return s


def law_torque(arm: Arm, run, effect: Effect) -> np.ndarray:
    """Torque that the law of an effect states along a motion, (T, n)."""
    torque = np.zeros_like(run.tau)
    for joint, (dry, rest) in torque_of(effect, view(arm, run, effect)).items():
        torque[:, joint] = dry * np.tanh(run.dq[:, joint] / arm.width[joint]) + rest
    return torque


def effect_torques(arm: Arm, run: Run, effects: tuple[Effect, ...]) -> np.ndarray:
    """Torque of each effect at all ticks of a run, as encoder and torque channel see it, (E, T, n).

    What a structural effect does is what is left of the measured torque when the true bodies, friction
    and rotors and all other effects are taken away.
    """
    parts = run.parts.copy()
    structural = [i for i, e in enumerate(effects) if e.kind in STRUCTURAL]
    if structural:
        # Torque is held over a tick, so what acts about an instant is the mean of two ticks. The state
        # is differentiated as coarsely: a motor before a soft gear jumps at every tick.
        tau = measured_torque(run, effects)
        tau[1:] = 0.5 * (tau[1:] + tau[:-1])
        smooth = replace(run, ddq=np.gradient(run.dq, run.t, axis=0))
        parts[structural[0]] = tau - declared_torque(arm, smooth) - parts.sum(axis=0)
    return parts


def declared_torque(arm: Arm, run: Run) -> np.ndarray:
    """Bodies, friction and rotors of the arm at the true parameters, (T, n)."""
    torque = inverse_dynamics(arm, run.q, run.dq, run.ddq) + arm.rotor * run.ddq
    return torque + arm.viscous * run.dq + arm.coulomb * np.tanh(run.dq / arm.width)
