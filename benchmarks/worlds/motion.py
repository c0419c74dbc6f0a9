"""Reference motions: Fourier series, point to point with rests, and one cycle repeated.

Each returns position, velocity and acceleration at the times asked, (T, n), within the arm's limits, as far
as a family can keep them; time before zero is the run-in that is not logged.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.worlds.arm import Arm

FAMILIES = ("fourier", "ptp", "cyclic")


@dataclass(frozen=True)
class Motion:
    """What to move: family, seed and length [s]."""

    family: str
    seed: int
    seconds: float


def reference(motion: Motion, arm: Arm, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position, velocity, acceleration at times ``t`` [s], each (T, n)."""
    rng = np.random.default_rng(motion.seed)
    if motion.family == "fourier":
        return _fourier(rng, arm, t)
    if motion.family == "ptp":
        count = int(3 * motion.seconds) + 8
        points = [_point(rng, arm) for _ in range(count)]
    else:
        cycle = [_point(rng, arm) for _ in range(int(rng.integers(3, 7)))]
        points = cycle * (int(2 * motion.seconds) + 2)
        # A repeated cycle has repeated timing too: the same draws for every round.
        rests = np.tile(rng.uniform(0.0, 0.8, len(cycle)), len(points) // len(cycle))
        haste = np.tile(rng.uniform(0.5, 1.0, len(cycle)), len(points) // len(cycle))
        return _through(np.array(points), rests, haste, rng.random() < 0.5, arm, t)
    rests = rng.uniform(0.0, 1.0, count) * (rng.random(count) < 0.7)
    haste = rng.uniform(0.4, 1.0, count)
    return _through(np.array(points), rests, haste, rng.random() < 0.5, arm, t)


def _point(rng, arm):
    return rng.uniform(-1.0, 1.0, arm.size) * arm.reach


def _fourier(rng, arm, t):
    base = 2 * np.pi / rng.uniform(5.0, 20.0)
    count = int(rng.integers(3, 7))
    k = np.arange(1, count + 1) * base
    a, b = rng.normal(0, 1, (2, count, arm.size)) / np.sqrt(k)[:, None]
    grid = np.linspace(0, 2 * np.pi / base, 1000)

    def series(x):
        s, c = np.sin(np.outer(x, k)), np.cos(np.outer(x, k))
        k1, k2 = k[:, None], k[:, None] ** 2
        return s @ a + c @ b, c @ (a * k1) - s @ (b * k1), -s @ (a * k2) - c @ (b * k2)

    peaks = [np.abs(x).max(axis=0) for x in series(grid)]
    limits = (arm.reach, arm.speed, arm.acceleration)
    scale = np.min([limit / peak for limit, peak in zip(limits, peaks, strict=True)], axis=0)
    return tuple(x * scale for x in series(t))


def _through(points, rests, haste, quintic, arm, t):
    """Moves from point to point, all joints together, with a rest after each."""
    q, dq, ddq = (np.zeros((len(t), arm.size)) for _ in range(3))
    begin = -1.0  # the run-in
    q[:] = points[0]
    # Peak velocity and acceleration of a unit move in unit time.
    fastest, hardest = (1.875, 5.774) if quintic else (1.5, 4.5)
    for k in range(len(points) - 1):
        if begin > t[-1]:
            break
        step = points[k + 1] - points[k]
        size = np.abs(step)
        seconds = max(
            (fastest * size / arm.speed).max(), np.sqrt(hardest * size / arm.acceleration).max()
        )
        seconds = max(seconds, 0.2) / haste[k]
        rows = (t >= begin) & (t < begin + seconds)
        x = (t[rows] - begin) / seconds
        s, ds, dds = _quintic(x) if quintic else _trapezoid(x)
        q[rows] = points[k] + np.outer(s, step)
        dq[rows] = np.outer(ds, step) / seconds
        ddq[rows] = np.outer(dds, step) / seconds**2
        begin += seconds
        q[t >= begin] = points[k + 1]
        begin += rests[k]
    return q, dq, ddq


def _quintic(x):
    return (
        x**3 * (10 - 15 * x + 6 * x**2),
        30 * x**2 * (1 - x) ** 2,
        60 * x * (1 - x) * (1 - 2 * x),
    )


def _trapezoid(x):
    """A third each of speeding up, steady speed and slowing down."""
    up, down = x < 1 / 3, x > 2 / 3
    s = np.where(up, 2.25 * x**2, np.where(down, 1 - 2.25 * (1 - x) ** 2, 1.5 * x - 0.25))
    ds = np.where(up, 4.5 * x, np.where(down, 4.5 * (1 - x), 1.5))
    return s, ds, np.where(up, 4.5, np.where(down, -4.5, 0.0))
