"""Torques of undeclared effects, written afresh: those of the catalog here, others in :mod:`outside`.

A law gives ``(dry, rest)`` and acts with ``dry * sign + rest``, ``sign = tanh(dq / width)``; what multiplies
the sign is kept apart because the simulation has to treat the steep sign implicitly. ``S`` holds rows
``q, dq, ddq, sign, load`` (one a joint), ``t`` and the ``state`` of a law's memory, each a number or an array
over time. Amplitudes named in ``scaled`` are solved for from the wanted strength; the torque is linear in them.
"""

from dataclasses import replace

import numpy as np

from benchmarks.worlds.effect import Effect as Effect
from benchmarks.worlds.effect import Law as Law
from benchmarks.worlds.families import log_uniform
from benchmarks.worlds.memory import dahl
from benchmarks.worlds.outside import OUTSIDE_LAWS


def _unit(rng, slide):
    return 0.1 if slide else 1.0


def _asymmetric(p, s, j, o):
    forward = 0.5 * (1.0 + s.sign[j])
    return forward * p["fc_more"], forward * p["b_more"] * s.dq[j]


def _ripple(rng, slide):
    phase = rng.uniform(0, 2 * np.pi)
    n = rng.uniform(60.0, 190.0) if slide else rng.uniform(6.0, 60.0)
    return {"sine": np.cos(phase), "cosine": np.sin(phase), "n": n}


def _spring(rng, slide):
    return {"k": 1.0, "tau0": -rng.uniform(-0.5, 0.5) * _unit(rng, slide)}


def _couple(rng, slide):
    return {"b": float(rng.choice([-1.0, 1.0])), "fc": 0.0, "ia": 0.0}


_INSIDE_LAWS = {
    "viscous_friction": Law(
        lambda p, s, j, o: (0.0, p["b"] * s.dq[j]), lambda r, w: {"b": 1.0}, ("b",)
    ),
    "coulomb_friction": Law(lambda p, s, j, o: (p["fc"], 0.0), lambda r, w: {"fc": 1.0}, ("fc",)),
    "rotor_inertia": Law(
        lambda p, s, j, o: (0.0, p["ia"] * s.ddq[j]), lambda r, w: {"ia": 1.0}, ("ia",)
    ),
    "stribeck_friction": Law(
        lambda p, s, j, o: (p["df"] * np.exp(-((s.dq[j] / p["vs"]) ** 2)), 0.0),
        lambda r, w: {"df": 1.0, "vs": log_uniform(r, 0.03, 0.2) * (0.2 if w else 1), "delta": 2.0},
        ("df",),
    ),
    "load_dependent_friction": Law(
        lambda p, s, j, o: (p["mu"] * np.abs(s.load[j]), 0.0),
        lambda r, w: {"mu": 1.0, "inertial": 1.0},
        ("mu",),
    ),
    "torque_ripple": Law(
        lambda p, s, j, o: (
            0.0,
            p["sine"] * np.sin(p["n"] * s.q[j]) + p["cosine"] * np.cos(p["n"] * s.q[j]),
        ),
        _ripple,
        ("sine", "cosine"),
    ),
    "joint_spring": Law(
        lambda p, s, j, o: (0.0, p["k"] * s.q[j] + p["tau0"]), _spring, ("k", "tau0")
    ),
    "torque_offset": Law(
        lambda p, s, j, o: (0.0, p["tau0"] + 0.0 * s.q[j]), lambda r, w: {"tau0": 1.0}, ("tau0",)
    ),
    "hysteresis": Law(
        lambda p, s, j, o: (0.0, p["fc"] * s.state),
        lambda r, w: {"fc": 1.0, "x0": log_uniform(r, 0.01, 0.1) * (0.1 if w else 1)},
        ("fc",),
        memory=dahl,
    ),
    "asymmetric_friction": Law(
        _asymmetric,
        lambda r, w: {"fc_more": 1.0, "b_more": r.uniform(0.0, 0.5)},
        ("fc_more", "b_more"),
    ),
    "quadratic_drag": Law(
        lambda p, s, j, o: (0.0, p["c"] * s.dq[j] * np.abs(s.dq[j])),
        lambda r, w: {"c": 1.0},
        ("c",),
    ),
    "nonlinear_viscous_friction": Law(
        lambda p, s, j, o: (p["c"] * np.abs(s.dq[j]) ** p["alpha"], 0.0),
        lambda r, w: {"c": 1.0, "alpha": r.uniform(0.3, 0.6)},
        ("c",),
    ),
    "thermal_drift": Law(
        lambda p, s, j, o: (p["fc"] * np.expm1(-np.maximum(s.t, 0.0) / p["tc"]), 0.0),
        lambda r, w: {"fc": 1.0, "tc": log_uniform(r, 5.0, 20.0)},
        ("fc",),
        resists=True,
    ),
    "transmission_coupling": Law(
        lambda p, s, j, o: (0.0, p["b"] * s.dq[o]),
        _couple,
        ("b",),
        pair=True,
    ),
    "joint_elasticity": Law(None, lambda r, w: {"k": 1.0, "d": 0.0}),
    "backlash": Law(None, lambda r, w: {"gap": log_uniform(r, 1e-3, 1e-2) * (0.1 if w else 1)}),
    "drive_gain": Law(None, lambda r, w: {"gain": 1.0}),
    "time_delay": Law(None, lambda r, w: {"seconds": 0.0}),
    "base_tilt": Law(None, lambda r, w: {"gx": 0.0, "gy": 0.0}),
    "contact": Law(None, lambda r, w: {"seconds": log_uniform(r, 0.3, 3.0)}),
}
INSIDE, OUTSIDE = tuple(_INSIDE_LAWS), tuple(OUTSIDE_LAWS)
LAWS = {**_INSIDE_LAWS, **OUTSIDE_LAWS}
# Effects that are not a torque on a joint: at most one of them in a world, so that what they do to the
# torque is what remains when everything else is subtracted.
STRUCTURAL = tuple(k for k, law in LAWS.items() if law.torque is None and k != "contact")
GLOBAL = ("time_delay", "torque_lag", "base_tilt", "contact", "payload_change")
# What happens in one run between two times, and in no other.
EVENTS = ("contact", "payload_change")
# Kept in MuJoCo's mass matrix: a torque that lags behind the acceleration would not be stable.
IN_BODY = ("rotor_inertia",)
# Ramp of a contact [s].
RAMP = 0.01


def scaled(effect: Effect, factor: float) -> Effect:
    """The effect with its amplitudes multiplied."""
    names = LAWS[effect.kind].scaled
    params = {k: v * factor if k in names else v for k, v in effect.params.items()}
    return replace(effect, params=params)


def is_torque(effect: Effect) -> bool:
    """Whether an effect is a torque on joints of the arm."""
    return effect.kind == "contact" or LAWS[effect.kind].torque is not None


def torque_of(effect: Effect, s) -> dict[int, tuple]:
    """``(dry, rest)`` by joint, for effects that are torques."""
    if effect.kind == "contact":
        p = effect.params
        up = np.clip((s.t - p["start"]) / RAMP, 0.0, 1.0)
        window = up * np.clip((p["end"] - s.t) / RAMP, 0.0, 1.0)
        return {j: (0.0, tau * window) for j, tau in enumerate(p["tau"]) if tau}
    law, j, o = LAWS[effect.kind], effect.joint, effect.other
    if law.torque is None:
        return {}
    parts = {j: law.torque(effect.params, s, j, o)}
    if effect.kind == "cable_coupling":  # a taut cable pulls at both of its ends
        parts[o] = (0.0, effect.params["c"] * parts[j][1])
    return parts
