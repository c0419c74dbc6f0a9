"""Inverse dynamics, forward dynamics and RK4 steps per second, ours and the peers', in one run.

Run: python -m benchmarks.dynamics [--fast]

Arms of 3 (RX60), 6 (UR10e) and 7 joints with full link parameters, float64. Ours: lanes in blocks
(:func:`jaxswarm.robot.in_blocks`), which use one core. Peers, on batches of 1000: Pinocchio's
RNEA and ABA called in a loop from Python, MuJoCo's threaded rollout (RK4, same step), frax and MJX
vmapped. All rates of this table are per second that a core computed. MJX compiles for a minute, so --fast
leaves it out and the full run takes it for six joints only.

Further tables: a planar two-link arm with 5000 particles of different parameters through 1 ms steps
(general tree, closed form by hand, plain ``vmap`` of a vector state with ``jnp.sin`` and a linear solve,
diffrax with the same four stages, MuJoCo); the same as output-error values; the RX60's three links,
general tree against a closed form by hand. Rates are medians of interleaved rounds, on the clock and
per second that a core computed; ratios are medians of the ratios within a round.

The last table is of :mod:`benchmarks.dynamics_joints`: compile and run times of 3 to 50 joints.

What bounds it. One pass over all lanes is bound by memory and by the scheduling of some hundred short
passes; in blocks of 64 lanes the arithmetic is: about 1100 additions and multiplications for the
inverse dynamics of six joints, 40 of them for each sine and cosine. The general tree computes
twice what a closed form does: it rotates vectors whose components a planar arm knows to be zero.
"""

import sys

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.dynamics_joints import joint_rows
from benchmarks.dynamics_peers import frax_rates, mjx_rates, mujoco_rate, pinocchio_rates
from benchmarks.dynamics_rx60 import check, rx60_candidates
from benchmarks.dynamics_two_link import PARTICLES, output_error_candidates, two_link_candidates
from benchmarks.timing import core_ratio, interleaved, machine, ratio, write_lines
from jaxswarm.robot import (
    Robot,
    forward_dynamics,
    in_blocks,
    inverse_dynamics,
    robot_from_dh,
    rx60,
    ur10e,
)
from jaxswarm.robot.placements import body_parameters
from jaxswarm.simulate import make_plant, open_loop, polynomial_sincos, rest

NEEDS = ("pinocchio", "mujoco", "diffrax", "frax")
TAKES = "10 minutes; --fast 3 minutes"
DT = 1e-3
PEER_BATCH = 1000


def arms() -> dict[str, Robot]:
    """Return the three arms, every link a solid body."""
    right = np.pi / 2
    seven = robot_from_dh(
        "seven",
        convention="modified",
        alpha=[0, -right, right, right, -right, right, right],
        a=[0, 0, 0, 0.08, -0.08, 0, 0.09],
        d=[0.33, 0, 0.32, 0, 0.38, 0, 0.1],
    )
    body = body_parameters(3.0, [0.05, 0.02, 0.1], np.diag([0.03, 0.04, 0.02]))
    return {
        f"{robot.num_joints} joints": robot.replace(parameters=np.tile(body, (robot.num_joints, 1)))
        for robot in (rx60(), ur10e(), seven)
    }


