r"""How good a signal is, in numbers: its quantum and noise, stuck values, motion.

Each function looks at one channel of one joint. The noise of a position is taken from its third
differences, in which smooth motion vanishes: white noise of standard deviation :math:`\sigma`
gives third differences of :math:`\sqrt{20}\,\sigma`.
"""

import numpy as np

from jaxswarm.logs.filtering import white_noise
from jaxswarm.logs.runs import runs
from jaxswarm.logs.sampling import usual_period

# Steps below these shares of the largest value are digits of the number format, not of a sensor.
_SINGLE_DIGITS = 4e-7
_DOUBLE_DIGITS = 1e-13
# Fewest distances that can show a grid, and share of unchanged samples that tells of coarse values.
_LEAST_STEPS = 10
_LEAST_SAMPLES = 20
_REPEATS = 0.02
# Velocity is taken over about this time [s], so that noise and quanta average out.
_VELOCITY_WINDOW = 0.02
# A joint moves when it is faster than this share of its own top speed.
_MOVING_SHARE = 0.01
# More samples in a row than this without any change are a robot at rest, not a slow source.
_LONGEST_HOLD = 20


def quantum(values: np.ndarray) -> float:
    """Estimate the step of a quantized signal; 0 if none is visible.

    If the distances between distinct values are multiples of the smallest one, that is the step.
    If they are not (digits cut off at a fixed number, mixed by a transmission) but values repeat
    from sample to sample, the step is the size of the smallest changes.

    Args:
        values: Signal, shape (T,), finite.

    >>> round(quantum(np.round(np.sin(np.arange(1000.0)), 3)), 6)
    0.001
    >>> quantum(np.sin(np.arange(1000.0)))
    0.0
    """
    if len(values) < _LEAST_SAMPLES:
        return 0.0
    size = float(np.max(np.abs(values)))
    stored_single = bool(np.all(values == values.astype(np.float32)))
    digits = (_SINGLE_DIGITS if stored_single else _DOUBLE_DIGITS) * size
    distinct = np.unique(values)
    steps = np.diff(distinct)
    steps = steps[steps > digits]
    if len(steps) < 2:
        return float(steps[0]) if len(steps) else 0.0
    step = float(np.mean(steps[steps < 1.5 * steps.min()]))
    # Beyond some hundred steps the error of the step itself blurs what is a multiple.
    multiples = steps[steps < 100 * step] / step
    on_grid = np.abs(multiples - np.round(multiples)) < 0.1
    if len(multiples) >= max(_LEAST_STEPS, 0.1 * len(steps)) and np.mean(on_grid) > 0.95:
        return step
    changes = np.abs(np.diff(values))
    repeats = float(np.mean(changes <= digits))
    if repeats < _REPEATS or len(distinct) > 0.9 * len(values):
        return 0.0
    return float(np.quantile(changes[changes > digits], 0.05))


def velocity(time: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Differentiate a position over a short window, for telling motion from standstill only.

    Args:
        time: Time stamps [s], shape (T,), increasing.
        position: Position, shape (T,).

    Returns:
        Velocity, shape (T,); over one-sided windows at the ends.
    """
    half = _half_window(time)
    index = np.arange(len(time))
    after, before = np.minimum(index + half, len(time) - 1), np.maximum(index - half, 0)
    return (position[after] - position[before]) / (time[after] - time[before])


def slowest_motion(time: np.ndarray, position: np.ndarray, speed: np.ndarray, step: float) -> float:
    """Speed above which a joint moves rather than being still: a share of its own, or its noise.

    Args:
        time: Time stamps [s], shape (T,).
        position: Position, shape (T,).
        speed: Absolute velocity, shape (T,).
        step: Quantum of the position, 0 if none.
    """
    window = 2 * _half_window(time) * usual_period(time)
    # Smooth motion counts least at the short lag, values held by a slow source at the long one.
    noise = min(_noise(position), _noise(position[:: 2 * _half_window(time)]))
    return max(
        _MOVING_SHARE * float(np.quantile(speed, 0.995)), 5.0 * noise / window, 1.5 * step / window
    )


def _noise(values: np.ndarray) -> float:
    return float(white_noise(values[:, None])[0]) if len(values) > 3 else 0.0


def reversals(speed: np.ndarray, threshold: float) -> int:
    """Count changes of direction, between speeds beyond ``threshold`` on either side.

    >>> reversals(np.array([1.0, 0.1, -0.1, 0.1, 1.0, -1.0, -1.0, 1.0]), 0.5)
    2
    """
    signs = np.sign(speed[np.abs(speed) > threshold])
    return int(np.sum(signs[1:] != signs[:-1]))


def longest_run(mask: np.ndarray) -> int:
    """Length of the longest stretch of True.

    >>> longest_run(np.array([True, False, True, True]))
    2
    """
    starts, ends = runs(mask)
    return int(np.max(ends - starts, initial=0))


def held_share(*signals: np.ndarray) -> float:
    """Share of samples that repeat the one before in every column, apart from long rests.

    Args:
        signals: Each of shape (T, k).

    >>> round(held_share(np.repeat(np.arange(100.0), 4)[:, None]), 2)
    0.75
    """
    same = np.ones(len(signals[0]) - 1, dtype=bool)
    for column in (column for values in signals for column in values.T):
        same &= column[1:] == column[:-1]
    held = np.concatenate([[0], same, [0]]).astype(np.int8)
    edges = np.flatnonzero(np.diff(held))
    lengths = edges[1::2] - edges[::2]
    short = int(np.sum(lengths[lengths <= _LONGEST_HOLD]))
    rest = int(np.sum(lengths[lengths > _LONGEST_HOLD]))
    return short / max(len(signals[0]) - rest, 1)


def longest_stuck(values: np.ndarray, position: np.ndarray, least_motion: float) -> int:
    """Longest stretch of samples with one value while the position moves by ``least_motion`` or
    more.

    >>> longest_stuck(np.array([1.0, 2.0, 2.0, 2.0, 3.0]), np.arange(5.0), 1.5)
    3
    """
    changes = np.flatnonzero(np.diff(values) != 0) + 1
    starts = np.concatenate([[0], changes])
    ends = np.concatenate([changes, [len(values)]])
    moved = np.abs(position[ends - 1] - position[starts]) >= least_motion
    lengths = np.where(moved, ends - starts, 0)
    return int(lengths.max())


def _half_window(time: np.ndarray) -> int:
    period = usual_period(time)
    return int(np.clip(round(0.5 * _VELOCITY_WINDOW / period), 1, max(1, (len(time) - 1) // 2)))
