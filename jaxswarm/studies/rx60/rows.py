"""The RX60 study's results as rows: the paper's cases, least squares, averaged signals, targets."""

import numpy as np

from jaxswarm.studies.rx60 import paper
from jaxswarm.studies.rx60.data import averaged, compress, relative_error
from jaxswarm.studies.rx60.search import scheme, search, summary, view

RUNS = 10
STEPS = 2000


def case_row(name, case, found, at, base, check) -> dict:
    """One scheme in one noise case, with the paper's numbers beside."""
    mean = found.points.mean(axis=0)
    every = np.array([relative_error(check, theta) for theta in found.points])
    combined = base.reduce(found.points)
    return {
        "scheme": name,
        "case": case,
        "runs": len(found.values),
        **summary(found, at),
        "mean": mean.tolist(),
        "std": found.points.std(axis=0, ddof=1).tolist(),
        "base_mean": combined.mean(axis=0).tolist(),
        "base_std": combined.std(axis=0, ddof=1).tolist(),
        "rae": relative_error(check, mean).tolist(),
        "rae_worst_run": every.max(axis=0).tolist(),
        "evaluations_to_one_percent": found.evaluations_to(1.01 * at.optimum),
        "paper": {
            "mean": paper.MEAN[name, case],
            "std": paper.STD[name, case],
            "fbest_mean": paper.FBEST[name, case][0],
            "fbest_std": paper.FBEST[name, case][1],
            "rae": paper.RAE[name, case],
        },
    }


def least_squares_row(case, problem, base, check) -> dict:
    """What least squares gives on the same data."""
    theta = problem.least_squares()
    return {
        "case": case,
        "mean": theta.tolist(),
        "base_mean": base.reduce(theta).tolist(),
        "fbest": float(problem.fitness(theta)),
        "rae": relative_error(check, theta).tolist(),
    }


def averaged_row(noisy, base, check, key) -> dict:
    """The same scheme on signals averaged over 50 ms, motion and torque alike."""
    problem = compress(averaged(noisy))
    found = search(view(problem), scheme("gpso", STEPS), key, runs=RUNS, num_steps=STEPS)
    theta = found.points.mean(axis=0)
    return {
        "scheme": "gpso",
        "width_ms": 50,
        "fbest_mean": float(found.values.mean()),
        "base_mean": base.reduce(theta).tolist(),
        "rae": relative_error(check, theta).tolist(),
        "least_squares_rae": relative_error(check, problem.least_squares()).tolist(),
    }


def targets(result: dict) -> list[dict]:
    """What was to be reached, what is reached, and whether it is."""
    rows = []
    for c in result["cases"]:
        label = f"{c['scheme'].upper()} {c['case']}"
        if c["case"] == "clean":
            rows.append(_target(f"{label}: fbest, worst run", c["fbest_max"], 1e-6))
            rows.append(
                _target(f"{label}: RAE, worst run and joint", max(c["rae_worst_run"]), 1e-6)
            )
        else:
            excess = c["fbest_max"] / c["least_squares"] - 1.0
            rows.append(_target(f"{label}: fbest over least squares, worst run", excess, 1e-3))
    printed = paper.RAE["gpso", "noisy"]
    noisy = next(c for c in result["cases"] if (c["scheme"], c["case"]) == ("gpso", "noisy"))
    for method, rae in (
        ("fitted as the paper does", noisy["rae"]),
        ("signals averaged over 50 ms", result["averaged_signals"]["rae"]),
        (
            "averaged signals, mean of ten noise draws",
            result["noise_luck"]["averaged"]["mean_of_ten"],
        ),
    ):
        for j in range(3):
            rows.append(_target(f"noisy RAE joint {j + 1}, {method}", rae[j], printed[j]))
    return rows


def _target(name: str, reached: float, wanted: float) -> dict:
    return {"target": name, "reached": reached, "wanted": wanted, "met": bool(reached <= wanted)}
