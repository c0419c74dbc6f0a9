"""Ways in which a log is spoiled, with what has to be said about each of them."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jaxswarm.identify.checks.samples import Samples
from jaxswarm.logs import Log

Spoil = Callable[[Log, int, np.random.Generator], Log]


class Spoiling(NamedTuple):
    """One way to spoil a log.

    Attributes:
        spoil: Takes the log, a joint and random numbers.
        said: Words one of which a right complaint holds: a check's name, or a part of a note.
        effects: Effects that are a right answer, too: the log is as if the arm had them.
        hides: Whether it may change nothing that shows: another robot explains such a log as well, as with the
            zero of a last joint, or the scale of a joint that nothing couples to the others.
        undo: Takes it back on the motion as it was filtered; None: that of the log as it was is taken. A log of
            another clock has other filters and gaps, too.
    """

    spoil: Spoil
    said: tuple[str, ...]
    effects: tuple[str, ...] = ()
    hides: bool = False
    undo: Callable[[Samples], Samples] | None = None


def column(
    values: np.ndarray, joint: int, change: Callable[[np.ndarray], np.ndarray]
) -> np.ndarray:
    """A copy with one joint's column changed."""
    changed = values.copy()
    changed[:, joint] = change(values[:, joint])
    return changed


def _torque(change) -> Spoil:
    return lambda log, j, rng: replace(log, tau=column(log.tau, j, change))


def _position(change) -> Spoil:
    return lambda log, j, rng: replace(log, q=column(log.q, j, change), dq=None)


def _with_velocity(change) -> Spoil:
    """The velocity as a good channel would have it, then changed."""

    def spoil(log: Log, j: int, rng: np.random.Generator) -> Log:
        dq = np.gradient(log.q, log.t, axis=0) + 1e-3 * rng.normal(size=log.q.shape)
        return replace(log, dq=change(dq, j))

    return spoil


def _with_acceleration(change) -> Spoil:
    def spoil(log: Log, j: int, rng: np.random.Generator) -> Log:
        smooth = np.gradient(np.gradient(log.q, log.t, axis=0), log.t, axis=0)
        kernel = np.hanning(31) / np.hanning(31).sum()
        ddq = np.stack([np.convolve(x, kernel, "same") for x in smooth.T], axis=1)
        return replace(log, ddq=change(ddq, j))

    return spoil


def _faster(s: Samples) -> Samples:
    return replace(s, dq=2.0 * s.dq, ddq=4.0 * s.ddq)


def _swapped(values: np.ndarray, j: int) -> np.ndarray:
    order = np.arange(values.shape[1])
    other = (j + 1) % len(order)
    order[[j, other]] = order[[other, j]]
    return values[:, order]


def _late(log: Log, j: int, rng) -> Log:
    return replace(log, tau=column(log.tau, j, lambda x: np.interp(log.t - 0.02, log.t, x)))


