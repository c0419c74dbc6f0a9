"""Torques of undeclared effects, written afresh: of the catalog, and of laws that no catalog holds.

A law gives ``(dry, rest)`` and acts with ``dry * sign + rest``, ``sign = tanh(dq / width)``; what multiplies
the sign is kept apart because the simulation has to treat the steep sign implicitly. ``S`` holds rows
``q, dq, ddq, sign, load`` (one a joint) and ``t``, each a number or an array over time. Amplitudes named in
``scaled`` are solved for from the wanted strength; the torque is linear in them.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from benchmarks.worlds.families import log_uniform


@dataclass(frozen=True)
class Effect:
    """One undeclared effect: its kind, where it acts (index or None), and its parameters."""

    kind: str
    joint: int | None = None
    other: int | None = None
    params: dict = field(default_factory=dict, compare=False)


@dataclass(frozen=True)
class Law:
    """How a kind acts on its joint, and what is drawn for it.

    Attributes:
        torque: ``(params, S, joint, other) -> (dry, rest)``; None where the effect is no torque.
        draw: ``(rng, slide) -> params`` with amplitudes of one.
        scaled: Names of the amplitudes.
        outside: Not in the catalog.
        pair: Acts on one joint by the motion of another.
        resists: Takes from the dry friction of its joint, which must stay positive.
    """

    torque: Callable | None
    draw: Callable
    scaled: tuple[str, ...] = ()
    outside: bool = False
    pair: bool = False
    resists: bool = False


def _unit(rng, slide):
    return 0.1 if slide else 1.0


def _asymmetric(p, s, j, o):
    forward = 0.5 * (1.0 + s.sign[j])
    return forward * p["fc_more"], forward * p["b_more"] * s.dq[j]


def _compensator(p, s, j, o):
    turn = s.q[j] - p["q0"]
    length = np.sqrt(p["r"] ** 2 + p["d"] ** 2 - 2.0 * p["r"] * p["d"] * np.cos(turn))
    return 0.0, p["k"] * (1.0 - p["free"] / length) * p["r"] * p["d"] * np.sin(turn)


def _ripple(rng, slide):
    phase = rng.uniform(0, 2 * np.pi)
    n = rng.uniform(60.0, 190.0) if slide else rng.uniform(6.0, 60.0)
    return {"sine": np.cos(phase), "cosine": np.sin(phase), "n": n}


def _spring(rng, slide):
    return {"k": 1.0, "tau0": -rng.uniform(-0.5, 0.5) * _unit(rng, slide)}


def _couple(rng, slide):
    return {"b": float(rng.choice([-1.0, 1.0])), "fc": 0.0, "ia": 0.0}


LAWS = {
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
        lambda p, s, j, o: (0.0, p["fc"] * s.bristle),
        lambda r, w: {"fc": 1.0, "x0": log_uniform(r, 0.01, 0.1) * (0.1 if w else 1)},
        ("fc",),
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
    "encoder_offset": Law(None, lambda r, w: {"dq0": 0.0}, outside=True),
    "cubic_spring": Law(
        lambda p, s, j, o: (0.0, p["k"] * s.q[j] ** 3),
        lambda r, w: {"k": 1.0},
        ("k",),
        outside=True,
    ),
    "position_dependent_friction": Law(
        lambda p, s, j, o: (p["fc"] * np.cos(p["n"] * s.q[j] + p["phase"]), 0.0),
        lambda r, w: {
            "fc": 1.0,
            "n": r.uniform(10.0, 30.0) if w else r.uniform(1.0, 4.0),
            "phase": r.uniform(0, 2 * np.pi),
        },
        ("fc",),
        outside=True,
        resists=True,
    ),
    "friction_change": Law(
        lambda p, s, j, o: (p["fc"] * (s.t > p["start"]), 0.0),
        lambda r, w: {"fc": 1.0, "start": r.uniform(0.3, 0.7)},
        ("fc",),
        outside=True,
    ),
    "periodic_force": Law(
        lambda p, s, j, o: (0.0, p["a"] * np.sin(2 * np.pi * p["hertz"] * s.t + p["phase"])),
        lambda r, w: {
            "a": 1.0,
            "hertz": log_uniform(r, 0.5, 5.0),
            "phase": r.uniform(0, 2 * np.pi),
        },
        ("a",),
        outside=True,
    ),
    "gravity_compensator": Law(
        _compensator,
        lambda r, w: {"k": 1.0, "q0": r.uniform(-0.5, 0.5), "r": 0.1, "d": 0.4, "free": 0.25},
        ("k",),
        outside=True,
    ),
    "cable_coupling": Law(
        lambda p, s, j, o: (0.0, p["k"] * (s.q[j] + p["c"] * s.q[o] - p["q0"])),
        lambda r, w: {
            "k": 1.0,
            "c": r.uniform(0.5, 1.5) * r.choice([-1, 1]),
            "q0": r.uniform(-1, 1),
        },
        ("k",),
        outside=True,
        pair=True,
    ),
}
INSIDE = tuple(k for k, law in LAWS.items() if not law.outside)
OUTSIDE = tuple(k for k, law in LAWS.items() if law.outside)
# Effects that are not a torque on a joint: at most one of them in a world, so that what they do to the
# torque is what remains when everything else is subtracted.
STRUCTURAL = tuple(k for k, law in LAWS.items() if law.torque is None and k != "contact")
GLOBAL = ("time_delay", "base_tilt", "contact")
# Kept in MuJoCo's mass matrix: a torque that lags behind the acceleration would not be stable.
IN_BODY = ("rotor_inertia",)
# Ramp of a touch [s].
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
