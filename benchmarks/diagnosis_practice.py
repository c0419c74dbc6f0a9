"""The practice cases and the real robots: what is added, and the error on motion that was not fitted."""

import json
import os
import time
from pathlib import Path

import numpy as np
from scipy import signal

from jaxswarm.diagnose.run import conclude
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.stepwise import diagnose
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate, parse_terms
from jaxswarm.identify.estimation.validate import log_errors
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.logs import read_log
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import load_robot

FRICTION = "viscous_friction,coulomb_friction"
# Ends of a log [s] that filters reach; scores are given with and without them.
_ENDS, _BAND = 0.5, 10.0


def data_root() -> Path:
    """Folder with ``data/`` and ``cases/``."""
    default = Path(__file__).resolve().parents[2] / "shared"
    return Path(os.environ.get("JAXSWARM_DATA", default))


def true_term(entry: dict) -> Term:
    """An entry of ``truth.json`` as a term with this project's parameters."""
    p, name = entry["params"], entry["effect"]
    joint = entry.get("joint")
    values = {
        "stribeck_friction": lambda: {"df": p["fs"] - p["fc"], "vs": p["vs"], "delta": 2.0},
        "torque_ripple": lambda: {
            "sine": p["a"] * np.cos(p["phase"]),
            "cosine": p["a"] * np.sin(p["phase"]),
            "n": p["n"],
        },
        "joint_spring": lambda: {"k": p["k"], "tau0": -p["k"] * p["q0"]},
        "load_dependent_friction": lambda: {"mu": p["mu"], "inertial": 1.0},
        "hysteresis": lambda: {"fc": p["fc"], "x0": p["fc"] / p["sigma"]},
        "joint_elasticity": lambda: {"k": p["k"], "d": p["d"]},
        "backlash": lambda: {"gap": p["gap"], "blur": 0.0},
        "transmission_coupling": lambda: {"b": p.get("fv", 0.0)},
    }.get(name, lambda: dict(p))()
    other = int(p["other"]) - 1 if "other" in p else None
    return Term(name, None if joint is None else joint - 1, other, values)


def clean_rms(model: Model, log: Log, skew: bool = True) -> dict:
    """RMS [N m] per joint of the error against ``tau_clean`` below 10 Hz, whole and without the ends."""
    motion = prepare(log, model.filtering)
    torque = model_torque(model, motion)
    own = log.t - log.t[0]
    predicted = np.column_stack([np.interp(own, motion.t, column) for column in torque.T])
    rate = 1.0 / np.median(np.diff(log.t))
    sections = signal.butter(4, _BAND, fs=rate, output="sos")
    error = signal.sosfiltfilt(sections, predicted - log.channels["tau_clean"], axis=0)
    cut = int(_ENDS * rate)
    return {"whole": _rms(error), "inside": _rms(error[cut:-cut])}


def _rms(x: np.ndarray) -> list[float]:
    return np.sqrt((x**2).mean(axis=0)).tolist()


def same(one: Term, other: Term) -> bool:
    """Whether two terms are the same effect in the same place."""
    return (one.effect, one.joint, one.other) == (other.effect, other.joint, other.other)


def explain(found: Diagnosis, truth: list[Term], joints) -> list[dict]:
    """Every step with the winner's and the truth's scores, to see why one lost."""
    lines = []
    for step in found.steps:
        rest = [s for s in step.others if any(same(s.candidate.term, t) for t in truth)]
        lines.append(
            {
                "added": step.added.label(joints),
                "winner": _score(step.score, joints),
                "truth": [_score(s, joints) for s in rest],
                "rivals": [s.candidate.term.label(joints) for s in step.rivals],
            }
        )
    asked = [s for s in found.last if any(same(s.candidate.term, t) for t in truth)]
    best = sorted(found.last, key=lambda s: -s.gain)[:2]
    lines.append({"last": [_score(s, joints) for s in (*asked, *best)]})
    return lines


def _score(s, joints) -> dict:
    values = {k: float(f"{v:.4g}") for k, v in s.candidate.term.values.items()}
    return {
        "term": s.candidate.term.label(joints),
        "gain": round(s.gain, 1),
        "share": round(s.share, 3),
        "p": float(f"{s.p_value:.2g}"),
        "repeats": round(s.repeats, 2),
        "allowed": bool(s.allowed),
        "values": values,
    }


