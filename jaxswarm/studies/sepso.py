"""The SEPSO paper as a study: output error of two manipulators, its claim tested with ranks.

The paper claims SEPSO more accurate than SPSO and GA. Its rule, its plant and its tables are not known,
so the claim is tested for three reconstructions of the rule on two plants, clean and noisy, with a tight
and an ample budget, and answered for each.
"""

import time
from collections.abc import Callable
from pathlib import Path

import jax
import numpy as np

from jaxswarm import outputs, plots
from jaxswarm.studies import sepso_figures, sepso_search
from jaxswarm.studies.sepso_page import render, verdict_lines
from jaxswarm.studies.sepso_plants import PLANTS, make_data, torque_problem

RECONSTRUCTIONS = (
    "the SEPSO rule: three variants R1, R2, R3 after social emotional optimization; the paper's own text "
    "stops before it",
    "the plant: two four-parameter manipulators of the textbooks; which one the paper used is unknown",
    "the inputs, 2 s at 5 ms, the outputs (both positions), noise of 1 % of their RMS",
    "SPSO as plain inertia PSO with the coefficients of SPSO 2007; GA by tournament, SBX and polynomial "
    "mutation, and in the textbook form",
    "40 particles for everybody, equal evaluations",
)


def run_sepso(
    out: Path | str | None,
    fast: bool = False,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
) -> dict:
    """Run the study and write ``sepso.json``, ``report.html`` and the pictures.

    Args:
        out: Folder for the results; None: nothing is written.
        fast: Ten runs, one short budget and the paper's contestants only.
        seed: Draws the noise and the searches.
        progress: Called with one line per stage.

    Returns:
        The content of ``sepso.json``.

    Raises:
        InputError: If the folder cannot be written.
    """
    if out is not None:
        outputs.check_folder(Path(out))
    start = time.perf_counter()
    budgets = {"tight": 25} if fast else {"tight": 40, "ample": 150}
    runs = 10 if fast else 30
    names = sepso_search.FAST if fast else tuple(sepso_search.contestants(1))
    keys = jax.random.split(jax.random.key(seed), runs)
    sections, kept = [], {}
    for plant in PLANTS.values():
        for case, noise_seed in (("clean", None), ("noisy", seed)):
            data = make_data(plant, noise_seed)
            for budget, steps in budgets.items():
                progress(f"{plant.name}, {case}, {budget} budget")
                found = sepso_search.contest(plant, data, keys, steps, names)
                kept[plant.name, case, budget] = found
                sections.append(
                    {
                        "plant": plant.name,
                        "case": case,
                        "budget": budget,
                        "evaluations": steps * sepso_search.PARTICLES,
                        "runs": runs,
                        "cost_of_truth": float(plant.cost(plant.true[None], data)[0]),
                        "rows": sepso_search.accuracy_rows(found),
                        "comparisons": sepso_search.comparisons(found),
                        "polish": sepso_search.polished(
                            plant, data, found["SPSO"], 2 if fast else 5
                        ),
                    }
                )
    progress("torque error")
    result = {
        "study": "sepso",
        "fast": fast,
        "seed": seed,
        "reconstructions": list(RECONSTRUCTIONS),
        "plants": [
            {
                "name": p.name,
                "names": list(p.names),
                "true": p.true.tolist(),
                "lower": p.lower.tolist(),
                "upper": p.upper.tolist(),
            }
            for p in PLANTS.values()
        ],
        "sections": sections,
        "torque_error": [
            _torque(p, keys, 100 if fast else 1000, ("SPSO",) if fast else names)
            for p in PLANTS.values()
        ],
    }
    result["findings"] = verdict_lines(result)
    result["seconds"] = time.perf_counter() - start
    if out is not None:
        progress("writing the report")
        images = {
            f"convergence_{'_'.join(key).replace(' ', '_')}.png": plots.png_bytes(
                sepso_figures.convergence(found, ", ".join(key))
            )
            for key, found in kept.items()
        }
        files = {"sepso.json": outputs.to_json(result), "report.html": render(result, images)}
        outputs.write_files(Path(out), files | images)
    return result


def _torque(plant, keys, steps, names) -> dict:
    """The variant with torque error: least squares beside the contestants."""
    factor, target, rest = torque_problem(plant)
    solution = np.linalg.lstsq(factor, target, rcond=None)[0]
    error = np.abs(solution - plant.true) / (plant.upper - plant.lower)
    found = sepso_search.torque_contest(plant, keys, steps, names)
    return {
        "plant": plant.name,
        "evaluations": steps * sepso_search.PARTICLES,
        "least_squares": solution.tolist(),
        "least_squares_error": float(error.max()),
        "least_squares_cost": float(np.sqrt(((factor @ solution - target) ** 2).sum() + rest)),
        "rows": sepso_search.accuracy_rows(found),
        "comparisons": sepso_search.comparisons(found),
    }
