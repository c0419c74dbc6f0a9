"""Laws that the catalog did not hold when these worlds were drawn; written as those of :mod:`laws`."""

import numpy as np

from benchmarks.worlds.effect import Law
from benchmarks.worlds.families import log_uniform
from benchmarks.worlds.memory import age, lugre


def _compensator(p, s, j, o):
    turn = s.q[j] - p["q0"]
    length = np.sqrt(p["r"] ** 2 + p["d"] ** 2 - 2.0 * p["r"] * p["d"] * np.cos(turn))
    return 0.0, p["k"] * (1.0 - p["free"] / length) * p["r"] * p["d"] * np.sin(turn)


def _eccentric(rng, slide):
    once, twice = rng.uniform(0, 2 * np.pi, 2)
    part = rng.uniform(0.2, 1.0)
    return {
        "s1": 0.01 * np.cos(once),
        "c1": 0.01 * np.sin(once),
        "s2": 0.01 * part * np.cos(twice),
        "c2": 0.01 * part * np.sin(twice),
    }


def _askew(rng, slide):
    """Mostly a shift, or mostly a turn."""
    large, small = rng.choice([-1, 1], 2) * [1.0, 0.2]
    return (
        {"shift": 5e-3 * large, "turn": 0.02 * small}
        if rng.random() < 0.5
        else {"shift": 5e-3 * small, "turn": 0.02 * large}
    )


def _load(rng, slide):
    """A kilogram beside the last joint, from a time on or between two; times are shares of a run."""
    start = rng.uniform(0.15, 0.5)
    end = 10.0 if rng.random() < 0.3 else start + rng.uniform(0.2, 0.35)
    x, y, z = rng.uniform(-0.1, 0.1, 3)
    return {"m": 1.0, "x": x, "y": y, "z": z, "start": start, "end": end}


OUTSIDE_LAWS = {
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
    # Those of the torque's channel and of encoders, after all others: worlds drawn before stay as they were.
    "torque_constant_saturation": Law(None, lambda r, w: {"c": r.choice([-1, 1])}, outside=True),
    "torque_dead_band": Law(None, lambda r, w: {"d": r.choice([-1, 1])}, outside=True),
    "torque_lag": Law(None, lambda r, w: {"tc": 1e-3}, outside=True),
    "encoder_eccentricity": Law(None, _eccentric, ("s1", "c1", "s2", "c2"), outside=True),
    "gear_coupling_error": Law(
        None, lambda r, w: {"c": 0.01 * r.choice([-1, 1])}, ("c",), outside=True, pair=True
    ),
    # After those again.
    "dwell_friction": Law(
        lambda p, s, j, o: (p["fc"] * -np.expm1(-s.state / p["tr"]), 0.0),
        lambda r, w: {
            "fc": 1.0,
            "x0": log_uniform(r, 0.02, 0.1) * (0.1 if w else 1),
            "tr": log_uniform(r, 0.3, 2.0),
        },
        ("fc",),
        outside=True,
        memory=age,
    ),
    "lugre_friction": Law(
        lambda p, s, j, o: (0.0, p["fc"] * s.state),
        lambda r, w: {
            "fc": 1.0,
            "x0": log_uniform(r, 0.02, 0.1) * (0.1 if w else 1),
            "rise": r.uniform(0.4, 1.0),
            "vs": log_uniform(r, 0.08, 0.25) * (0.2 if w else 1),
        },
        ("fc",),
        outside=True,
        memory=lugre,
    ),
    "link_geometry": Law(None, _askew, ("shift", "turn"), outside=True),
    "payload_change": Law(None, _load, ("m",), outside=True),
}
