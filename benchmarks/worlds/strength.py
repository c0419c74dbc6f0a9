"""Amplitudes from wanted strengths, and strengths from finished runs.

The strength of an effect is the RMS torque on its strongest joint that the declared model cannot absorb
(for a contact: within its window), in units of the larger of the torque's noise and what a plain fit of the
declared model leaves of the log of a run without the effect.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import signal

from benchmarks.worlds.along import effect_torques, law_torque
from benchmarks.worlds.arm import GRAVITY, Arm
from benchmarks.worlds.bodies import askew, carried, loaded
from benchmarks.worlds.families import joint_scales
from benchmarks.worlds.laws import EVENTS, LAWS, Effect, scaled
from benchmarks.worlds.plain import Plain, best_cutoff, prepare
from benchmarks.worlds.reading import said
from benchmarks.worlds.record import measured_torque
from benchmarks.worlds.rigid import ROWS, Absorber, declared_columns, inverse_dynamics, rms
from benchmarks.worlds.simulate import Run

STRENGTHS = (0.5, 1.0, 2.0, 4.0, 8.0)
VISIBLE = 2.0
# An effect of which less than this share is left beside the declared model cannot be named by anybody.
ABSORBED = 0.02
# RMS of an effect at most, in RMS torques of its joint: what is more would be another machine.
_LARGEST = 1.0
_LIMITS = {
    "gain": 0.3,
    "seconds": (0.002, 0.03),
    "tilt": 1.5,
    "dq0": (0.15, 0.02),
    "waves": 0.1,
    "ratio": 0.3,
    "tc": (0.002, 0.03),
    "bend": 0.4,
    "hertz": (6.0, 60.0),
}

# Largest shift [m], turn [rad] and load [kg].
_BODY_LIMITS = {"shift": 0.05, "turn": 0.15, "m": 10.0}


@dataclass(frozen=True)
class Ground:
    """The run without undeclared effects, thinned, and what the declared model can absorb along it."""

    arm: Arm
    run: Run
    absorber: Absorber
    unit: np.ndarray


def step(run: Run) -> int:
    """Ticks from one row of a thinned run to the next."""
    return max(1, len(run.t) // ROWS)


def thin(run: Run) -> Run:
    every = step(run)
    q, dq, ddq, tau = (x[::every] for x in (run.q, run.dq, run.ddq, run.tau))
    return Run(run.t[::every], q, dq, ddq, tau, run.parts[:, ::every])


def make_ground(world, run: Run) -> Ground:
    """The ground of a world from its run without effects; ``unit`` as at the head of this file."""
    arm, noise = world.arm, world.logging.noise
    slim = thin(run)
    columns = declared_columns(arm, world.declared, slim.q, slim.dq, slim.ddq)
    log, hidden = world.log("train", run, ())
    train = prepare(world, log, hidden, best_cutoff(world, log, hidden, known=False))
    left = rms(Plain(world, train).left)
    return Ground(arm, slim, Absorber(columns, noise), np.maximum(noise, left))


def size_effect(effect: Effect, wanted: float, ground: Ground) -> Effect:
    """The effect with the amplitude that gives it the wanted strength, within what is sane."""
    change = _change(effect, ground)
    if change is None:
        return effect
    left = ground.absorber.left(change)
    if effect.kind in EVENTS:
        inside = np.abs(change).max(axis=1) > 0
        change, left = change[inside], left[inside]
    seen, whole = (rms(left) / ground.unit).max(), (rms(change) / ground.unit).max()
    # What nobody can name is given the wanted size as a whole, not blown up until a trace is left.
    factor = wanted / max(seen if seen > ABSORBED * whole else whole, 1e-12)
    largest = _LARGEST * rms(ground.run.tau).clip(min=1e-9)
    factor = min(factor, (largest / rms(change).clip(min=1e-12)).min())
    return _grown(effect, factor, ground)


def _grown(effect: Effect, factor: float, ground: Ground) -> Effect:
    """The effect whose first guess is multiplied by ``factor``."""
    p, j = effect.params, effect.joint
    kind = effect.kind
    if kind == "drive_gain":
        return replace(
            effect,
            params={"gain": 1.0 + np.sign(p["gain"] - 1) * min(0.01 * factor, _LIMITS["gain"])},
        )
    if kind == "time_delay":
        return replace(
            effect, params={"seconds": float(np.clip(1e-3 * factor, *_LIMITS["seconds"]))}
        )
    if kind == "torque_lag":
        return replace(effect, params={"tc": float(np.clip(1e-3 * factor, *_LIMITS["tc"]))})
    if kind in ("torque_constant_saturation", "torque_dead_band"):
        return _bent(effect, factor, ground.run)
    if kind in ("link_geometry", "payload_change"):
        most = min(_BODY_LIMITS[name] / abs(p[name]) for name in LAWS[kind].scaled)
        return scaled(effect, min(factor, most))
    if kind in ("encoder_eccentricity", "gear_coupling_error"):
        most = _LIMITS["waves" if kind == "encoder_eccentricity" else "ratio"]
        return scaled(effect, min(factor, most / max(abs(x) for x in p.values())))
    if kind == "base_tilt":
        factor = min(factor, _LIMITS["tilt"] / np.hypot(p["gx"], p["gy"]))
        return replace(effect, params={k: v * factor for k, v in p.items()})
    if kind == "encoder_offset":
        limit = _LIMITS["dq0"][int(ground.arm.sliding[j])]
        return replace(
            effect, params={"dq0": np.sign(p["dq0"]) * min(abs(p["dq0"]) * factor, limit)}
        )
    if kind == "contact":
        return replace(effect, params={**p, "tau": [float(x) * factor for x in p["tau"]]})
    if kind == "joint_elasticity":
        inertia = (joint_scales(ground.arm)[0] - ground.arm.rotor)[j]
        low, high = (inertia * (2 * np.pi * f) ** 2 for f in _LIMITS["hertz"])
        k = float(np.clip(p["k"] / factor, low, high))
        return replace(effect, params={"k": k, "d": 0.2 * np.sqrt(k * inertia)})
    return scaled(effect, factor)


def _bent(effect: Effect, factor: float, run: Run) -> Effect:
    """A distortion grown up to where it takes a large part of the joint's largest torque."""
    (name, value), largest = *effect.params.items(), float(np.abs(run.tau[:, effect.joint]).max())
    most = _LIMITS["bend"] * (largest if effect.kind == "torque_dead_band" else 1.0 / largest)
    return replace(effect, params={name: float(np.sign(value) * min(abs(value) * factor, most))})