def _spikes(log: Log, j: int, rng) -> Log:
    tau = log.tau.copy()
    rows = rng.choice(np.arange(5, len(tau) - 5), max(1, len(tau) // 1000), replace=False)
    tau[rows, j] += np.ptp(tau[:, j]) * rng.choice([-1.0, 1.0], len(rows))
    return replace(log, tau=tau)


def _lost(log: Log, j: int, rng) -> Log:
    count = int(0.8 * len(log.t))
    kept = np.sort(rng.choice(len(log.t), count, replace=False))
    return Log(log.source, log.joints, log.t[:count], log.q[kept], tau=log.tau[kept])


def _stuck(log: Log, j: int, rng) -> Log:
    """The encoder stands for 3 s, or a sixth of the log, where its joint moves most."""
    length = min(int(3.0 / np.median(np.diff(log.t))), len(log.t) // 6)
    speed = np.abs(np.gradient(log.q[:, j]))
    start = int(np.argmax(np.convolve(speed, np.ones(length), "valid")))
    q = log.q.copy()
    q[start : start + length, j] = q[start, j]
    return replace(log, q=q, dq=None)


def _half(log: Log, j: int, rng) -> Log:
    """One joint's position and torque stop being written in the midst of the log."""
    q, tau, middle = log.q.copy(), log.tau.copy(), len(log.t) // 2
    q[middle:, j], tau[middle:, j] = q[middle, j], tau[middle, j]
    return replace(log, q=q, tau=tau, dq=None)


def _clipped(x: np.ndarray) -> np.ndarray:
    """At a part of the largest torque, single samples aside: a spike is no limit."""
    limit = 0.8 * np.quantile(np.abs(x), 0.998)
    return np.clip(x, -limit, limit)


def _jump(log: Log, j: int, rng) -> Log:
    t = log.t.copy()
    t[len(t) // 2 :] += 100.0
    return replace(log, t=t)


def _resting(log: Log, j: int, rng) -> Log:
    q = np.repeat(log.q[:1], len(log.t), axis=0) + 1e-6 * rng.normal(size=log.q.shape)
    tau = np.repeat(log.tau[:1], len(log.t), axis=0) + 0.1 * rng.normal(size=log.q.shape)
    return replace(log, q=q, tau=tau, dq=None)


SPOILINGS: dict[str, Spoiling] = {
    "torque sign": Spoiling(_torque(np.negative), ("torque_sign", "position_sign"), hides=True),
    "position sign": Spoiling(_position(np.negative), ("position_sign", "torque_sign"), hides=True),
    "torques swapped": Spoiling(
        lambda log, j, rng: replace(log, tau=_swapped(log.tau, j)), ("swapped_channels", "torque_scale")),
    "torque halved": Spoiling(_torque(lambda x: 0.5 * x), ("torque_scale",), ("drive_gain",), True),
    "torque 20 ms late": Spoiling(_late, ("late_torque",), ("time_delay",), True),
    "encoder scale 2": Spoiling(_position(lambda x: 2.0 * x), ("encoder_scale",), hides=True),
    "time scale 2": Spoiling(
        lambda log, j, rng: replace(log, t=2.0 * log.t, dq=None), ("time_scale",), hides=True,
        undo=_faster),
    "encoder zero 0.3 rad": Spoiling(
        _position(lambda x: x + 0.3), ("encoder_zero", "encoder_offset"), ("encoder_offset",), True),
    "0.1 % of spikes": Spoiling(_spikes, ("spikes",)),
    "pure noise": Spoiling(
        lambda log, j, rng: replace(log, tau=rng.normal(size=log.tau.shape)), ("no_relation", "torque_unit")),
    "standstill": Spoiling(_resting, ("no joint moves", "never moves", "no_relation", "lack")),
    "samples lost, time closed up": Spoiling(_lost, ("lost_samples",)),
    "encoder stuck for 3 s": Spoiling(_stuck, ("stuck",)),
    "position frozen": Spoiling(
        _position(lambda x: np.full_like(x, x[0])), ("never moves", "stuck", "no_relation")),
    "half of a joint missing": Spoiling(_half, ("stuck", "saturation")),
    "velocities swapped": Spoiling(_with_velocity(_swapped), ("velocity contradicts",)),
    "velocity 1.3 times": Spoiling(
        _with_velocity(lambda dq, j: column(dq, j, lambda x: 1.3 * x)), ("velocity contradicts",)),
    "velocity negated": Spoiling(
        _with_velocity(lambda dq, j: column(dq, j, np.negative)), ("velocity contradicts",)),
    "velocity of zeros": Spoiling(
        _with_velocity(lambda dq, j: column(dq, j, np.zeros_like)), ("velocity contradicts",)),
    "velocity constant": Spoiling(
        _with_velocity(lambda dq, j: column(dq, j, lambda x: np.full_like(x, 0.3))),
        ("velocity contradicts",)),
    "acceleration negated": Spoiling(
        _with_acceleration(lambda a, j: column(a, j, np.negative)), ("acceleration contradicts",)),
    "torque in mN m": Spoiling(lambda log, j, rng: replace(log, tau=1e3 * log.tau), ("torque_unit",)),
    "degrees": Spoiling(
        lambda log, j, rng: replace(log, q=np.degrees(log.q), dq=None), ("encoder_scale",)),
    "clock jump of 100 s": Spoiling(_jump, ("gap",)),
    "torque dead": Spoiling(_torque(lambda x: np.full_like(x, x[0])), ("dead",)),
    "torque of noise": Spoiling(
        lambda log, j, rng: replace(
            log,
            tau=column(log.tau, j, lambda x: 1e-3 * x.std() * rng.normal(size=len(x))),
        ),
        ("no_relation",),
    ),
    "torque clipped": Spoiling(_torque(_clipped), ("saturation",)),
}  # fmt: skip
