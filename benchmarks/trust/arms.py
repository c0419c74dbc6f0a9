"""Arms with logs: worlds with or without an undeclared effect, each with its own controller and logger."""

import tempfile
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from benchmarks.worlds.arm import toml
from benchmarks.worlds.plan import CLEAN, ROUND
from benchmarks.worlds.world import make_world
from jaxswarm import log_from_arrays
from jaxswarm.effects.term import Term
from jaxswarm.logs import Log
from jaxswarm.robot import Robot, load_robot

# Worlds of the truth benchmark stay apart from these.
_FIRST = 100
# Time [s] of a log: what is asked here does not need more, and a diagnosis costs by the second.
_LONGEST = 12.0


class Arm(NamedTuple):
    """A robot as its user knows it, what is declared, what its log has besides, and the log."""

    name: str
    robot: Robot
    declared: tuple[Term, ...]
    effects: tuple[str, ...]
    log: Log


def clean_arm(number: int) -> Arm:
    """The clean arm of a number; every number has another one."""
    turn, place = divmod(number, CLEAN)
    return _arm(ROUND * (_FIRST + turn) + place)


def any_arm(number: int) -> Arm:
    """Arms with an undeclared law in turn with clean ones."""
    if number % 2 == 0:
        return clean_arm(number // 2)
    turn, place = divmod(number // 2, ROUND - CLEAN)
    return _arm(ROUND * (_FIRST + turn) + CLEAN + place)


@lru_cache(maxsize=2)
def _arm(number: int) -> Arm:
    world = make_world(number, _LONGEST)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "robot.toml"
        path.write_text(toml(world.arm))
        robot = load_robot(path)
    given = world.log("train", world.runs["train"])[0]
    log = log_from_arrays(given["t"], given["q"], given["tau"], joints=robot.joints)
    declared = tuple(Term(effect, joint) for effect, joint in world.declared)
    effects = tuple(effect.kind for effect in world.effects)
    return Arm(f"{world.number} {world.arm.name}", robot, declared, effects, log)