def _change(effect: Effect, ground: Ground) -> np.ndarray | None:
    """Torque of the first guess of an effect along the ground's run, (T, n); None: cannot be said."""
    arm, run, j = ground.arm, ground.run, effect.joint
    change = np.zeros_like(run.tau)
    if effect.kind == "drive_gain":
        change[:, j] = 0.01 * run.tau[:, j]
    elif effect.kind == "time_delay":
        change = measured_torque(run, (replace(effect, params={"seconds": 1e-3}),)) - run.tau
    elif effect.kind in ("torque_lag", "torque_constant_saturation", "torque_dead_band"):
        change = measured_torque(run, (effect,)) - run.tau
    elif effect.kind == "link_geometry":
        change = inverse_dynamics(askew(arm, (effect,)), run.q, run.dq, run.ddq)
        change -= inverse_dynamics(arm, run.q, run.dq, run.ddq)
    elif effect.kind == "payload_change":
        change = inverse_dynamics(loaded(arm, effect), run.q, run.dq, run.ddq)
        change -= inverse_dynamics(arm, run.q, run.dq, run.ddq)
        change *= carried(effect, run.t)[:, None]
    elif effect.kind in ("encoder_eccentricity", "gear_coupling_error"):
        there = said((effect,), run.q, run.dq, run.ddq)
        true = [2 * x - y for x, y in zip((run.q, run.dq, run.ddq), there, strict=True)]
        change = inverse_dynamics(arm, *true) - inverse_dynamics(arm, run.q, run.dq, run.ddq)
    elif effect.kind == "base_tilt":
        gravity = GRAVITY + [effect.params["gx"], effect.params["gy"], 0.0]
        still = np.zeros_like(run.q)
        change = inverse_dynamics(arm, run.q, still, still, gravity)
        change -= inverse_dynamics(arm, run.q, still, still)
    elif effect.kind in ("encoder_offset", "joint_elasticity"):
        e = np.zeros_like(run.q)
        e[:, j] = effect.params["dq0"] if effect.kind == "encoder_offset" else _lag(effect, ground)
        motion = [run.q - e]
        for x in (run.dq, run.ddq):
            e = np.gradient(e, run.t, axis=0)
            motion.append(x - e)
        change = inverse_dynamics(arm, *motion) - inverse_dynamics(arm, run.q, run.dq, run.ddq)
    elif effect.kind == "backlash":
        return None
    else:
        return law_torque(arm, run, effect)
    return change


def _lag(effect, ground):
    """Deflection of a soft joint, quasi-static, below what its motion can follow."""
    run, j = ground.run, effect.joint
    load = inverse_dynamics(ground.arm, run.q, run.dq, run.ddq)[:, j]
    rate = 1.0 / (run.t[1] - run.t[0])
    sections = signal.butter(2, min(15.0, 0.4 * rate), fs=rate, output="sos")
    return signal.sosfiltfilt(sections, load) / effect.params["k"]


def _of_clocks(effect: Effect, rate: float) -> bool:
    """Whether an effect is a delay below half a sample: one of clocks, which every fit allows for."""
    return effect.kind == "time_delay" and effect.params["seconds"] < 0.5 / rate


def strengths(world, run: Run, unit: np.ndarray) -> list[dict]:
    """Strength of each effect of a world in a finished run, per joint and at its strongest joint."""
    arm, noise, effects = world.arm, world.logging.noise, world.effects
    slim = thin(run)
    columns = declared_columns(arm, world.declared, slim.q, slim.dq, slim.ddq)
    absorber = Absorber(columns, noise)
    rows = []
    parts = effect_torques(arm, run, effects)[:, :: step(run)]
    for effect, part in zip(effects, parts, strict=True):
        left = absorber.left(part)
        inside = slice(None)
        if effect.kind == "contact":
            inside = np.abs(part).max(axis=1) > 0
        elif effect.kind in EVENTS:
            inside = carried(effect, slim.t)
        ratio = rms(left[inside]) / unit
        share = rms(left[inside] / noise).max() / max(rms(part[inside] / noise).max(), 1e-12)
        rows.append(
            {
                "ratio": float(ratio.max()),
                "per_joint": [float(r) for r in ratio],
                "visible": bool(ratio.max() >= VISIBLE),
                "inseparable": bool(share < ABSORBED) or _of_clocks(effect, world.logging.rate),
            }
        )
    return rows
