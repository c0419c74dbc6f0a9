"""What the RX60 paper did not see: rank, null space, least squares, other readings, no rigid body."""

from typing import Any

import numpy as np

from jaxswarm.identify.estimation.base_parameters import BaseParameters
from jaxswarm.identify.physical.consistency import body_violations
from jaxswarm.identify.physical.projection import nearest_physical, plain_prior
from jaxswarm.robot import rx60_paper_parameters
from jaxswarm.studies.rx60 import paper
from jaxswarm.studies.rx60.data import (
    FIT,
    READINGS,
    VALIDATION,
    Compressed,
    averaged,
    compress,
    experiment,
    relative_error,
    selection,
)
from jaxswarm.studies.rx60.search import base_of


def identifiability(problem: Compressed) -> dict:
    """Rank, singular values, base combinations and the parameters that the null space moves."""
    base = base_of(problem)
    left = np.linalg.svd(problem.factor)
    null = left[2][base.size :]
    moved = [
        n for n, size in zip(paper.NAMES, np.abs(null).max(axis=0), strict=True) if size > 1e-6
    ]
    return {
        "parameters": 13,
        "rank": base.size,
        "singular_values": left[1].tolist(),
        "base": list(base.expressions()),
        "base_true": base.reduce(paper.TRUE).tolist(),
        "null_space_moves": moved,
    }


def paper_in_base(base: BaseParameters) -> list[dict]:
    """The paper's own table in base combinations: means, and their errors, next to the raw spread."""
    rows = []
    true = base.reduce(paper.TRUE)
    for case in paper.CASES:
        mean = np.array(paper.MEAN[case])
        mean[-1] = -abs(mean[-1])  # F3 is printed with the other sign
        rows.append(
            {
                "scheme": case[0],
                "case": case[1],
                "mean": base.reduce(mean).tolist(),
                "error": (base.reduce(mean) - true).tolist(),
            }
        )
    return rows


def other_readings(seed: int, samples: int) -> list[dict]:
    """Every reading of the trajectory: rank, conditioning, noise floor, RAE of least squares."""
    rows = []
    for reading, text in READINGS.items():
        noisy = experiment(reading, FIT, noise_seed=seed, samples=samples)
        clean = experiment(reading, FIT, samples=samples)
        check = experiment(reading, VALIDATION, samples=samples)
        problem, exact = compress(noisy), compress(clean)
        found = identifiability(exact)
        seen = found["singular_values"][: found["rank"]]
        fit = problem.least_squares()
        rows.append(
            {
                "reading": reading,
                "text": text,
                "rank": found["rank"],
                "condition": seen[0] / seen[-1],
                "fbest": float(problem.fitness(fit)),
                "fitness_of_truth": float(problem.fitness(paper.TRUE)),
                "rae": relative_error(check, fit).tolist(),
                "rae_averaged": relative_error(
                    check, compress(averaged(noisy)).least_squares()
                ).tolist(),
            }
        )
    return rows


def noise_luck(seed: int, draws: int, samples: int) -> dict:
    """RAE of least squares over noise realizations, as the paper fits and with averaged signals.

    ``bound`` is the RAE that the torque noise alone costs a fit without bias: the Cramer-Rao bound,
    drawn from. ``mean_of_ten`` is the RAE of parameters averaged over ten realizations.
    """
    check = experiment("c pi", VALIDATION, samples=samples)
    fits: dict[str, list[np.ndarray]] = {"plain": [], "averaged": []}
    for k in range(draws):
        noisy = experiment("c pi", FIT, noise_seed=seed + 1000 + k, samples=samples)
        fits["plain"].append(compress(noisy).least_squares())
        fits["averaged"].append(compress(averaged(noisy)).least_squares())
    printed = np.array(paper.RAE["gpso", "noisy"])
    result: dict[str, Any] = {"draws": draws}
    for name, found in fits.items():
        values = np.array([relative_error(check, theta) for theta in found])
        result[name] = {
            "median": np.median(values, axis=0).tolist(),
            "share_at_or_below_paper": (values <= printed).mean(axis=0).tolist(),
            "mean_of_ten": relative_error(check, np.mean(found[:10], axis=0)).tolist(),
        }
    clean = compress(experiment("c pi", FIT, samples=samples))
    inverse = np.linalg.pinv(clean.factor, rcond=1e-9)
    normal = np.random.default_rng(seed).normal(size=(200, 13)) @ inverse.T
    drawn = paper.TRUE + paper.NOISE["torque"] / np.sqrt(samples) * normal
    errors = [relative_error(check, theta) for theta in drawn]
    return result | {"bound": np.median(errors, axis=0).tolist()}


def physics(problem: Compressed) -> dict:
    """The stated truth as rigid bodies: what it violates, and the nearest arm that exists.

    Axx3 - Byy3 and Czz3 are both seen by the data, so no choice along the null directions repairs
    abs(Axx3 - Byy3) > Czz3. Masses and first moments stay out of the torque, as in the paper's model.
    """
    links = rx60_paper_parameters()
    nearest = nearest_physical(
        selection(), paper.TRUE, prior=plain_prior(3), weight=problem.factor, pull=1e-5
    )
    found = selection() @ nearest.parameters.ravel()
    return {
        "violations": {
            f"link {k + 1}": list(body_violations(links[k], inertia_only=True)) for k in (1, 2)
        },
        "axx3_minus_byy3": float(links[2, 4] - links[2, 6]),
        "czz3": float(links[2, 9]),
        "constrained": {
            "parameters": dict(zip(paper.NAMES, found.tolist(), strict=True)),
            "fbest": float(problem.fitness(found)),
            "still_violated": [list(body_violations(row)) for row in nearest.parameters],
        },
    }
