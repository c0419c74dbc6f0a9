"""Clean logs, and logs whose torques are permuted over time or joints: nothing may be added to either."""

import time
from dataclasses import replace

import numpy as np

from benchmarks.trust.arms import Arm, clean_arm
from benchmarks.trust.rows import add_row, read_rows
from benchmarks.trust.spoiled import BUDGET, declared_list
from jaxswarm import tasks
from jaxswarm.errors import InputError
from jaxswarm.logs import Log


def _over_time(log: Log, rng: np.random.Generator) -> Log:
    return replace(log, tau=log.tau[rng.permutation(len(log.t))])


def _blocks(log: Log, rng: np.random.Generator) -> Log:
    """Blocks of a second exchanged: what is left of the torque's own smoothness."""
    size = max(1, int(1.0 / np.median(np.diff(log.t))))
    starts = np.arange(0, len(log.t), size)
    rows = np.concatenate(
        [np.arange(s, min(s + size, len(log.t))) for s in rng.permutation(starts)]
    )
    return replace(log, tau=log.tau[rows])


def _reversed(log: Log, rng: np.random.Generator) -> Log:
    return replace(log, tau=log.tau[::-1].copy())


def _over_joints(log: Log, rng: np.random.Generator) -> Log:
    return replace(log, tau=np.roll(log.tau, 1, axis=1))


KINDS = {
    "clean": lambda log, rng: log,
    "torques permuted over time": _over_time,
    "seconds of torque exchanged": _blocks,
    "torques turned round in time": _reversed,
    "torques permuted over joints": _over_joints,
}


def null(arms: int) -> None:
    """Diagnose so many arms in every way; rows that exist are not made again."""
    done = {(row["arm"], row["kind"]) for row in read_rows("null")}
    for number in range(arms):
        for kind, change in KINDS.items():
            if (number, kind) in done:
                continue
            arm = clean_arm(number)
            rng = np.random.default_rng([number, *kind.encode()])
            begun = time.perf_counter()
            row = _asked(arm, change(arm.log, rng))
            seconds = time.perf_counter() - begun
            add_row(
                "null", {"arm": number, "of": arm.name, "kind": kind, **row, "seconds": seconds}
            )


def _asked(arm: Arm, log: Log) -> dict:
    try:
        found = tasks.diagnose(log, arm.robot, declared_list(arm), budget=BUDGET)
    except InputError as error:
        return {"added": [], "verdict": "refused", "text": str(error)[:300]}
    added = [f"{e['effect']}@{e['joint']}" for e in found["effects"]]
    return {"added": added, "verdict": found["verdict"], "text": ""}
