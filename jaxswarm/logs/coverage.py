"""What a motion covers: noise of the signals, how speeds and loads are spread, whether it repeats itself.

Law after law needs its own part of the motion: Coulomb friction a reversal, Stribeck friction slow
motion, viscous friction a spread of speeds, friction of load a load of either sign.
"""

from dataclasses import dataclass

import numpy as np

from jaxswarm.logs.filtering import white_noise
from jaxswarm.logs.log import Log
from jaxswarm.logs.quality import velocity

# A motion repeats itself if its velocities correlate by this much with themselves one period later; the
# noise of differentiated positions takes a few percent.
_SAME = 0.95
# Periods shorter than this are samples that follow on each other, not a motion that returns [s].
_SHORTEST = 0.2
# Slow is below this share of the top speed: where Stribeck friction shows and viscous friction does not.
_SLOW, _FAST = 0.1, 0.5
_GRID = 20_000


@dataclass(frozen=True)
class Coverage:
    """How one joint is excited and how noisy its signals are.

    Attributes:
        position_noise: Standard deviation of the sample-to-sample noise of q [rad or m].
        torque_noise: The same of tau [N m or N], None without torque.
        slow, fast: Shares of the moving samples below 10 % and above 50 % of the top speed.
        load_reversals: Changes of sign of the torque against its mean over the log, None without torque.
        both_directions: Share of the moving samples in the rarer direction.
    """

    position_noise: float
    torque_noise: float | None
    slow: float
    fast: float
    load_reversals: int | None
    both_directions: float


def coverage(log: Log) -> tuple[Coverage, ...]:
    """Coverage of every joint of a log."""
    noise = white_noise(log.q) if len(log.t) > 3 else np.zeros(len(log.joints))
    torque_noise = None if log.tau is None or len(log.t) < 4 else white_noise(log.tau)
    found = []
    for k in range(len(log.joints)):
        dq = velocity(log.t, log.q[:, k])
        speed = np.abs(dq)
        top = float(np.quantile(speed, 0.995))
        moving = speed > 0.01 * top if top > 0 else np.zeros(len(dq), bool)
        count = max(int(moving.sum()), 1)
        forward = float((moving & (dq > 0)).sum()) / count
        loads = (
            None
            if log.tau is None or torque_noise is None
            else _sign_changes(log.tau[:, k], float(torque_noise[k]))
        )
        found.append(
            Coverage(
                position_noise=float(noise[k]),
                torque_noise=None if torque_noise is None else float(torque_noise[k]),
                slow=float((moving & (speed < _SLOW * top)).sum()) / count,
                fast=float((moving & (speed > _FAST * top)).sum()) / count,
                load_reversals=loads,
                both_directions=min(forward, 1.0 - forward) if moving.any() else 0.0,
            )
        )
    return tuple(found)


def _sign_changes(tau: np.ndarray, noise: float) -> int:
    """Changes of sign of the torque beyond five times its noise."""
    signs = np.sign(tau[np.abs(tau) > 5.0 * noise])
    return int(np.sum(signs[1:] != signs[:-1]))


def period_of(log: Log) -> float | None:
    """Period [s] after which the motion repeats itself, None if it does not within the log.

    The shortest lag at which the velocities of all joints correlate with themselves, over what overlaps
    of the log (half of it at least).

    >>> t = np.arange(0, 20, 0.01)
    >>> log = Log("demo", ("a",), t, np.sin(2 * np.pi * t / 4 + np.sin(2 * np.pi * t / 2))[:, None])
    >>> round(period_of(log), 2)
    4.0
    """
    return repeats_after(log.t, log.q)


def step_of_repeats(t: np.ndarray) -> float:
    """Steps [s] in which the motion at times (T,) is asked whether it repeats itself.

    >>> round(step_of_repeats(np.arange(0.0, 20.0, 0.004)), 6)
    0.004
    """
    return max(float(np.median(np.diff(t))), float(t[-1] - t[0]) / _GRID)


def repeats_after(t: np.ndarray, positions: np.ndarray) -> float | None:
    """The same of positions (T, n) at times (T,)."""
    step = step_of_repeats(t)
    clock = np.arange(t[0], t[-1], step)
    q = np.column_stack([np.interp(clock, t, column) for column in positions.T])
    dq = np.column_stack([velocity(clock, column) for column in q.T])
    size = np.sqrt(np.mean(dq**2, axis=0))
    dq = dq[:, size > 1e-9] / size[size > 1e-9]
    count = len(dq)
    if not dq.shape[1] or count < 8:
        return None
    padded = np.fft.rfft(dq, 2 * count, axis=0)
    product = np.fft.irfft(np.abs(padded) ** 2, 2 * count, axis=0)[:count].sum(axis=1)
    energy = (dq**2).sum(axis=1)
    early, late = np.cumsum(energy)[::-1], np.cumsum(energy[::-1])[::-1]
    same = product / np.maximum(np.sqrt(early * late), 1e-12)
    half = count // 2
    left = np.flatnonzero(same[:half] < 0.5)  # first away from lag zero
    if not len(left):
        return None
    first = max(int(left[0]), int(_SHORTEST / step))
    repeats = np.flatnonzero(same[first:half] > _SAME)
    if not len(repeats):
        return None
    start = first + int(repeats[0])
    end = (
        start + int(np.argmax(same[start:half] < _SAME))
        if (same[start:half] < _SAME).any()
        else half
    )
    return float((start + int(np.argmax(same[start:end]))) * step)
