"""What an arm with its identified effects does: along a reference under a PD controller, or by given torques.

The controller is tau = feedforward + kp (q_ref - q) + kd (dq_ref - dq). Without gains of the user those of
a critically damped loop of :data:`BANDWIDTH` hertz on the arm's own mass matrix at the start are taken, and
told. The feedforward is the rigid body's inverse dynamics along the reference, so that what the effects do
is what the tracking error shows.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import scipy

from jaxswarm.errors import InputError
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.report.summary import units
from jaxswarm.logs import Log
from jaxswarm.memory import GIB, refuse_beyond_free
from jaxswarm.robot import inverse_dynamics, mass_matrix
from jaxswarm.simulate import (
    PD,
    Plant,
    Reference,
    Trajectory,
    make_plant,
    measured_torque,
    rest,
    stable_substeps,
    track,
)
from jaxswarm.simulate import simulate as drive
from jaxswarm.tables import Result, Table
from jaxswarm.tasks.inputs import as_logs, as_model, in_double
from jaxswarm.tasks.words import number

BANDWIDTH = 5.0  # Hz: that of a usual joint loop of an industrial arm
FEEDFORWARDS = ("rigid", "none")
# The step has to be stable along the whole motion: it is asked for at this many positions of it.
_PLACES = 5
_MOST_STEPS = 20_000_000
# Signals of a joint that stand in memory at once: the reference, what is fed forward, motion, torques, the log.
_SIGNALS = 24


@dataclass(frozen=True, eq=False, repr=False)
class Simulated(Result):
    """A simulated motion.

    Attributes:
        motion: The :class:`jaxswarm.simulate.Trajectory`.
        log: The same as a log would show it, with gains and delays of the measurement.
    """

    motion: Trajectory | None = None
    log: Log | None = None


@in_double
def simulate(
    model: Model | str | Path,
    reference: Log | str | Path,
    *,
    kp: float | Sequence[float] | None = None,
    kd: float | Sequence[float] | None = None,
    feedforward: str = "rigid",
    playback: bool = False,
    rate: float | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> Simulated:
    """Simulate an identified arm along a reference.

    Args:
        model: A model, a result with one, or its ``model.json``.
        reference: Positions over time, velocities and accelerations where given; a log or a file, such
            as ``trajectory.csv`` of ``excite``.
        kp, kd: Gains [N m/rad, N m s/rad; a slide: N/m, N s/m], one or one a joint; None: see above.
        feedforward: ``rigid`` or ``none``.
        playback: Drive the arm with the reference's torques, without a controller.
        rate: Samples per second [Hz]; None: the reference's own.
        progress: Called with one line per stage.

    Returns:
        Tracking errors and gains, with ``motion`` and ``log``.

    Raises:
        InputError: If something cannot be used or the motion diverges.
    """
    model = as_model(model)
    robot = model.robot
    if feedforward not in FEEDFORWARDS:
        raise InputError(f"feedforward {feedforward!r}: use {' or '.join(FEEDFORWARDS)}")
    (log,) = as_logs(reference, robot, require_torque=playback)
    t, wanted, tau = resampled(log, rate)
    plant = make_plant(robot, model.terms, width=model.width)
    dt = float(t[1] - t[0])
    substeps = _substeps(plant, wanted[0], dt)
    gains = gains_of(plant, wanted[0][0], kp, kd)
    start = rest(plant, jnp.asarray(wanted[0][0]), jnp.asarray(wanted[1][0]))
    progress(f"simulating {len(t)} samples of {substeps} steps")
    if playback:
        motion = jax.jit(lambda p, s, u: drive(p, s, u, dt=dt, hold="first", substeps=substeps))(
            plant, start, jnp.asarray(tau)
        )
    else:
        ahead = np.zeros_like(wanted[0])
        if feedforward == "rigid":
            ahead = jax.vmap(lambda *x: inverse_dynamics(robot, *x))(*map(jnp.asarray, wanted))
        target = Reference(*map(jnp.asarray, (*wanted, ahead)))
        controller = PD(*map(jnp.asarray, gains))
        motion = jax.jit(lambda p, s, c, r: track(p, s, c, r, dt=dt, substeps=substeps))(
            plant, start, controller, target
        )
    return _result(model, plant, motion, wanted[0], log, None if playback else gains, substeps)


def _substeps(plant: Plant, q: np.ndarray, dt: float) -> int:
    """Steps of the integrator within a sample [s] that hold on the way through positions (T, n)."""
    picks = np.linspace(0, len(q) - 1, _PLACES).astype(int)
    substeps = max(stable_substeps(plant, jnp.asarray(one), dt) for one in q[picks])
    if substeps * len(q) > _MOST_STEPS:
        raise InputError(
            f"{substeps} steps a sample are needed, {substeps * len(q):.3g} in all (at most "
            f"{_MOST_STEPS:.0e}): a joint is too stiff for its inertia, or the reference too long"
        )
    return substeps


def resampled(log: Log, rate: float | None) -> tuple[np.ndarray, tuple, np.ndarray | None]:
    """A uniform clock from zero, (q, dq, ddq) on it by cubic splines, and torque, linear."""
    own = log.t - log.t[0]
    if rate is not None and not 0.0 < rate < 1e6:
        raise InputError(f"rate {rate}: give samples per second above zero")
    step = float(np.median(np.diff(own))) if rate is None else 1.0 / rate
    # The end of a reference of N periods is a sample, whatever rounding made of the median period.
    samples = int(np.floor(own[-1] / step + 1e-6)) + 1
    if samples < 2:
        raise InputError(
            f"{log.source}: is shorter than one period of {step:.3g} s; raise the rate"
        )
    refuse_beyond_free(
        8.0 * samples * (1 + _SIGNALS * log.q.shape[1]) / GIB,
        f"{log.source}: to simulate {samples} samples of {log.q.shape[1]} joints takes",
        "lower the rate, or give a shorter reference",
    )
    t = np.arange(samples) * step
    path = scipy.interpolate.CubicSpline(own, log.q)
    dq = path(t, 1) if log.dq is None else scipy.interpolate.CubicSpline(own, log.dq)(t)
    ddq = path(t, 2) if log.ddq is None else scipy.interpolate.CubicSpline(own, log.ddq)(t)
    tau = None
    if log.tau is not None:
        tau = np.column_stack([np.interp(t, own, column) for column in log.tau.T])
    return t, (path(t), dq, ddq), tau


def gains_of(plant: Plant, q: np.ndarray, kp, kd) -> tuple[np.ndarray, np.ndarray]:
    """Gains as given, one for all joints or one each, or those of the loop of :data:`BANDWIDTH`."""
    n = plant.robot.num_joints
    omega = 2.0 * np.pi * BANDWIDTH
    inertia = np.diag(np.asarray(mass_matrix(plant.robot, jnp.asarray(q)))).copy()
    usual = {"kp": inertia * omega**2, "kd": 2.0 * inertia * omega}
    found = []
    for name, given in (("kp", kp), ("kd", kd)):
        values = usual[name] if given is None else np.atleast_1d(np.asarray(given, float))
        if values.shape not in ((1,), (n,)) or not (np.isfinite(values) & (values >= 0)).all():
            raise InputError(
                f"{name} = {given}: give one gain not below zero, or one a joint ({n})"
            )
        found.append(np.broadcast_to(values, (n,)))
    return found[0], found[1]


def _result(model, plant, motion, wanted, log, gains, substeps) -> Simulated:
    robot = model.robot
    q, tau = np.asarray(motion.q), np.asarray(motion.tau)
    whole = np.isfinite(q).all(axis=1)
    if not whole.all():
        raise InputError(
            f"{log.source}: the motion diverges at t = {float(motion.t[np.argmin(whole)]):.4g} s; "
            + ("torques without a controller drift away: simulate a shorter part" * (gains is None))
            + ("choose other gains, or a higher rate" * (gains is not None))
        )
    shown = np.asarray(measured_torque(plant, motion))
    kept = Log(f"simulated: {robot.name}", robot.joints, np.asarray(motion.t), q,
               np.asarray(motion.dq), np.asarray(motion.ddq), shown)  # fmt: skip
    if plant.soft:
        kept = Log(**{**vars(kept), "channels": {"q_link": np.asarray(motion.q_link)}})
    error = q - wanted
    notes = []
    if model.smooth:
        notes.append("smooth terms without a law are functions of the log and are not simulated")
    content = {
        "robot": robot.name,
        "joints": list(robot.joints),
        "effects": [term.label(robot.joints) for term in model.terms],
        "samples": len(q),
        "rate": 1.0 / float(motion.t[1] - motion.t[0]),
        "substeps": substeps,
        "gains": None if gains is None else {"kp": list(gains[0]), "kd": list(gains[1])},
        "tracking_error": {
            "rms": list(np.sqrt(np.mean(error**2, axis=0))),
            "largest": list(np.abs(error).max(axis=0)),
        },
        "torque": {
            "rms": list(np.sqrt(np.mean(tau**2, axis=0))),
            "largest": list(np.abs(tau).max(axis=0)),
        },
        "notes": notes,
    }
    rows = []
    for j, (joint, unit) in enumerate(zip(robot.joints, units(robot), strict=True)):
        length = "rad" if robot.kinds[j] == "revolute" else "m"
        cells = [
            f"{number(content['tracking_error'][k][j], 3)} {length}" for k in ("rms", "largest")
        ]
        cells += [f"{number(content['torque']['largest'][j], 4)} {unit}"]
        per = (f"{unit}/{length}", f"{unit} s/{length}")
        cells += (
            ["none", "none"]
            if gains is None
            else [f"{number(g[j], 4)} {p}" for g, p in zip(gains, per, strict=True)]
        )
        rows.append((joint, *cells))
    head = ("joint", "off the reference, RMS", "largest", "largest torque", "kp", "kd")
    table = Table(f"{robot.name}: {len(q)} samples simulated", head, tuple(rows))
    return Simulated(content, tuple(notes), (table,), motion=motion, log=kept)