def states(robot: Robot, batch: int) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Return positions, velocities and accelerations (or torques), (n, batch) each."""
    rng = np.random.default_rng(0)
    return tuple(jnp.asarray(x) for x in rng.normal(size=(3, robot.num_joints, batch)))


def our_rates(robot: Robot, batch: int, rounds: int) -> dict[str, float]:
    """Return evaluations and steps per core-second of one batch."""
    samples = states(robot, batch)
    steps = max(10, 20_000 // batch)
    plant = make_plant(robot)
    loop = open_loop(jnp.zeros((steps, robot.num_joints)), dt=DT)

    def end(q):
        begin = loop.begin(rest(plant, q))
        last, _ = jax.lax.scan(
            lambda x, u: (loop.advance(plant, x, u)[0], None), begin, loop.inputs
        )
        return jnp.stack(last[0].q)

    def inverse(s):
        return inverse_dynamics(robot, *s, sincos=polynomial_sincos)

    def forward(s):
        return forward_dynamics(robot, *s, sincos=polynomial_sincos)

    def blocks(function):
        return jax.jit(lambda lanes: in_blocks(function, lanes))

    inverse, forward, rk4 = blocks(inverse), blocks(forward), blocks(end)
    timed = interleaved(
        {
            "inverse": lambda: inverse(samples),
            "forward": lambda: forward(samples),
            "rk4": lambda: rk4(samples[0]),
        },
        rounds,
    )
    return {  # one core computes, so its own time is the one that counts
        name: batch * (steps if name == "rk4" else 1) / float(np.median(timed[name].computed))
        for name in ("inverse", "forward", "rk4")
    }


def peer_rates(robot: Robot, rounds: int, fast: bool) -> dict[str, dict[str, float]]:
    """Return peer -> what -> rate, for those that are installed."""
    samples = states(robot, PEER_BATCH)
    pinocchio = pinocchio_rates(robot, samples, rounds)
    rates = {
        "Pinocchio loop": {"inverse": pinocchio["rnea"], "forward": pinocchio["aba"]},
        "MuJoCo rollout": {"rk4": mujoco_rate(robot, samples, DT, rounds)},
        "frax": frax_rates(robot, samples, rounds),
    }
    if not fast and robot.num_joints == 6:
        rates["MJX"] = mjx_rates(robot, samples, DT, 3)
    for name in [name for name, rate in rates.items() if rate is None]:
        print(f"{name} is not installed: its row is left out")
        del rates[name]
    return rates


def table(fast: bool, rounds: int) -> list[dict]:
    """Print the rates of the three arms and return them."""
    rows = []
    columns = ("inverse", "forward", "rk4")
    print(f"{'':26s}" + "".join(f"{c + '/s':>12s}" for c in columns))

    def show(label: str, rates: dict[str, float]) -> None:
        cells = (f"{rates[c]:12.3g}" if c in rates else f"{'-':>12s}" for c in columns)
        print(f"{label:26s}" + "".join(cells), flush=True)

    for name, robot in arms().items():
        best = {}
        for batch in (1, 10_000) if fast else (1, 100, 10_000, 100_000):
            rates = our_rates(robot, batch, rounds)
            rows.append({"arm": name, "batch": batch, **rates})
            best = {c: max(rates[c], best.get(c, 0.0)) for c in columns}
            show(f"{name}, batch {batch}", rates)
        for peer, rates in peer_rates(robot, rounds, fast).items():
            rows.append({"arm": name, "peer": peer, **rates})
            show(f"  {peer}", rates)
            times = (f"{c} {best[c] / rates[c]:.0f} times" for c in columns if c in rates)
            print(f"{'':26s}ours: {', '.join(times)} {peer}")
    return rows


def compare(title: str, candidates: dict, rounds: int) -> list[dict]:
    """Time candidates against the first of them, print and return the rates."""
    print(f"\n{title:28s}{'steps/s':>10s}{'/core-s':>10s}   first is times this")
    timed = interleaved({name: call for name, (call, _) in candidates.items()}, rounds)
    first, work = next((name, work) for name, (_, work) in candidates.items())
    rows = []
    for name, (_, count) in candidates.items():
        rate, core = count / timed[name].median, count / float(np.median(timed[name].computed))
        times = ratio(timed, name, first) * work / count
        per_core = core_ratio(timed, name, first) * work / count
        row = {"rate": rate, "per_core": core, "times": times, "times_per_core": per_core}
        rows.append({"table": title, "candidate": name, **row})
        print(
            f"{name:28s}{rate:10.3g}{core:10.3g}   {times:.1f}, per core {per_core:.1f}", flush=True
        )
    return rows


def main() -> None:
    """Measure, print the tables and keep them as JSON lines."""
    jax.config.update("jax_enable_x64", True)
    fast = "--fast" in sys.argv
    rounds, steps = (3, 20) if fast else (9, 100)
    rows = compare(
        f"two-link arm, {PARTICLES} particles", two_link_candidates(DT, steps), rounds
    ) + compare("two-link arm, output error", output_error_candidates(DT, steps), rounds)
    three = rx60_candidates(arms()["3 joints"], DT, steps, PARTICLES)
    print(f"\nRX60: general tree and closed form end {check(three):.1g} rad apart")
    rows += compare("RX60, three links", three, rounds)
    print()
    rows += table(fast, rounds)
    rows += joint_rows(fast, rounds)
    rows.append(machine())
    print(f"written to {write_lines('dynamics.jsonl', rows)}")


if __name__ == "__main__":
    main()
