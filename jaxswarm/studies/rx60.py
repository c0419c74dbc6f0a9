"""The RX60 paper as a study: its experiment redone, what it did not see, and the cause of its result.

Thirteen inertial parameters of the first three links of a Staubli RX60 are searched by GPSO and AELSPSO,
noise-free and noisy, ten runs each. Everything the paper does not print is listed as a reconstruction
in the JSON and on the page.
"""

import time
from collections.abc import Callable
from pathlib import Path

import jax
import numpy as np

from jaxswarm import outputs, plots
from jaxswarm.studies import rx60_cause, rx60_figures, rx60_findings, rx60_others, rx60_sweep
from jaxswarm.studies import rx60_paper as paper
from jaxswarm.studies.rx60_data import (
    VALIDATION,
    averaged,
    compress,
    experiment,
    relative_error,
)
from jaxswarm.studies.rx60_loop import undeclared_effect
from jaxswarm.studies.rx60_page import render, verdict_lines
from jaxswarm.studies.rx60_search import COORDINATES, base_of, scheme, search, summary, view

RUNS = 10
STEPS = 2000


def run_rx60(
    out: Path | str | None,
    fast: bool = False,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
) -> dict:
    """Run the study and write ``rx60.json``, ``report.html`` and the pictures.

    Args:
        out: Folder for the results; None: nothing is written.
        fast: Fewer variants, sweeps and noise draws; the paper's own experiment stays whole.
        seed: Draws the noise and the searches.
        progress: Called with one line per stage.

    Returns:
        The content of ``rx60.json``.

    Raises:
        InputError: If the folder cannot be written.
    """
    if out is not None:
        outputs.check_folder(Path(out))
    start = time.perf_counter()
    keys = jax.random.split(jax.random.key(seed), 6)
    samples = 7001
    progress("simulating the experiment")
    data = {
        "clean": experiment(samples=samples),
        "noisy": experiment(noise_seed=seed, samples=samples),
    }
    check = experiment(constants=VALIDATION, samples=samples)
    problems = {case: compress(one) for case, one in data.items()}
    base = base_of(problems["clean"])
    views = {case: {c: view(p, c) for c in COORDINATES} for case, p in problems.items()}

    progress("searching as the paper did")
    searches = {
        (name, case): search(
            views[case]["raw"], scheme(name, STEPS), keys[0], runs=RUNS, num_steps=STEPS
        )
        for name, case in paper.CASES
    }
    cases = [
        _case(name, case, searches[name, case], views[case]["raw"], base, check)
        for name, case in paper.CASES
    ]
    progress("least squares, rank, readings, physics")
    runs = 10 if fast else 50
    result = {
        "study": "rx60",
        "fast": fast,
        "seed": seed,
        "reconstructions": list(paper.RECONSTRUCTIONS),
        "names": list(paper.NAMES),
        "true": paper.TRUE.tolist(),
        "cases": cases,
        "paper_in_base": rx60_findings.paper_in_base(base),
        "least_squares": [_least_squares(case, problems[case], base, check) for case in data],
        "averaged_signals": _averaged(data["noisy"], base, check, keys[1]),
        "identifiability": rx60_findings.identifiability(problems["clean"]),
        "physics": rx60_findings.physics(problems["clean"]),
        "readings": rx60_findings.other_readings(seed, 1401 if fast else samples),
        "noise_luck": rx60_findings.noise_luck(seed, 10 if fast else 50, samples),
    }
    progress("testing the causes")
    coordinates = rx60_cause.coordinate_table(views["clean"], keys[2], runs)
    ablated = rx60_cause.ablation(views["clean"]["raw"], keys[2], runs, fast)
    result["cause"] = {
        "steps": rx60_cause.STEPS,
        "runs": runs,
        "coordinates": coordinates,
        "ablation": ablated,
        "conclusion": rx60_cause.conclusion(coordinates, ablated),
    }
    progress("sweeping what the paper does not print")
    sweep = rx60_sweep.sensitivity(views["clean"]["raw"], keys[3], runs=10, fast=fast)
    result["sensitivity"] = {"rows": sweep, "nearest_to_paper": rx60_sweep.nearest_to_paper(sweep)}
    progress("other optimizers")
    result["optimizers"] = rx60_others.table(views["noisy"], keys[4], fast=fast)
    if not fast:
        progress("an undeclared effect, and the loop")
        result["loop"] = undeclared_effect(seed, keys[5], progress)
    result["targets"] = _targets(result)
    result["findings"] = verdict_lines(result)
    result["seconds"] = time.perf_counter() - start
    if out is not None:
        progress("writing the report")
        _write(Path(out), result, searches, views, check, base)
    return result


def _case(name, case, found, at, base, check) -> dict:
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


def _least_squares(case, problem, base, check) -> dict:
    theta = problem.least_squares()
    return {
        "case": case,
        "mean": theta.tolist(),
        "base_mean": base.reduce(theta).tolist(),
        "fbest": float(problem.fitness(theta)),
        "rae": relative_error(check, theta).tolist(),
    }


def _averaged(noisy, base, check, key) -> dict:
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


def _targets(result: dict) -> list[dict]:
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


def _write(out, result, searches, views, check, base) -> None:
    optimum = {case: views[case]["raw"].optimum for case in views}
    figures = {
        f"torque_{name}_{case}.png": rx60_figures.torque(
            check,
            searches[name, case].points.mean(axis=0),
            f"{name.upper()}, {case}: validation torque (reconstructed trajectory)",
        )
        for name, case in paper.CASES
    }
    raw = searches["gpso", "clean"].points
    figures["convergence.png"] = rx60_figures.convergence(searches, optimum)
    figures["null_space.png"] = rx60_figures.null_space(raw, base.reduce(raw), base.expressions())
    figures["cause.png"] = rx60_figures.cause(result["cause"]["ablation"])
    figures["sensitivity.png"] = rx60_figures.sensitivity(result["sensitivity"]["rows"])
    images = {name: plots.png_bytes(figure) for name, figure in figures.items()}
    outputs.write_files(
        out,
        {"rx60.json": outputs.to_json(result), "report.html": render(result, images), **images},
    )