def practice_case(folder: Path) -> dict:
    """Diagnose one case and score it beside the true model with fitted parameters."""
    robot = load_robot("rx60")
    told = json.loads((folder / "truth.json").read_text())
    declared = tuple(Term(d["effect"], d["joint"] - 1) for d in told["declared"])
    truth = [true_term(e) for e in told["effects"]]
    train = read_log(folder / "train.npz", robot.joints)
    test = read_log(folder / "test.npz", robot.joints)
    seen = prepare(train)
    start = time.perf_counter()
    found = diagnose(robot, declared, [seen])
    seconds = time.perf_counter() - start
    unseen = prepare(test, found.final.model.filtering)
    result, _ = conclude(found, [unseen])
    perfect = estimate(robot, (*declared, *truth), found.final.motions, bounded=False)
    added = [s.added for s in found.steps]
    joints = robot.joints
    return {
        "case": folder.name,
        "truth": [t.label(joints) for t in truth],
        "added": [t.label(joints) for t in added],
        "right": len(added) == len(truth) and all(any(same(a, t) for a in added) for t in truth),
        "declared_rms": clean_rms(found.declared.model, test),
        "found_rms": clean_rms(found.final.model, test),
        "true_rms": clean_rms(perfect.model, test),
        "values": [{k: float(v) for k, v in t.values.items()} for t in added],
        "undecided": [u["effects"] for u in result["undecided"]],
        "unexplained": result["unexplained"],
        "skew_ms": 1e3 * found.final.motions[0].skew,
        "cutoffs": [seen.motion_cutoff, seen.torque_cutoff],
        "seconds": seconds,
        "conclude_seconds": time.perf_counter() - start - seconds,
        "why": explain(found, truth, joints),
    }


def practice_table(rows: list[dict]) -> str:
    """The rows as a markdown table."""

    def cell(values):
        return " ".join(f"{x:.3f}" for x in values)

    lines = [
        "| case | truth | added | right | found: RMS, inside | true model: RMS, inside | ratio | s |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        ratios = [
            a / b for a, b in zip(r["found_rms"]["whole"], r["true_rms"]["whole"], strict=True)
        ]
        lines.append(
            f"| {r['case']} | {', '.join(r['truth']) or 'nothing'} | {', '.join(r['added']) or 'nothing'} "
            f"| {'yes' if r['right'] else 'NO'} | {cell(r['found_rms']['whole'])}; "
            f"{cell(r['found_rms']['inside'])} | {cell(r['true_rms']['whole'])}; "
            f"{cell(r['true_rms']['inside'])} | {max(ratios):.2f} | {r['seconds']:.0f} |"
        )
    return "\n".join(lines) + "\n"


REAL = {
    "emps": ("train.npz", ["test.npz"]),
    "ur10e": ("train.npz", ["train2.npz", "test_ptp.npz"]),
    "tx40": ("train.npz", []),
}


def real_case(name: str) -> dict:
    """Diagnose a measured robot from a model with viscous and Coulomb friction."""
    robot = load_robot(name)
    folder = data_root() / "data" / name
    gains = np.asarray(robot.drive_gain)
    file, others = REAL[name]
    seen = prepare(read_log(folder / file, robot.joints, gains))
    start = time.perf_counter()
    found = diagnose(robot, parse_terms(FRICTION, robot.joints), [seen])
    seconds = time.perf_counter() - start
    # With the skew of the clocks that the fit found, as the command line does.
    band = found.final.model.filtering
    unseen = [prepare(read_log(folder / o, robot.joints, gains), band) for o in others]
    result, _ = conclude(found, unseen)
    row = {
        "robot": name,
        "added": [s.added.label(robot.joints) for s in found.steps],
        "values": [{k: float(v) for k, v in s.added.values.items()} for s in found.steps],
        "undecided": [u["effects"] for u in result["undecided"]],
        "unexplained": result["unexplained"],
        "skew_ms": 1e3 * found.final.motions[0].skew,
        "seconds": seconds,
        "why": explain(found, [], robot.joints),
    }
    for label, one in (("before", found.declared), ("after", found.final)):
        row[f"train_{label}"] = 100 * log_errors(one.model, one.motions[0])["relative_global"]
        for file, motion in zip(others, unseen, strict=True):
            errors = log_errors(one.model, motion)
            row[f"{Path(file).stem}_{label}"] = 100 * errors["relative_global"]
    return row
