"""Logs spoiled in one way: what is said about them before a fit, and which wrong effects are named by one."""

import time

import numpy as np

from benchmarks.trust.arms import Arm, any_arm
from benchmarks.trust.rows import add_row, read_rows
from benchmarks.trust.spoilings import SPOILINGS, Spoiling
from jaxswarm import tasks
from jaxswarm.errors import InputError
from jaxswarm.identify.checks.check_log import checked, without_relation
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import Samples, samples_of
from jaxswarm.identify.checks.weak import all_rest, resting_joints
from jaxswarm.logs import Log
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.logs.spikes import bridged

# Time [s] of a diagnosis, so that no log takes unbounded time.
BUDGET = 90.0
# Outcomes: said by name; not said before a fit; neither said nor a wrong effect named by one; an effect that is
# not there; another complaint; nothing that a rough model could see.
SAID, UNSAID, QUIET, WRONG, ELSE, HIDDEN = (
    *("said", "unsaid", "quiet", "wrong effect", "something else said", "hidden"),
)
# Growth of what a rough model leaves, as a sum of logarithms over the joints, from which on a spoiling shows on
# a log of many rows; wrong guesses about a clean log gain twice that by chance, on a short one more.
_SHOWS = 0.1
# The log as it is, in which nothing is wrong: it may not be refused.
AS_IT_IS = "as it is"


def spoiled(arms: int, judged: int, first: int = 0) -> None:
    """Spoil the logs of so many arms in every way and ask the checks; rows that exist are not made again.

    Args:
        arms: How many.
        judged: On so many of them, what the checks do not say is diagnosed, which takes a minute each.
        first: Number of the first one: thresholds were set on arms below 40, so that others are a fair trial.
    """
    done = {(row["arm"], row["spoiling"], row["judged"]) for row in read_rows("spoiled")}
    ways = {AS_IT_IS: Spoiling(lambda log, j, rng: log, ()), **SPOILINGS}
    for number in range(first, first + arms):
        for name, spoiling in ways.items():
            asked = number < first + judged
            place = (number, name, asked)
            if place in done or (number, name, True) in done:
                continue
            arm = any_arm(number)
            rng = np.random.default_rng([number, *name.encode()])
            joint = int(rng.integers(arm.robot.num_joints))
            start = time.perf_counter()
            log = spoiling.spoil(arm.log, joint, rng)
            row = complaint(arm, spoiling, log)
            if row["outcome"] == UNSAID and spoiling.hides:
                row["shows"] = shows(arm, spoiling, log)
                row["outcome"] = UNSAID if row["shows"] > _SHOWS else HIDDEN
            if row["outcome"] == UNSAID and asked:
                row = diagnosed(arm, spoiling, log)
            seconds = time.perf_counter() - start
            told = {"arm": number, "of": arm.name, "lacks": arm.effects, "spoiling": name}
            more = {"joint": joint + 1, "judged": place[2], "seconds": seconds}
            add_row("spoiled", {**told, **more, **row})


def complaint(arm: Arm, spoiling: Spoiling, log: Log) -> dict:
    """What the checks say of a log before anything is fitted, and whether that is right."""
    try:
        after, motions = checked(log, arm.robot, Filtering())
    except InputError as error:
        text, refused = str(error), True
    else:
        new = [note for note in after.notes if note not in log.notes]
        lacks = [*all_rest(motions), *resting_joints(motions, arm.robot)]
        related = without_relation(arm.robot, motions)
        text, refused = " ".join([*new, *lacks, *related]), False
    right = any(word in text for word in spoiling.said)
    outcome = SAID if right else ELSE if refused else UNSAID
    return {"outcome": outcome, "refused": refused, "text": text[:600]}


def shows(arm: Arm, spoiling: Spoiling, log: Log) -> float:
    """By how much more the best robot of that geometry leaves of the torques than without the spoiling.

    As a sum of logarithms over the joints, on the same filters, over what chance makes of so few rows.
    """
    spoiled_one, filtering = _filtered(log, Filtering())
    right = (
        _filtered(arm.log, filtering)[0] if spoiling.undo is None else spoiling.undo(spoiled_one)
    )
    rough, other = Rough(arm.robot, spoiled_one), Rough(arm.robot, right)
    return (rough.as_logged()[0].power - other.as_logged()[0].power) / rough.strictness


def _filtered(log: Log, filtering: Filtering) -> tuple[Samples, Filtering]:
    _, motions = prepare_segments(bridged(log)[0], filtering)
    return samples_of(motions), motions[0].filtering


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
    allowed = (*spoiling.effects, *arm.effects)
    wrong = [e["effect"] for e in found["effects"] if e["effect"] not in allowed]
    right = any(word in text for word in spoiling.said)
    right = right or any(e["effect"] in spoiling.effects for e in found["effects"])
    outcome = WRONG if wrong else SAID if right else QUIET
    told = {"outcome": outcome, "refused": False, "effects": effects, "verdict": found["verdict"]}
    return {**told, "text": text[:600]}


def declared_list(arm: Arm) -> str:
    """What the user declares of an arm, as the command line has it."""
    names = arm.robot.joints
    return ",".join(f"{t.effect}@{names[t.joint]}" for t in arm.declared) or "none"
