"""What a planned motion is worth next to random ones and to those with which measured arms were identified.

    python -m benchmarks.excitation [--only emps,tx40,ur10e,kuka_kr300] [--steps N]

Reads ``data/`` under ``JAXSWARM_DATA`` (default ``../shared``). A published motion sets the limits: its own
ranges of position and its own largest speeds and accelerations. Within them a motion of ten seconds is planned
for the rigid body with viscous and dry friction, and random ones are drawn. Compared are condition numbers of
the same base columns, scaled to length one; fewer is better. Published motions are the training logs of EMPS
(Janot, Gautier, Brunot 2019), TX40 (Janot, Vandanjon, Gautier 2014), UR10e and KUKA KR300; they last longer.
"""

import argparse
import resource

import jax
import numpy as np

from benchmarks.identification import data_folder
from jaxswarm.effects.friction import USUAL_FRICTION
from jaxswarm.effects.term import parse_terms
from jaxswarm.identify.excitation.columns import condition, planned_columns
from jaxswarm.identify.excitation.limits import Limits
from jaxswarm.identify.excitation.search import excite
from jaxswarm.logs import read_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import load_robot

NEEDS = ("data",)
TAKES = "10 minutes; one of --only 1 to 4"
ROBOTS = ("emps", "tx40", "ur10e", "kuka_kr300")
# Samples of a published motion that are looked at, as many as of a planned one.
_SAMPLES = 500
_PERIOD = 10.0
# Peaks of a measured acceleration are noise: this share of its samples lies within the limit.
_SHARE = 0.995


def row(name: str, steps: int) -> str:
    """Condition numbers of one arm's published, random and planned motions."""
    robot = load_robot(name)
    log = read_log(data_folder() / name / "train.npz", robot.joints, np.asarray(robot.drive_gain))
    motion = prepare(log)
    limits = Limits(
        motion.q.min(axis=0),
        motion.q.max(axis=0),
        *(np.quantile(np.abs(x), _SHARE, axis=0) for x in (motion.dq, motion.ddq)),
    )
    terms = parse_terms(USUAL_FRICTION, robot.joints)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    found = excite(robot, terms, limits, 1.0 / _PERIOD, num_steps=steps)
    seconds = resource.getrusage(resource.RUSAGE_SELF).ru_utime - before
    chosen = np.linspace(0, len(motion.t) - 1, _SAMPLES).astype(int)
    lanes = (np.asarray(x)[chosen].T for x in (motion.q, motion.dq, motion.ddq))
    columns = np.asarray(planned_columns(robot, terms, limits, *lanes, float(np.ptp(motion.t))))
    published = condition(columns[found.base.kept])
    numbers = (published, np.median(found.random), found.random.min(), found.condition)
    cells = " | ".join(f"{x:.3g}" for x in numbers)
    return f"| {name} | {np.ptp(motion.t):.0f} | {cells} | {seconds:.0f} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", default=",".join(ROBOTS), help="robots, with commas")
    parser.add_argument("--steps", type=int, default=250, help="steps of the search")
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    print(
        "| arm | published lasts, s | published | random, median of 20 | best | planned | CPU s |"
    )
    print("|---|---|---|---|---|---|---|")
    for name in options.only.split(","):
        print(row(name, options.steps), flush=True)


if __name__ == "__main__":
    main()
