"""Results of a seven-joint arm as ``diagnosis.json`` has them, one of every verdict, made by hand."""

import numpy as np

from jaxswarm import plots
from jaxswarm.diagnose.decision.insufficient import undecidable
from jaxswarm.diagnose.report import figures
from jaxswarm.diagnose.report.signals import Signals
from jaxswarm.effects import REGISTRY
from jaxswarm.robot import Robot

JOINTS = [f"panda_finger_joint{k}" for k in range(1, 8)]
NOISE = [0.0185, 0.06, 0.0216, 0.0317, 0.00634, 0.00463, 0.00247]


def errors(scale=1.0, joint=None, on="held-out blocks of time"):
    """Errors near the noise, but on one joint."""
    rms = [x * (scale if j == joint else 1.0) for j, x in enumerate(NOISE)]
    return {
        "rms": rms,
        "relative": [0.01 * x for x in rms],
        "relative_global": 0.01 * scale,
        "on": on,
    }


def effect(name="stribeck_friction", joint=JOINTS[1]):
    """An effect with a parameter of every sort: known, not told from zero, at its bound, unknown."""
    law = REGISTRY[name]
    return {
        "effect": name,
        "joint": joint,
        "law": law.summary,
        "meaning": law.meaning,
        "reference": law.reference,
        "parameters": {
            "df": row(3.2443, 0.027, "N m"),
            "vs": row(law.parameters[1].lower, 0.001, "rad/s"),
            "delta": {"value": 2.0, "std_error": float("nan"), "unit": "1"},
        },
        "gain": {"share_of_error": 0.99, "p_value": 1e-9, "helps_in_blocks": 1.0},
        "alternatives": [{"effect": "quadratic_drag", "joint": joint, "relative_gain": 1.42}],
        "picture": "effect_1.png",
    }


def row(value, error, unit):
    """A parameter with its interval."""
    pair = [value - 1.96 * error, value + 1.96 * error]
    return {"value": value, "std_error": error, "unit": unit, "interval_95": pair}


def clean():
    """Nothing is missing."""
    return {
        "robot": "arm of seven joints",
        "joints": JOINTS,
        "declared": [{"effect": "coulomb_friction", "joint": j} for j in JOINTS],
        "effects": [],
        "changed": [],
        "steps": [],
        "removed": [],
        "unexplained": [],
        "undecided": [],
        "error": {
            "before": errors(),
            "after": errors(),
            "validation": [],
            "noise_floor": {"rms": NOISE, "torque_cutoff_hz": 8.0},
        },
        "torque_units": ["N m"] * 7,
        "verdict": "nothing missing",
        "proof": "held-out regions",
        "residual_over_noise": [1.0] * 7,
        "discovered": [],
        "reasons": ["panda_finger_joint7 never reverses"],
        "refused": [],
        "asked": 123,
        "not_added": [
            {"effect": "payload", "joint": None, "share_of_error": -1e-6, "rejected_because": ["chance"]}
        ],
        "base_parameters": [
            {**row(1.5, 0.1, "kg m^2"), "name": "zz1", "effect": "rigid_body", "verdict": "determined",
             "expression": "zz1 + 0.1 m2"},
            {**row(0.2, 0.1, "kg m"), "name": "mx1", "effect": "rigid_body", "verdict": "weak",
             "expression": "mx1"},
            {**row(0.0, 0.0, "N m"), "name": "fc_1", "effect": "coulomb_friction",
             "verdict": "at bound", "expression": "fc_1"},
        ],
        "physical_consistency": {
            "links": [
                {"joint": j, "possible": k != 3, "reasons": [], "mass": 3.0 - 0.2 * k,
                 "center": [0.01, -0.02, 0.1], "inertia": [[0.03, 1e-4, 0.0], [1e-4, 0.03, 2e-3],
                                                           [0.0, 2e-3, 0.01]]}
                for k, j in enumerate(JOINTS)
            ],
        },
        "logs": [],
        "findings": [{"log": "arm.csv", "what": "a gap of 2 s at row 118"}],
        "provenance": {
            "inputs": [{"name": "arm.csv", "sha256": "a" * 64}],
            "versions": {"jaxswarm": "0.1.0"},
            "options": {"seed": 17, "declare": "coulomb_friction"},
        },
    }  # fmt: skip


