"""Time to compile and to run by number of joints: written out joint by joint, or as loops.

Chains of revolute joints with random placements, 200 lanes, float64. Compile time is what the process
computed over all its cores, which other programs hardly change; run time is the median over interleaved
rounds. :data:`jaxswarm.robot.many.MANY` and ``MANY_IN_PAIRS`` say from how many joints on loops are taken.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.timing import interleaved, ratio
from jaxswarm.robot import (
    Joint,
    Robot,
    build_robot,
    forward_dynamics,
    inverse_dynamics,
    many,
    regressor,
)
from jaxswarm.robot.placements import body_parameters, rotation_rpy

LANES = 200
FUNCTIONS = {"inverse": inverse_dynamics, "regressor": regressor, "forward": forward_dynamics}
# Written out, forward dynamics of 20 joints compile for minutes: there is nothing to compare with.
WRITTEN_OUT = {"inverse": 50, "regressor": 50, "forward": 7}


def chain(num_joints: int) -> Robot:
    """Return a chain with no placement that would fold away."""
    rng = np.random.default_rng(0)
    body = body_parameters(2.0, [0.05, 0.02, 0.1], np.diag([0.03, 0.04, 0.02]))
    return build_robot(
        f"chain{num_joints}",
        [
            Joint(
                f"j{j}",
                parent=f"j{j - 1}" if j else None,
                rotation=rotation_rpy(rng.uniform(-3, 3, 3)),
                translation=0.3 * rng.normal(size=3),
                axis=rng.normal(size=3),
                parameters=body,
            )
            for j in range(num_joints)
        ],
    )


@contextmanager
def taken(limit: int) -> Iterator[None]:
    """Take loops for robots of more joints than this."""
    before = many.MANY, many.MANY_IN_PAIRS
    many.MANY = many.MANY_IN_PAIRS = limit
    try:
        yield
    finally:
        many.MANY, many.MANY_IN_PAIRS = before


def compiled(name: str, robot: Robot, samples, limit: int) -> tuple[float, Callable[[], Any]]:
    """Return the core-seconds that tracing and compiling took, and a call of the program."""
    function = FUNCTIONS[name]
    with taken(limit):
        start = time.process_time()
        program = jax.jit(lambda *s: function(robot, *s)).lower(*samples).compile()
        return time.process_time() - start, lambda: program(*samples)


def joint_rows(fast: bool, rounds: int) -> list[dict]:
    """Print and return compile and run times by number of joints."""
    kept = jax.config.jax_enable_compilation_cache
    jax.config.update("jax_enable_compilation_cache", False)
    rows = []
    print(f"\n{'':22s}{'compiled in core-s':>24s}{'':8s}{'run, loop takes':>18s}")
    print(f"{'':22s}{'written out':>12s}{'loop':>12s}{'ratio':>8s}{'times as long':>18s}   taken")
    for count in (3, 7, 20) if fast else (3, 7, 20, 50):
        robot = chain(count)
        samples = [jnp.asarray(x) for x in np.random.default_rng(1).normal(size=(3, count, LANES))]
        for name in FUNCTIONS:
            limit = many.MANY_IN_PAIRS if name == "forward" else many.MANY
            row = {
                "joints": count,
                "function": name,
                "taken": "loop" if count > limit else "written",
            }
            row["loop"], loop = compiled(name, robot, samples, 0)
            calls = {"loop": loop}
            if count <= WRITTEN_OUT[name]:
                row["written_out"], calls["written"] = compiled(name, robot, samples, count)
            timed = interleaved(calls, rounds)
            row["run_loop"] = timed["loop"].median
            cells = f"{'-':>12s}{row['loop']:12.2f}{'-':>8s}{'-':>18s}"
            if "written" in timed:
                row["run_written"] = timed["written"].median
                row["times"] = ratio(timed, "loop", "written")
                share = row["written_out"] / row["loop"]
                cells = (
                    f"{row['written_out']:12.2f}{row['loop']:12.2f}{share:8.1f}{row['times']:18.2f}"
                )
            print(f"{count:3d} joints, {name:10s}{cells}   {row['taken']}", flush=True)
            rows.append(row)
    jax.config.update("jax_enable_compilation_cache", kept)
    return rows
