"""The RX60 paper as a study: its experiment redone, what it did not see, and the cause of its result.

Thirteen inertial parameters of the first three links of a Staubli RX60 are searched by GPSO and AELSPSO,
noise-free and noisy, ten runs each. Everything the paper does not print is listed as a reconstruction
in the JSON and on the page.
"""

from pathlib import Path

import jax

from jaxswarm.studies.driver import Progress, Study, run_study, silent
from jaxswarm.studies.rx60 import cause, findings, others, paper, sweep
from jaxswarm.studies.rx60 import figures as drawings
from jaxswarm.studies.rx60.data import VALIDATION, compress, experiment
from jaxswarm.studies.rx60.loop import undeclared_effect
from jaxswarm.studies.rx60.page import render, verdict_lines
from jaxswarm.studies.rx60.rows import (
    RUNS,
    STEPS,
    averaged_row,
    case_row,
    least_squares_row,
    targets,
)
from jaxswarm.studies.rx60.search import COORDINATES, base_of, scheme, search, view


def run_rx60(
    out: Path | str | None, fast: bool = False, seed: int = 0, progress: Progress = silent
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
    return run_study(_STUDY, out, fast, seed, progress)


def _experiment(fast, seed, progress):
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
        case_row(name, case, searches[name, case], views[case]["raw"], base, check)
        for name, case in paper.CASES
    ]
    progress("least squares, rank, readings, physics")
    runs = 10 if fast else 50
    result = {
        "names": list(paper.NAMES),
        "true": paper.TRUE.tolist(),
        "cases": cases,
        "paper_in_base": findings.paper_in_base(base),
        "least_squares": [least_squares_row(case, problems[case], base, check) for case in data],
        "averaged_signals": averaged_row(data["noisy"], base, check, keys[1]),
        "identifiability": findings.identifiability(problems["clean"]),
        "physics": findings.physics(problems["clean"]),
        "readings": findings.other_readings(seed, 1401 if fast else samples),
        "noise_luck": findings.noise_luck(seed, 10 if fast else 50, samples),
    }
    progress("testing the causes")
    result["cause"] = cause.tested(views["clean"], keys[2], runs, fast)
    progress("sweeping what the paper does not print")
    rows = sweep.sensitivity(views["clean"]["raw"], keys[3], runs=10, fast=fast)
    result["sensitivity"] = {"rows": rows, "nearest_to_paper": sweep.nearest_to_paper(rows)}
    progress("other optimizers")
    wide = {others.WIDE: view(problems["noisy"], "raw", 4.0)}
    result["optimizers"] = others.table(views["noisy"] | wide, keys[4], fast=fast)
    if not fast:
        progress("an undeclared effect, and the loop")
        result["loop"] = undeclared_effect(seed, keys[5], progress)
    result["targets"] = targets(result)

    def figures():
        optimum = {case: views[case]["raw"].optimum for case in views}
        raw = searches["gpso", "clean"].points
        torques = {
            f"torque_{name}_{case}.png": drawings.torque(
                check,
                searches[name, case].points.mean(axis=0),
                f"{name.upper()}, {case}: validation torque (reconstructed trajectory)",
            )
            for name, case in paper.CASES
        }
        loop = {"loop.png": drawings.loop(result["loop"])} if "loop" in result else {}
        return (torques | loop) | {
            "convergence.png": drawings.convergence(searches, optimum),
            "null_space.png": drawings.null_space(raw, base.reduce(raw), base.expressions()),
            "cause.png": drawings.cause(result["cause"]["ablation"]),
            "sensitivity.png": drawings.sensitivity(result["sensitivity"]["rows"]),
        }

    return result, figures


_STUDY = Study("rx60", paper.RECONSTRUCTIONS, _experiment, verdict_lines, render)
