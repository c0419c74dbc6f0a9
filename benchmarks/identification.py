"""What identification gives on measured arms and on the RX60 of the paper, and what it costs.

    python -m benchmarks.identification [--only emps,tx40,ur10e,rx60,speed]

Reads ``data/`` under ``JAXSWARM_DATA`` (default ``../shared``). Errors are norms of the torque error over the
torque, in percent, in the band that is compared. Published numbers: EMPS (Janot, Gautier, Brunot 2019)
4.083 % on train, 5.982 % on test, 3.112 % with asymmetric friction; UR10e about 5.0 % on point-to-point motion;
TX40, joints 1-3: b 8.0, 5.6, 2.0 N m s/rad, fc 7.0, 8.0, 6.3 N m, coupling of the wrist b 0.62-0.80,
fc 1.6-1.95, ia 0.0096 (Janot, Vandanjon, Gautier 2014).
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: see jaxswarm.runtime

import jax
import numpy as np

from benchmarks.identification_table import markdown
from jaxswarm.identify import estimate, parse_terms
from jaxswarm.identify.estimation.least_squares import fit
from jaxswarm.identify.estimation.swarm_fit import swarm_fit
from jaxswarm.identify.estimation.validate import log_errors
from jaxswarm.identify.forward.regression import Regression
from jaxswarm.logs import read_log, take
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.robot import (
    kuka_kr300,
    kuka_kr300_cad_parameters,
    load_robot,
    rx60,
    rx60_paper_parameters,
    standard_parameter_names,
)
from jaxswarm.robot.logged import rigid_columns

NEEDS = ("data",)
TAKES = "5 minutes; one of --only a minute"
FRICTION = "viscous_friction,coulomb_friction"
FULL = f"{FRICTION},torque_offset,rotor_inertia"
WRIST = "transmission_coupling@joint5:joint6,transmission_coupling@joint6:joint5"
RESULTS = Path(__file__).parent / "results"


def data_folder() -> Path:
    default = Path(__file__).resolve().parents[2] / "shared"
    return Path(os.environ.get("JAXSWARM_DATA", default)) / "data"


def fit_and_score(name, effects, train, test, filtering=None) -> dict:
    """One row: a model fitted on one log and scored on both."""
    robot = load_robot(name)
    seen = prepare(train, filtering)
    unseen = prepare(test, seen.filtering)
    found = estimate(robot, parse_terms(effects, robot.joints), [seen])
    on_train, on_test = log_errors(found.model, seen), log_errors(found.model, unseen)
    return {
        "robot": name,
        "effects": effects,
        "train_percent": 100 * on_train["relative_global"],
        "test_percent": 100 * on_test["relative_global"],
        "test_percent_per_joint": [100 * x for x in on_test["relative"]],
        "values": {
            term.label(robot.joints): {p.name: term.values[p.name] for p in term.law.parameters}
            for term in found.model.terms
        },
        "base": dict(zip(found.fit.base.expressions(), found.fit.values, strict=True)),
        "condition": found.fit.condition,
    }


def read(robot_name: str, file: str):
    robot = load_robot(robot_name)
    path = data_folder() / robot_name / file
    return read_log(path, robot.joints, np.asarray(robot.drive_gain))


def emps_rows() -> list[dict]:
    """The published setting: motion below 100 Hz, torque decimated to 100 Hz."""
    train, test = read("emps", "train.npz"), read("emps", "test.npz")
    return [
        fit_and_score("emps", effects, train, test, Filtering(100.0, 46.3))
        for effects in (f"{FRICTION},torque_offset", "asymmetric_friction")
    ]


def tx40_rows() -> list[dict]:
    """Fitted on 0-4 s, scored on 4-5 s, with and without the coupling of the wrist."""
    log = read("tx40", "train.npz")
    train, test = take(log, log.t < 4.0), take(log, log.t >= 4.0)
    return [fit_and_score("tx40", e, train, test) for e in (FULL, f"{FULL},{WRIST}")]


def ur10e_rows() -> list[dict]:
    """Another day and another kind of motion."""
    train, test = read("ur10e", "train.npz"), read("ur10e", "test_ptp.npz")
    return [fit_and_score("ur10e", e, train, test) for e in ("none", FRICTION, FULL)]


def rx60_problem(noisy: bool, seed: int = 0) -> tuple[Regression, np.ndarray]:
    """The paper's thirteen parameters on its trajectory, without gravity; and their true values."""
    robot = rx60().replace(gravity=np.zeros(3))
    t = np.arange(7001) * 0.001
    w, c, r = np.pi / 4, 0.6, -1.1
    size, shift = np.array([c * np.pi, c * np.pi, r]), np.array([0.0, np.pi / 2, np.pi / 2])
    angle = w * t[:, None] + shift
    motion = [size * np.sin(angle), size * w * np.cos(angle), -size * w**2 * np.sin(angle)]
    truth = rx60_paper_parameters().ravel()
    torque = rigid_columns(robot, *motion) @ truth
    if noisy:
        rng = np.random.default_rng(seed)
        motion = [x + 0.01 * rng.normal(size=x.shape) for x in motion]
        torque = torque + 0.1 * rng.normal(size=torque.shape)
    names = standard_parameter_names(robot)
    symbols = ("Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
    chosen = [names.index(n) for n in ("Izz1", *(f"{s}{k}" for k in (2, 3) for s in symbols))]
    columns = rigid_columns(robot, *motion)[:, :, chosen]
    regression = Regression(
        tuple(names[k] for k in chosen), columns, torque, np.ones(torque.shape, bool), t,
        np.zeros(len(t), int), (0.001,),
    )  # fmt: skip
    return regression, truth[chosen]


def rx60_rows(runs: int = 10, steps: int = 1000) -> list[dict]:
    """Errors of the eleven base combinations by least squares and by GPSO, raw and whitened."""
    rows = []
    for noisy in (False, True):
        regression, truth = rx60_problem(noisy)
        # Joints are counted alike, as in the paper's fitness.
        solution = fit(regression, sigma=np.ones(3))
        true = solution.base.reduce(truth)
        found = {"least squares": (solution.values, 0.0)}
        for whiten in (False, True):
            key = jax.random.key(1)
            search = swarm_fit(solution, "gpso", key, runs=runs, num_steps=steps, whiten=whiten)
            excess = float(np.median(search.costs) - search.optimum)
            found[f"gpso, {'whitened' if whiten else 'raw'}"] = (search.values, excess)
        for method, (values, excess) in found.items():
            rows.append(
                {
                    "setting": "noisy" if noisy else "noise-free",
                    "method": method,
                    "largest_error": float(np.abs(values - true).max()),
                    "cost_above_optimum_median": excess,
                    "optimum": float(solution.cost),
                    "errors": dict(zip(solution.base.expressions(), values - true, strict=True)),
                }
            )
    return rows


def speed_rows() -> list[dict]:
    """``jaxswarm identify`` on 25,000 samples of six joints, as a process of its own."""
    robot = kuka_kr300().replace(parameters=kuka_kr300_cad_parameters())
    rng = np.random.default_rng(0)
    t = np.arange(25000) * 0.002
    q, dq, ddq = (np.zeros((len(t), 6)) for _ in range(3))
    for f in (0.1, 0.23, 0.41, 0.77):
        size, phase, w = rng.uniform(0.05, 0.15, 6) / f, rng.uniform(0, 7, 6), 2 * np.pi * f
        q += size * np.sin(w * t[:, None] + phase)
        dq += size * w * np.cos(w * t[:, None] + phase)
        ddq -= size * w**2 * np.sin(w * t[:, None] + phase)
    tau = rigid_columns(robot, q, dq, ddq) @ np.asarray(robot.parameters).ravel()
    tau += 50.0 * dq + 30.0 * np.tanh(dq / 0.01) + 5.0 * rng.normal(size=tau.shape)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log.npz"
        np.savez(log, t=t, q=q + 1e-5 * rng.normal(size=q.shape), tau=tau)
        command = [
            sys.executable, "-m", "jaxswarm", "identify", str(log), "--robot", "kuka_kr300",
            "--effects", FRICTION, "--out", f"{folder}/out", "--json",
        ]  # fmt: skip
        environment = {**os.environ, "JAX_COMPILATION_CACHE_DIR": f"{folder}/cache"}
        for compiled in ("cold", "warm"):
            start, used = time.perf_counter(), cpu_seconds()
            subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
            seconds = time.perf_counter() - start
            peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024**2
            used = cpu_seconds() - used
            rows.append(
                {
                    "compiled": compiled,
                    "seconds": seconds,
                    "cpu_seconds": used,
                    "peak_gib_so_far": peak,
                }
            )
    return rows


def cpu_seconds() -> float:
    """Processor time of finished child processes [s]: what wall time would be on an idle machine."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


TABLES = {
    "emps": emps_rows,
    "tx40": tx40_rows,
    "ur10e": ur10e_rows,
    "rx60": rx60_rows,
    "speed": speed_rows,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default=",".join(TABLES), help="tables to remake")
    chosen = parser.parse_args().only.split(",")
    jax.config.update("jax_enable_x64", True)
    RESULTS.mkdir(exist_ok=True)
    texts = []
    with (RESULTS / "identification.jsonl").open("w") as lines:
        for name in chosen:
            rows = TABLES[name]()
            for row in rows:
                lines.write(json.dumps({"table": name, **row}) + "\n")
            texts.append(f"## {name}\n\n{markdown(rows)}\n")
            print(texts[-1], flush=True)
    (RESULTS / "identification.md").write_text("\n".join(texts))


if __name__ == "__main__":
    main()
