"""Simulated logs with two or three effects that are not declared: are all of them named, and nothing else?

Arms, motion and noise are those of the suite. Half of the logs have their effects on one joint, where a law
with free exponents can bend itself into the sum of two; the others anywhere.
"""

import time
from dataclasses import replace

import numpy as np

from benchmarks.diagnosis_cases import NOISE, make_arm
from benchmarks.diagnosis_practice import same
from jaxswarm.diagnose.decision.unexplained import find_unexplained
from jaxswarm.diagnose.selection.stepwise import diagnose
from jaxswarm.effects.term import Term
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import rx60

# Sizes some times the noise; joint 1 of the upright arm carries no gravity, so some go elsewhere.
SIZES = {
    "stribeck_friction": {"df": 3.0, "vs": 0.12, "delta": 2.0},
    "quadratic_drag": {"c": 1.5},
    "hysteresis": {"fc": 4.0, "x0": 0.06},
    "load_dependent_friction": {"mu": 0.07, "inertial": 1.0},
    "thermal_drift": {"fc": 3.0, "tc": 10.0},
    "torque_ripple": {"sine": 0.8, "cosine": 0.3, "n": 24.0},
    "joint_spring": {"k": 12.0, "tau0": 1.0},
    "transmission_coupling": {"b": 3.0, "fc": 1.0, "fd": 0.0, "ia": 0.0},
    "time_delay": {"seconds": 0.006},
    "drive_gain": {"gain": 1.1},
    "base_tilt": {"gx": 0.4, "gy": -0.2},
}
GLOBAL = ("time_delay", "base_tilt")
NOT_FIRST = ("load_dependent_friction", "drive_gain")


def draw_effects(rng: np.random.Generator, number: int) -> tuple[Term, ...]:
    """Two effects, or three in every third log; all on one joint in every second."""
    names = rng.choice(list(SIZES), 3 if number % 3 == 0 else 2, replace=False)
    joints = rng.integers(0, 3, len(names))
    if number % 2 == 0:
        joints[:] = joints[0]
    terms = []
    for name, joint in zip(names, joints.tolist(), strict=True):
        joint = max(joint, 1) if name in NOT_FIRST else joint
        other = (joint + 1) % 3 if name == "transmission_coupling" else None
        terms.append(Term(str(name), None if name in GLOBAL else joint, other, dict(SIZES[name])))
    return tuple(terms)


def run_pairs(number: int) -> dict:
    """Make a log, diagnose it without telling, and compare."""
    rng = np.random.default_rng(7000 + number)
    arm, declared = make_arm(rng)
    hidden = draw_effects(rng, number)
    log = synthetic_log(arm, (*declared, *hidden), number, noise=Noise(2e-5, tuple(NOISE)))
    start = time.perf_counter()
    found = diagnose(rx60(), tuple(replace(t, values={}) for t in declared), [prepare(log)])
    left = find_unexplained(found.final, found.crossfit)
    added = [step.added for step in found.kept]
    right = sum(any(same(a, h) for a in added) for h in hidden)
    return {
        "number": number,
        "truth": [t.label(arm.joints) for t in hidden],
        "added": [t.label(arm.joints) for t in added],
        "right": right,
        "false": sum(not any(same(a, h) for h in hidden) for a in added),
        "tied": [[s.candidate.term.label(arm.joints) for s in step.rivals] for step in found.steps],
        "unexplained": [{"joint": u.joint, "depends_on": list(u.depends_on)} for u in left],
        "seconds": time.perf_counter() - start,
    }


def pairs_table(rows: list[dict]) -> str:
    """Rates, and the logs on which something was missed or added."""
    hidden = sum(len(r["truth"]) for r in rows)
    whole = sum(r["right"] == len(r["truth"]) and not r["false"] for r in rows)
    lines = [
        f"{sum(r['right'] for r in rows)} of {hidden} effects named on their joint, "
        f"{sum(r['false'] for r in rows)} added that are not there; "
        f"{whole} of {len(rows)} logs right in all.",
        "",
        "| truth | added | tied |",
        "|---|---|---|",
    ]
    for r in rows:
        if r["right"] < len(r["truth"]) or r["false"]:
            tied = "; ".join(", ".join(t) for t in r["tied"] if t)
            lines.append(f"| {', '.join(r['truth'])} | {', '.join(r['added'])} | {tied} |")
    return "\n".join(lines) + "\n"
