"""The SEPSO paper as a study: output error of two manipulators, its claim tested with ranks.

The paper claims SEPSO more accurate than SPSO and GA. Its rule, its plant and its tables are not known,
so the claim is tested for three reconstructions of the rule and two readings of each rival on two plants,
clean and noisy, with a tight and an ample budget, and answered for each. A setting of our own, found with
other seeds, takes part under its own name.
"""

from pathlib import Path

import jax
import numpy as np

from jaxswarm.studies.driver import Progress, Study, run_study, silent
from jaxswarm.studies.sepso import figures as drawings
from jaxswarm.studies.sepso import ours as own_settings
from jaxswarm.studies.sepso import search
from jaxswarm.studies.sepso.claims import claims
from jaxswarm.studies.sepso.page import render, verdict_lines
from jaxswarm.studies.sepso.plants import PLANTS, make_data, torque_problem

RECONSTRUCTIONS = (
    "the SEPSO rule: three variants R1, R2, R3 after social emotional optimization; the paper's own text "
    "stops before it",
    "the plant: two four-parameter manipulators of the textbooks; which one the paper used is unknown",
    "the inputs, 2 s at 5 ms, the outputs (both positions), noise of 1 % of their RMS",
    "SPSO as plain inertia PSO, in two readings: the coefficients of SPSO 2006 (w = 0.72, c = 1.19), and w "
    "falling from 0.9 to 0.4 with c = 2 and the velocity limit of our SEPSO",
    "GA in two readings: tournament, SBX and polynomial mutation; and the textbook's roulette and "
    "arithmetic crossover",
    "40 particles for everybody, equal evaluations",
)


def run_sepso(
    out: Path | str | None, fast: bool = False, seed: int = 0, progress: Progress = silent
) -> dict:
    """Run the study and write ``sepso.json``, ``report.html`` and the pictures.

    Args:
        out: Folder for the results; None: nothing is written.
        fast: Ten runs, one short budget, the paper's contestants only, no search for a setting.
        seed: Draws the noise and the searches.
        progress: Called with one line per stage.

    Returns:
        The content of ``sepso.json``.

    Raises:
        InputError: If the folder cannot be written.
    """
    return run_study(_STUDY, out, fast, seed, progress)


def _experiment(fast, seed, progress):
    budgets = {"tight": 25} if fast else {"tight": 40, "ample": 150}
    runs = 10 if fast else 30
    reports, ours = {}, None
    if not fast:
        progress("searching settings of our own")
        reports, ours = own_settings.find(seed, tuple(budgets.values()), count=24, runs=8)
    names = search.FAST if fast else tuple(search.contestants(ours))
    keys = jax.random.split(jax.random.key(seed), runs)
    sections, kept = [], {}
    for plant in PLANTS.values():
        for case, noise_seed in (("clean", None), ("noisy", seed)):
            progress(f"{plant.name}, {case}")
            data = make_data(plant, noise_seed)
            steps = budgets.values()
            every = search.contest(plant, plant.cost, data, keys, steps, names, ours)
            for budget, count in budgets.items():
                found = every[count]
                kept[plant.name, case, budget] = found
                section = {
                    "plant": plant.name,
                    "case": case,
                    "budget": budget,
                    "evaluations": count * search.PARTICLES,
                    "runs": runs,
                    "cost_of_truth": float(plant.cost(plant.true[None], data)[0]),
                    "rows": search.accuracy_rows(found),
                    "comparisons": search.comparisons(found),
                    "polish": search.polished(plant, data, found["SPSO"]),
                }
                sections.append(section | {"claims": claims(section)})
    progress("torque error")
    steps, names = (100, ("SPSO",)) if fast else (1000, names)
    result = {
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
        "ours": {b: reports[steps] for b, steps in budgets.items() if reports},
        "sections": sections,
        "torque_error": [_torque(p, keys, steps, names, ours) for p in PLANTS.values()],
    }

    def figures():
        return {
            f"convergence_{'_'.join(key).replace(' ', '_')}.png": drawings.convergence(
                found, ", ".join(key)
            )
            for key, found in kept.items()
        }

    return result, figures


def _torque(plant, keys, steps, names, ours) -> dict:
    """The variant with torque error: least squares beside the contestants."""
    factor, target, rest = torque_problem(plant)
    solution = np.linalg.lstsq(factor, target, rcond=None)[0]
    error = np.abs(solution - plant.true) / (plant.upper - plant.lower)
    found = search.torque_contest(plant, keys, steps, names, ours)
    return {
        "plant": plant.name,
        "evaluations": steps * search.PARTICLES,
        "least_squares": solution.tolist(),
        "least_squares_error": float(error.max()),
        "least_squares_cost": float(np.sqrt(((factor @ solution - target) ** 2).sum() + rest)),
        "rows": search.accuracy_rows(found),
        "comparisons": search.comparisons(found),
    }


_STUDY = Study("sepso", RECONSTRUCTIONS, _experiment, verdict_lines, render)
