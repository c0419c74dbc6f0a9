"""Clean logs spoiled in one way: what is said about them, and which wrong effects are named."""

import time

import numpy as np

from benchmarks.trust.arms import Arm, clean_arm
from benchmarks.trust.rows import add_row, read_rows
from benchmarks.trust.spoilings import SPOILINGS, Spoiling
from jaxswarm import tasks
from jaxswarm.errors import InputError
from jaxswarm.logs import Log

# Time [s] of a diagnosis, so that no log takes unbounded time.
BUDGET = 90.0
# Outcomes: said by name; neither said nor a wrong effect named; an effect that is not there; said wrongly.
SAID, QUIET, WRONG, ELSE = "said", "quiet", "wrong effect", "something else said"


def spoiled(arms: int) -> None:
    """Spoil the logs of so many arms in every way; rows that exist are not made again."""
    done = {(row["arm"], row["spoiling"]) for row in read_rows("spoiled")}
    for number in range(arms):
        for name, spoiling in SPOILINGS.items():
            if (number, name) in done:
                continue
            arm = clean_arm(number)
            rng = np.random.default_rng([number, *name.encode()])
            joint = int(rng.integers(arm.robot.num_joints))
            start = time.perf_counter()
            row = diagnosed(arm, spoiling, spoiling.spoil(arm.log, joint, rng))
            seconds = time.perf_counter() - start
            place = {"arm": number, "of": arm.name, "spoiling": name, "joint": joint + 1}
            add_row("spoiled", {**place, **row, "seconds": seconds})


def diagnosed(arm: Arm, spoiling: Spoiling, log: Log) -> dict:
    """What a diagnosis of the log says, and whether that is right."""
    try:
        found = tasks.diagnose(log, arm.robot, declared_list(arm), budget=BUDGET)
    except InputError as error:
        text = str(error)
        right = any(word in text for word in spoiling.said)
        return {"outcome": SAID if right else ELSE, "refused": True, "text": text[:600]}
    effects = [f"{e['effect']}@{e['joint']}" for e in found["effects"]]
    text = " ".join([*found["reasons"], *(f["what"] for f in found["findings"])])
    wrong = [e["effect"] for e in found["effects"] if e["effect"] not in spoiling.effects]
    right = any(word in text for word in spoiling.said)
    right = right or (bool(effects) and not wrong)
    outcome = WRONG if wrong else SAID if right else QUIET
    told = {"outcome": outcome, "refused": False, "effects": effects, "verdict": found["verdict"]}
    return {**told, "text": text[:600]}


def declared_list(arm: Arm) -> str:
    """What the user declares of an arm, as the command line has it."""
    names = arm.robot.joints
    return ",".join(f"{t.effect}@{names[t.joint]}" for t in arm.declared) or "none"