def explained():
    """An effect was found; two validation logs prove it, one of them less."""
    before, after = (errors(s, 1, "second.csv") for s in (12.0, 1.0))
    pair = {"before": errors(12.0, 1), "after": errors(1.1, 1)}
    grown = {"before": errors(1.0, 2), "after": errors(1.5, 2)}
    place = {"effect": "stribeck_friction", "joint": JOINTS[1]}
    told = clean()
    told["error"] |= {
        "before": before,
        "after": after,
        "validation": [{"on": "first.csv", **pair}, {"on": "second.csv", **grown}],
    }
    return told | {
        "effects": [effect()],
        "steps": [{"added": place, "before": before, "after": after, "removed": []}],
        "removed": [{"effect": "torque_offset", "joint": JOINTS[4]}],
        "refused": [{"effect": "backlash", "joint": JOINTS[3], "because": "raises the error of joint4"}],
        "verdict": "explained",
        "proof": "other motion",
    }  # fmt: skip


def changed():
    """Against an earlier model: one parameter has another value, one has not."""
    told = explained()
    moved = effect()
    moved["parameters"] = {
        "df": row(3.2, 0.02, "N m") | {"before": 2.1, "change": row(1.1, 0.03, "N m")},
        "vs": row(0.1, 0.01, "rad/s"),
    }
    return told | {"effects": [], "changed": [moved], "model": "earlier.json"}


def unexplained():
    """One joint is far from its noise and no variable tells why."""
    told = clean()
    told["error"] |= {"before": errors(3.3, 3), "after": errors(3.3, 3)}
    entry = {
        "joint": JOINTS[3], "share": 0.9, "p_value": None, "in_model": False, "depends_on": [],
        "over_noise": 3.3, "band_hz": [0.5, 4.0],
        "windows": [{"log": 0, "start": 2.5, "end": 3.5}, {"log": 1, "start": 11.0, "end": 12.0}],
    }  # fmt: skip
    return told | {
        "unexplained": [entry],
        "verdict": "unexplained",
        "proof": "none",
        "residual_over_noise": [1.0, 1.0, 1.0, 3.3, 1.0, 1.0, 1.0],
    }


def cannot():
    """The log is too short."""
    robot = Robot.__new__(Robot)
    object.__setattr__(robot, "name", "arm of seven joints")
    object.__setattr__(robot, "joints", tuple(JOINTS))
    told = undecidable(robot, [], ["N m"] * 7, ["12 independent samples are too few"])
    return told | {key: clean()[key] for key in ("findings", "provenance", "logs")}


RESULTS = {f.__name__: f for f in (clean, explained, changed, unexplained, cannot)}


def signals(told, samples=2000):
    """Torque over 40 s with one sample that stands out."""
    t = np.linspace(0.0, 40.0, samples)
    waves = np.sin(t[:, None] * (1.0 + 0.1 * np.arange(7))) * np.arange(1, 8)
    off = 0.1 * np.sin(9.0 * t)[:, None] * np.ones(7)
    off[samples // 3, 1] = 2.5
    return Signals(t, waves + off, waves)


def pictures(told):
    """PNG bytes by name: the ladder as it is, the others as frames of their size."""
    if told["error"]["before"] is None:
        return {}
    frame = plots.png_bytes(plots.panels(1, 1, 13.6, 3.0)[0])
    names = ["torque.png", "residual.png", "residual_before.png"]
    names += [e["picture"] for e in [*told["effects"], *told["changed"]]]
    return {"ladder.png": plots.png_bytes(figures.ladder(told)), **dict.fromkeys(names, frame)}
