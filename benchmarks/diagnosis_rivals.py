"""The same residuals given to PySINDy, gplearn and a stepwise search: what they make of them elsewhere.

The cases are those of :mod:`benchmarks.diagnosis_mechanisms`. PySINDy's optimizers, sequentially thresholded
least squares (S. Brunton, J. Proctor, J. N. Kutz, PNAS 113 (2016)) and sparse relaxed regularized regression
(P. Zheng et al., IEEE Access 7 (2019)), and the stepwise search by BIC choose from the library of
:mod:`benchmarks.worlds.library`, its columns freed of the declared model; their thresholds are those that
predict held-out stretches of time best. gplearn writes a program in all joints' positions, velocities,
accelerations, signs and loads. What was chosen is refitted with the declared model and scored on the other
motion as ours is. PySR needs Julia and is not run: on the Feynman problems without noise its authors report
a recovery like that of the best (M. Cranmer, arXiv:2305.01582).

On the 12 mechanisms, within 1.5 times the true torque's error elsewhere: this search 11, its catalog alone 1,
PySINDy with STLSQ 4 and with SR3 1, stepwise BIC 4, gplearn none; medians over it 1.06, 15, 37, 760, 26 and 21.
"""

import json
import time
import warnings
from collections.abc import Callable

import numpy as np

from benchmarks.diagnosis_library import Residual
from benchmarks.diagnosis_mechanisms import PATH as OURS
from benchmarks.diagnosis_mechanisms import over
from benchmarks.mechanism_cases import prepared_case
from benchmarks.timing import RESULTS
from benchmarks.worlds.choosers import CHOOSERS, blocks, held_out
from jaxswarm.identify import estimate
from jaxswarm.robot import rx60

PATH = RESULTS / "diagnosis_rivals.jsonl"
# Thresholds in norms of the target; what gplearn may write, how many programs it breeds, how long.
_THRESHOLDS = np.geomspace(3e-3, 0.5, 8)
_WORDS = ("add", "sub", "mul", "div", "sin", "cos", "abs")
_POPULATION, _GENERATIONS, _PARSIMONY = 1000, 20, 1e-3


def run_rivals(fast: bool) -> None:
    """Score the rivals on the cases that ours was run on, and write the table."""
    ours = [json.loads(line) for line in OURS.read_text().splitlines()] if OURS.exists() else []
    there = [row for row in ours if row["truth"]][: 4 if fast else None]
    rows = [json.loads(line) for line in PATH.read_text().splitlines()] if PATH.exists() else []
    done = {row["case"] for row in rows}
    for row in there:
        if row["case"] not in done:
            rows.append({"case": row["case"], "rivals": score_rivals(row["case"])})
            with PATH.open("a") as file:
                file.write(json.dumps(rows[-1]) + "\n")
            print(json.dumps(rows[-1]), flush=True)
    table = rivals_table(there, rows)
    PATH.with_suffix(".md").write_text(table)
    print(table)


def score_rivals(number: int) -> dict:
    """What each rival names on a case's joint, its error on the other motion, and seconds of one core."""
    case = prepared_case(number)
    declared = estimate(rx60(), case.blank, [case.train], bounded=False)
    motion, clean = case.like(declared.model.filtering)
    residual = Residual(declared, motion, clean, case.hidden.joint)
    found = {}
    for name, rival in RIVALS.items():
        start = time.process_time()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found[name] = rival(residual)
        found[name]["seconds"] = time.process_time() - start
    return found


def _stepwise(residual: Residual) -> dict:
    usable, x = residual.free
    y = residual.target
    return residual.chosen(usable[CHOOSERS["stepwise, BIC"](x, y, blocks(len(y)))])


def _by_threshold(make) -> Callable:
    """A PySINDy optimizer with the threshold that predicts held-out stretches best."""

    def rival(residual: Residual) -> dict:
        usable, x = residual.free
        y = residual.target
        size, fold = np.linalg.norm(y), blocks(len(y))
        kept = [
            np.flatnonzero(make(size * t).fit(x, y[:, None]).coef_.ravel()) for t in _THRESHOLDS
        ]
        errors = [held_out(x, y, fold, own) for own in kept]
        return residual.chosen(usable[kept[int(np.argmin(errors))]])

    return rival


def _stlsq(threshold: float):
    import pysindy

    return pysindy.STLSQ(threshold=threshold, alpha=1e-4, unbias=False)


def _sr3(threshold: float):
    import pysindy

    return pysindy.SR3(reg_weight_lam=0.5 * threshold**2, regularizer="l0", unbias=False)


def _gplearn(residual: Residual) -> dict:
    from gplearn.genetic import SymbolicRegressor

    search = SymbolicRegressor(
        population_size=_POPULATION,
        generations=_GENERATIONS,
        function_set=_WORDS,
        metric="mse",
        parsimony_coefficient=_PARSIMONY,
        random_state=0,
    )
    here, there = residual.fields(residual.train), residual.fields(residual.motion)
    weight = np.maximum(residual.crossfit.weight[:, residual.joint], 1e-300)
    used = residual.crossfit.weight[:, residual.joint] > 0.0
    scale = np.std(residual.target[used] / weight[used])
    search.fit(here[used], residual.target[used] / weight[used] / scale)
    columns = [search.predict(x)[:, None] for x in (here, there)]
    return {"named": [str(search._program)], "error": residual.error(*columns)}


RIVALS = {
    "PySINDy, STLSQ": _by_threshold(_stlsq),
    "PySINDy, SR3": _by_threshold(_sr3),
    "gplearn": _gplearn,
    "stepwise, BIC": _stepwise,
}


def rivals_table(ours: list[dict], rows: list[dict]) -> str:
    """Errors on the other motion over that of the true torque, as measured, beside ours."""
    told = {row["case"]: row["rivals"] for row in rows}
    there = [row for row in ours if row["case"] in told]
    if not there:
        return "no case yet: run the mechanisms first\n"
    ratios = {
        "jaxswarm --discover": [over(r, r["error"]["discovered"]) for r in there],
        "jaxswarm": [over(r, r["error"]["loop"]) for r in there],
        "declared model": [over(r, r["error"]["declared"]) for r in there],
    } | {name: [over(r, told[r["case"]][name]["error"]) for r in there] for name in RIVALS}
    lines = [
        f"{len(there)} mechanisms; unseen error as measured, over that of a model told the true torque.",
        "",
        "| method | within 1.5 times | over it: 50 %, 90 % | terms: 50 % | seconds of one core |",
        "|---|---|---|---|---|",
    ]
    for name, values in ratios.items():
        own = [told[r["case"]][name] for r in there] if name in RIVALS else []
        size = f"{np.median([len(o['named']) for o in own]):.0f}" if own else "-"
        seconds = f"{np.median([o['seconds'] for o in own]):.1f}" if own else "-"
        if name == "jaxswarm --discover":
            seconds = f"{np.median([sum(r['cpu']) for r in there]):.0f}"
        middle, high = np.percentile(values, [50, 90])
        within = sum(x <= 1.5 for x in values)
        lines.append(
            f"| {name} | {within} of {len(values)} | {middle:.2f}, {high:.2f} | {size} | {seconds} |"
        )
    return "\n".join(lines) + "\n"
