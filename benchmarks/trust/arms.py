"""Arms with clean logs: worlds without an undeclared effect, each with a controller and a logger of its own."""

from functools import lru_cache
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


class Arm(NamedTuple):
    """A robot as its user knows it, what is declared, and a clean log."""

    name: str
    robot: Robot
    declared: tuple[Term, ...]
    log: Log


@lru_cache(maxsize=2)
def clean_arm(number: int) -> Arm:
    """The clean arm of a number; every number has another one."""
    import tempfile
    from pathlib import Path

    turn, place = divmod(number, CLEAN)
    world = make_world(ROUND * (_FIRST + turn) + place)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "robot.toml"
        path.write_text(toml(world.arm))
        robot = load_robot(path)
    given = world.log("train", world.runs["train"])[0]
    log = log_from_arrays(given["t"], given["q"], given["tau"], joints=robot.joints)
    declared = tuple(Term(effect, joint) for effect, joint in world.declared)
    return Arm(f"{world.number} {world.arm.name}", robot, declared, log)
