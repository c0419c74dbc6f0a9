"""The suite's logs diagnosed without being told what they hold, and compared with the truth.

A delay below half a sample is no delay but a clock that is read late: it is found where it is told as such,
within a fifth.
"""

import time
from dataclasses import replace

import numpy as np

from benchmarks.diagnosis_cases import VISIBLE, Case, make_case
from benchmarks.diagnosis_practice import explain, same
from benchmarks.diagnosis_soft import RATE
from jaxswarm.diagnose.decision.unexplained import find_unexplained
from jaxswarm.diagnose.selection.stepwise import diagnose
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import rx60


def run_case(case: Case) -> dict:
    """Make a log, diagnose it without telling, and compare."""
    arm, declared, hidden, log, ratio = make_case(case)
    blank = tuple(replace(t, values={}) for t in declared)
    start = time.perf_counter()
    found = diagnose(rx60(), blank, [prepare(log)])
    left = find_unexplained(found.final, found.crossfit)
    seconds = time.perf_counter() - start
    joints = arm.joints
    added = [s.added for s in found.kept]
    right = [t for t in added if any(same(t, h) for h in hidden)]
    late = [h.values["seconds"] for h in hidden if h.effect == "time_delay"]
    skew = found.final.motions[0].skew
    clock = any(x < 0.5 / RATE and bool(abs(skew - x) < 0.2 * x) for x in late)
    rivals = [[s.candidate.term.label(joints) for s in step.rivals] for step in found.steps]
    return {
        "case": case.name,
        "effect": case.effect,
        "joint": case.joint,
        "level": case.level,
        "noise": case.noise,
        "ratio": float(ratio.max()),
        "visible": bool(ratio.max() >= VISIBLE and hidden),
        "truth": [t.label(joints) for t in hidden],
        "added": [t.label(joints) for t in added],
        "found": bool(right) or clock,
        "false": len(added) - len(right),
        "tied": [r for r in rivals if r],
        "unexplained": [
            {"joint": u.joint, "depends_on": list(u.depends_on), "share": u.share} for u in left
        ],
        "intervals": _intervals(found, hidden),
        "skew_ms": 1e3 * skew,
        "seconds": seconds,
        "why": explain(found, list(hidden), joints),
    }


def _intervals(found, hidden) -> list[dict]:
    rows = []
    for truth in hidden:
        for term, errors in zip(found.final.model.terms, found.final.std_errors, strict=True):
            if not same(term, truth):
                continue
            for name, value in truth.values.items():
                if name in term.values and np.isfinite(errors.get(name, np.nan)):
                    z = (term.values[name] - value) / max(errors[name], 1e-300)
                    rows.append({"parameter": name, "true": value, "z": float(z)})
    return rows
