"""Inverse dynamics, forward dynamics and RK4 steps per second, ours and the peers', in one run.

Run: python -m benchmarks.dynamics [--fast]

Arms of 3 (RX60), 6 (UR10e) and 7 joints with full link parameters, float64. Ours: lanes, the batch as a
trailing axis. Peers: Pinocchio's RNEA and ABA called in a loop from Python (on batches of 1000, they
are linear), MuJoCo's threaded rollout (RK4, same step, all cores). A second table takes a two-link
planar arm with 5000 particles of different parameters through 1 ms steps: our general tree as lanes, a
closed form written by hand in the same layout, the plain ``vmap`` of a vector state with ``jnp.sin`` and
a linear solve, diffrax with the same four stages, MuJoCo. Rates are medians of interleaved rounds.
"""

import sys
import tempfile
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.dynamics_two_link import PARTICLES, two_link_candidates
from benchmarks.timing import interleaved, machine, write_lines
from jaxswarm.identify.export import export_mjcf
from jaxswarm.robot import (
    Robot,
    forward_dynamics,
    inverse_dynamics,
    robot_from_dh,
    rx60,
    ur10e,
)
from jaxswarm.robot.placements import body_parameters
from jaxswarm.simulate import make_plant, open_loop, polynomial_sincos, rest

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
    """Return evaluations and steps per second of one batch."""
    samples = states(robot, batch)
    inverse = jax.jit(lambda s: inverse_dynamics(robot, *s, sincos=polynomial_sincos))
    forward = jax.jit(lambda s: forward_dynamics(robot, *s, sincos=polynomial_sincos))
    steps = max(10, 20_000 // batch)
    plant = make_plant(robot)
    loop = open_loop(jnp.zeros((steps, robot.num_joints)), dt=DT)

    @jax.jit
    def rk4(q):
        def body(carry, sample):
            return loop.advance(plant, carry, sample)[0], None

        return jax.lax.scan(body, loop.begin(rest(plant, q)), loop.inputs)[0]

    timed = interleaved(
        {
            "inverse": lambda: inverse(samples),
            "forward": lambda: forward(samples),
            "rk4": lambda: rk4(samples[0]),
        },
        rounds,
    )
    return {
        name: batch * (steps if name == "rk4" else 1) / timed[name].median
        for name in ("inverse", "forward", "rk4")
    }


def pinocchio_rates(robot: Robot, rounds: int) -> dict[str, float]:
    """Return RNEA and ABA calls per second from a Python loop."""
    import pinocchio as pin

    model = pin.Model()
    ids = []
    for i, name in enumerate(robot.joints):
        place = pin.SE3(np.asarray(robot.rotation[i]), np.asarray(robot.translation[i]))
        parent = 0 if robot.parents[i] < 0 else ids[robot.parents[i]]
        joint = pin.JointModelRevoluteUnaligned(np.asarray(robot.axis[i]))
        ids.append(model.addJoint(parent, joint, place, name))
        inertia = pin.Inertia.FromDynamicParameters(np.asarray(robot.parameters[i]))
        model.appendBodyToJoint(ids[-1], inertia, pin.SE3.Identity())
    data = model.createData()
    rows = [tuple(np.ascontiguousarray(x.T)) for x in map(np.asarray, states(robot, PEER_BATCH))]

    def loop(function):
        return [function(model, data, *row).copy() for row in zip(*rows, strict=True)][-1:]

    timed = interleaved({"rnea": lambda: loop(pin.rnea), "aba": lambda: loop(pin.aba)}, rounds)
    return {name: PEER_BATCH / t.median for name, t in timed.items()}


def mujoco_rate(robot: Robot, rounds: int, steps: int = 20) -> float:
    """Return RK4 steps per second of MuJoCo's threaded rollout on all cores."""
    import os

    import mujoco
    from mujoco import rollout

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.xml"
        export_mjcf(robot, path)
        model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.timestep = DT
    datas = [mujoco.MjData(model) for _ in range(os.cpu_count() or 1)]
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    start = np.zeros((PEER_BATCH, size))
    start[:, 1 : 1 + model.nq] = np.asarray(states(robot, PEER_BATCH)[0]).T
    control = np.zeros((PEER_BATCH, steps, model.nu))
    timed = interleaved(
        {"rollout": lambda: rollout.rollout(model, datas, start, control)[0][:1]}, rounds
    )
    return PEER_BATCH * steps / timed["rollout"].median


def main() -> None:
    """Measure, print both tables and keep them as JSON lines."""
    jax.config.update("jax_enable_x64", True)
    fast = "--fast" in sys.argv
    rounds = 3 if fast else 7
    batches = (1, 1000) if fast else (1, 100, 10_000, 100_000)
    rows = []
    print(f"{'arm':10s}{'batch':>8s}{'inverse/s':>13s}{'forward/s':>13s}{'RK4 steps/s':>13s}")
    for name, robot in arms().items():
        for batch in batches:
            rates = our_rates(robot, batch, rounds)
            rows.append({"arm": name, "batch": batch, **rates})
            print(f"{name:10s}{batch:8d}" + "".join(f"{rates[k]:13.3g}" for k in rates), flush=True)
        peers = pinocchio_rates(robot, rounds)
        steps = mujoco_rate(robot, rounds)
        rows.append({"arm": name, "peers": {**peers, "mujoco": steps}})
        print(f"{'':10s}{'peers':>8s}{peers['rnea']:13.3g}{peers['aba']:13.3g}{steps:13.3g}")
        best = max(r["inverse"] for r in rows if r["arm"] == name and "inverse" in r)
        print(f"{'':10s}inverse dynamics: {best / peers['rnea']:.0f} times Pinocchio's loop")
    print(f"\ntwo-link arm, {PARTICLES} particles, particle-steps/s")
    candidates = two_link_candidates(DT, 20 if fast else 100)
    timed = interleaved({name: call for name, (call, _) in candidates.items()}, rounds)
    ours = None
    for name, (_, count) in candidates.items():
        rate = count / timed[name].median
        ours = ours or rate
        rows.append({"two_link": name, "rate": rate})
        print(f"{name:28s}{rate:12.3g}   ours is {ours / rate:6.1f} times this", flush=True)
    rows.append(machine())
    print(f"written to {write_lines('dynamics.jsonl', rows)}")


if __name__ == "__main__":
    main()
