"""From a run to what a logger stores: rate, encoders, torque channel, stamps, gaps and spikes."""

from dataclasses import dataclass

import numpy as np
from scipy import signal

from benchmarks.worlds.arm import Arm
from benchmarks.worlds.control import Control
from benchmarks.worlds.families import log_uniform
from benchmarks.worlds.laws import Effect
from benchmarks.worlds.simulate import Run, find

RATES = (50, 100, 125, 200, 250, 500, 1000)
# Share of logs with each defect.
_SHARES = {"lag": 0.4, "jitter": 0.2, "dropouts": 0.2, "spikes": 0.15, "dq": 0.4, "coarse": 0.5}
_SLIDE_TURN = 0.02  # m of a slide per turn of its encoder


@dataclass(frozen=True)
class Logging:
    """The logger of a world.

    Attributes:
        rate: [Hz], a whole fraction of the control rate.
        bits: Of the encoders, a turn.
        noise: Of the torque, white, (n,) [N m or N].
        coarse: Step of the torque channel in units of its noise; 0: none.
        lag: Time constant of the torque's filter [s].
        jitter: Standard deviation of the sampling instants, in sampling periods.
        true_stamps: Jitter moves the samples and the stamps say so; else the stamps alone are off.
        dropouts, spikes: Per second.
        dq: Whether the velocity is logged, and its noise as a share of the joint's top speed.
    """

    rate: int
    bits: int
    noise: np.ndarray
    coarse: float
    lag: float
    jitter: float
    true_stamps: bool
    dropouts: float
    spikes: float
    dq: float


def draw_logging(rng: np.random.Generator, control: Control, torque: np.ndarray) -> Logging:
    """A logger; ``torque`` is the RMS torque of usual motion, (n,)."""
    rates = [r for r in RATES if control.rate % r == 0 and r <= control.rate]
    rate = int(rng.choice(rates))
    on = {name: rng.random() < share for name, share in _SHARES.items()}
    level = log_uniform(rng, 0.002, 0.02)
    return Logging(
        rate=rate,
        bits=int(rng.integers(15, 21)),
        noise=torque * level * rng.uniform(0.7, 1.4, len(torque)),
        coarse=float(on["coarse"] * rng.uniform(0.3, 1.5)),
        # Below half a sample: a longer lag would be a delay that somebody has to name.
        lag=float(on["lag"] * rng.uniform(0.1, 0.4) / rate),
        jitter=float(on["jitter"] * log_uniform(rng, 0.01, 0.08)),
        true_stamps=bool(rng.random() < 0.5),
        dropouts=float(on["dropouts"] * log_uniform(rng, 0.02, 0.3)),
        spikes=float(on["spikes"] * log_uniform(rng, 0.01, 0.1)),
        dq=float(on["dq"] * log_uniform(rng, 3e-4, 3e-3)),
    )


def quantum(logging: Logging, arm: Arm) -> np.ndarray:
    """Step of each encoder [rad or m], (n,)."""
    return np.where(arm.sliding, _SLIDE_TURN, 2 * np.pi) / 2**logging.bits


def measured_torque(run: Run, effects: tuple[Effect, ...]) -> np.ndarray:
    """The motor torque through drives that bend, gains, a filter and the delay of its clock, without noise."""
    tau = run.tau.copy()
    for e in find(effects, "torque_constant_saturation"):
        tau[:, e.joint] *= 1.0 - e.params["c"] * np.abs(tau[:, e.joint])
    for e in find(effects, "torque_dead_band"):
        tau[:, e.joint] += e.params["d"] * np.sign(tau[:, e.joint])
    for e in find(effects, "drive_gain"):
        tau[:, e.joint] *= e.params["gain"]
    for e in find(effects, "torque_lag"):
        tau = filtered(tau, e.params["tc"] / (run.t[1] - run.t[0]))
    for e in find(effects, "time_delay"):
        late = run.t - e.params["seconds"]
        tau = np.column_stack([np.interp(late, run.t, column) for column in tau.T])
    return tau


def filtered(tau: np.ndarray, samples: float) -> np.ndarray:
    """A first-order low-pass along time, settled at its begin; its time constant in samples."""
    pole = np.exp(-1.0 / samples)
    return signal.lfilter([1 - pole], [1, -pole], tau, axis=0, zi=pole * tau[:1])[0]


def record(
    run: Run,
    arm: Arm,
    effects: tuple[Effect, ...],
    logging: Logging,
    control: Control,
    effect_torque: np.ndarray,
    rng: np.random.Generator,
    plain: bool,
) -> tuple[dict, dict]:
    """The log, and beside it what it does not say: ``tau_clean`` and ``tau_effect``.

    ``plain``: without jitter, dropouts and spikes, as the logs have it that predictions are scored on.
    """
    tau = measured_torque(run, effects)
    if logging.lag > 0:
        tau = filtered(tau, logging.lag * control.rate)
    every = control.rate // logging.rate
    rows = np.arange(0, len(run.t), every)
    shift = np.zeros(len(rows))
    if logging.jitter and not plain:
        shift = np.clip(logging.jitter * rng.normal(size=len(rows)), -0.3, 0.3) / logging.rate
        shift[[0, -1]] = 0.0
    asked = run.t[rows] + (shift if logging.true_stamps else 0.0)

    def at(x):
        return np.column_stack([np.interp(asked, run.t, column) for column in x.T])

    step = quantum(logging, arm)
    clean, n = at(tau), arm.size
    noisy = clean + logging.noise * rng.normal(size=clean.shape)
    if logging.coarse:
        grid = logging.coarse * logging.noise
        noisy = np.round(noisy / grid) * grid
    log = {"t": run.t[rows] + shift, "q": np.round(at(run.q) / step) * step, "tau": noisy}
    if logging.dq:
        log["dq"] = at(run.dq) + logging.dq * arm.speed * rng.normal(size=clean.shape)
    hidden = {"tau_clean": clean, "tau_effect": at(effect_torque)}
    if not plain:
        for row in rng.integers(0, len(rows), rng.poisson(logging.spikes * run.t[-1])):
            j = rng.integers(n)
            noisy[row, j] += rng.choice([-1, 1]) * rng.uniform(1, 3) * np.abs(clean[:, j]).max()
        keep = np.ones(len(rows), bool)
        for row in rng.integers(1, len(rows) - 1, rng.poisson(logging.dropouts * run.t[-1])):
            keep[row : row + rng.integers(1, 11)] = False
        keep[-1] = True
        log, hidden = ({k: v[keep] for k, v in part.items()} for part in (log, hidden))
    return log, hidden
