"""Other libraries on the same arms: Pinocchio, MuJoCo, MJX and frax.

Each function returns rates in evaluations (or RK4 steps) per core-second, None where a library is not
installed. brax has no row: its generalized dynamics are no longer maintained in favor of MJX. Every
peer's result is compared with ours before it is timed.
"""

import importlib.util
import os
import tempfile
import warnings
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.timing import interleaved
from jaxswarm.identify.physical.export import export_mjcf, export_urdf
from jaxswarm.robot import Robot, forward_dynamics, inverse_dynamics

Samples = tuple[jax.Array, jax.Array, jax.Array]


def pinocchio_rates(robot: Robot, samples: Samples, rounds: int) -> dict[str, float]:
    """Return RNEA and ABA calls per second from a Python loop on one core."""
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
    rows = [tuple(np.ascontiguousarray(x.T)) for x in map(np.asarray, samples)]

    def loop(function):
        return [function(model, data, *row).copy() for row in zip(*rows, strict=True)][-1:]

    _compare("Pinocchio", pin.rnea(model, data, *(x[0] for x in rows)), _first(robot, samples)[0])
    timed = interleaved({"rnea": lambda: loop(pin.rnea), "aba": lambda: loop(pin.aba)}, rounds)
    return {name: len(rows[0]) / np.median(t.computed) for name, t in timed.items()}


def mujoco_rate(robot: Robot, samples: Samples, dt: float, rounds: int, steps: int = 20) -> float:
    """Return RK4 steps per second of MuJoCo's threaded rollout on all cores."""
    import mujoco
    from mujoco import rollout

    model = _mujoco_model(robot, dt)
    batch = samples[0].shape[1]
    datas = [mujoco.MjData(model) for _ in range(os.cpu_count() or 1)]
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    start = np.zeros((batch, size))
    start[:, 1 : 1 + model.nq] = np.asarray(samples[0]).T
    control = np.zeros((batch, steps, model.nu))
    timed = interleaved(
        {"rollout": lambda: rollout.rollout(model, datas, start, control)[0][:1]}, rounds
    )
    return batch * steps / np.median(timed["rollout"].computed)


def mjx_rates(robot: Robot, samples: Samples, dt: float, rounds: int) -> dict[str, float] | None:
    """Return MJX's accelerations and RK4 steps per second, vmapped; None where it is missing."""
    if importlib.util.find_spec("mujoco") is None or importlib.util.find_spec("mujoco.mjx") is None:
        return None
    from mujoco import mjx

    model = mjx.put_model(_mujoco_model(robot, dt))
    data = mjx.make_data(model)

    def of(q, dq, tau):
        return data.replace(qpos=q, qvel=dq, ctrl=tau)

    forward = jax.jit(jax.vmap(lambda *s: mjx.forward(model, of(*s)).qacc))
    step = jax.jit(jax.vmap(lambda *s: mjx.step(model, of(*s)).qpos))
    rows = tuple(x.T for x in samples)
    _compare("MJX", forward(*rows)[0], _first(robot, samples)[1])
    timed = interleaved({"forward": lambda: forward(*rows), "rk4": lambda: step(*rows)}, rounds)
    return {name: rows[0].shape[0] / np.median(t.computed) for name, t in timed.items()}


def frax_rates(robot: Robot, samples: Samples, rounds: int) -> dict[str, float] | None:
    """Return frax' inverse and forward dynamics per second, vmapped; None where it is missing."""
    if importlib.util.find_spec("frax") is None:
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from frax.core.robot import Robot as FraxRobot
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.urdf"
        export_urdf(robot, path)
        # It wants an inertia for the base as well, which moves nothing.
        zero = "".join(f' i{a}="1"' if a[0] == a[1] else f' i{a}="0"' for a in _SIX)
        solid = f'<inertial><origin xyz="0 0 0"/><mass value="1"/><inertia{zero}/></inertial>'
        text = path.read_text()
        base = '<link name="base"'
        head, tail = text[: text.index(base)], text[text.index(base) + len(base) :]
        path.write_text(f"{head}{base}>{solid}</link>{tail[tail.index('>') + 1 :]}")
        peer = FraxRobot(str(path))
    inverse = jax.jit(
        jax.vmap(lambda q, dq, ddq: peer.mass_matrix(q) @ ddq + peer.nonlinear_bias(q, dq))
    )
    forward = jax.jit(jax.vmap(lambda q, dq, tau: peer.forward_dynamics(q, dq, tau, None)))
    rows = tuple(x.T for x in samples)
    ours = _first(robot, samples)
    _compare("frax, inverse", inverse(*rows)[0], ours[0])
    _compare("frax, forward", forward(*rows)[0], ours[1])
    timed = interleaved(
        {"inverse": lambda: inverse(*rows), "forward": lambda: forward(*rows)}, rounds
    )
    return {name: rows[0].shape[0] / np.median(t.computed) for name, t in timed.items()}


_SIX = ("xx", "xy", "xz", "yy", "yz", "zz")


def _first(robot: Robot, samples: Samples) -> tuple[jax.Array, jax.Array]:
    one = tuple(x[:, 0] for x in samples)
    return inverse_dynamics(robot, *one), forward_dynamics(robot, *one)


def _compare(name: str, theirs, ours) -> None:
    """Stop if a peer computes something else."""
    off = float(jnp.abs(jnp.asarray(theirs) - ours).max() / jnp.abs(ours).max())
    if not off < 1e-8:
        raise RuntimeError(f"{name} differs from ours by {off:.2g} of the largest value")


def _mujoco_model(robot: Robot, dt: float):
    import mujoco

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.xml"
        export_mjcf(robot, path)
        model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.timestep = dt
    return model
