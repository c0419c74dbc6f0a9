"""Columns of the rough model of a log, and the line that is strongest in what it leaves."""

from typing import NamedTuple

import numpy as np

from jaxswarm.identify.checks.bristles import bristles
from jaxswarm.identify.checks.samples import Samples
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.model import Robot

# Width of the smooth sign as a part of the RMS speed: between the sharpest and the widest of real joints; and
# those beside it of a fine model, which follow any of them and a friction that falls with speed.
_WIDTH, _FINE_WIDTHS = 0.03, (0.003, 0.01, 0.3)
# A joint that moves by less than this part of its RMS speed may stick, or does so nearby: of what four drives
# that wind up made look 7 to 20 ms early, 40 to 90 % is left without the rows below 0.03, 1 to 20 % below 0.2.
_STUCK = 0.2
# Frequencies that are tried, as parts of what a log's length tells apart; and how many at a time.
_STEP, _AT_ONCE = 0.2, 256
# A line has this part of a period in the log at least: what is slower is a drift.
_LEAST_PERIODS = 0.5
# Degree up to which a torque may go by a position: a stop at the end of the way has less.
_DEGREE = 8


class Wave(NamedTuple):
    """A line of a frequency on a joint, from 0."""

    joint: int
    hertz: float


class Place(NamedTuple):
    """The way of a joint, from 0, along which a torque may be any function of its position."""

    joint: int


class Columns(NamedTuple):
    """What the torques of a log are fitted by, row by row.

    Attributes:
        rigid: The links' (R, n, p).
        own: Of every joint viscous and dry friction, offset, spring and rotor, (R, n, k).
        memory: What else looks like a delay: bristles, and what a joint is asked beside, (R, n, e).
        dry: How many columns of dry friction a joint has, among them in a fine model drag, which is one at the
            usual speed.
    """

    rigid: np.ndarray
    own: np.ndarray
    memory: np.ndarray
    dry: int

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Columns of the links, and of each joint its own and its memory's."""
        return self.rigid.shape[2], self.own.shape[2], self.memory.shape[2]


def columns_of(
    robot: Robot, samples: Samples, speed: np.ndarray, beside: Wave | Place | None
) -> Columns:
    """The columns of a log.

    Args:
        robot: Kinematics.
        samples: Motion and torque.
        speed: RMS speed of the joints [rad/s or m/s], (n,).
        beside: What is to be taken off a joint: a line, or what goes by its position; None: nothing.
    """
    remembered = bristles(samples.q)
    widths = _WIDTH, *(_FINE_WIDTHS if samples.parts else ())
    dry_ones = len(widths) + bool(samples.parts)

    def rigid_of(part: slice) -> np.ndarray:
        return rigid_columns(robot, samples.q[part], samples.dq[part], samples.ddq[part])

    def laws_of(part: slice) -> np.ndarray:
        q, dq = samples.q[part], samples.dq[part]
        dry = [np.tanh(dq / np.maximum(width * speed, 1e-9)) for width in widths]
        if samples.parts:
            # An undeclared drag of one joint made another's torque look 6.5 ms late, and its log was refused.
            dry.append(dq * np.abs(dq) / np.maximum(speed, 1e-9) ** 2)
        return np.stack([dq, *dry, np.ones_like(dq), q, samples.ddq[part]], axis=2)

    memory = samples.rows(lambda part: remembered[part])
    if beside is not None:
        told = _line(samples, beside) if isinstance(beside, Wave) else _along(samples, beside)
        own = np.zeros((*memory.shape[:2], told.shape[1]))
        own[:, beside.joint] = told
        memory = np.concatenate([memory, own], axis=2)
    return Columns(samples.rows(rigid_of), samples.rows(laws_of), memory, dry_ones)


def _line(samples: Samples, wave: Wave) -> np.ndarray:
    """Sine and cosine of a line, (R, 2)."""
    return _sine_and_cosine(samples.t, np.array([wave.hertz]))[:, 0].T


def _along(samples: Samples, place: Place) -> np.ndarray:
    """Functions of a joint's position beside an offset and a spring, (R, m)."""
    q = _of_joint(samples, samples.q, place.joint)
    from_middle = (q - 0.5 * (q.max() + q.min())) / max(0.5 * np.ptp(q), 1e-300)
    return np.polynomial.legendre.legvander(from_middle, _DEGREE)[:, 2:]


def slow_rows(samples: Samples, joint: int, speed: float) -> np.ndarray:
    """Whether a joint of an RMS speed hardly moves on the rows, (R,): there it may stick."""
    return np.abs(_of_joint(samples, samples.dq, joint)) < _STUCK * speed


def _of_joint(samples: Samples, signal: np.ndarray, joint: int) -> np.ndarray:
    """A joint's part of a signal (T, n), row by row, (R,)."""
    return samples.rows(lambda part: signal[part, joint, None, None])[:, 0, 0]


def strongest_line(t: np.ndarray, values: np.ndarray) -> float:
    """Frequency [Hz] of the sine that takes most off what a model leaves.

    Args:
        t: Times of the rows [s], (R,), with gaps where the log has some.
        values: What is left of them, (R,).

    >>> t = 0.02 * np.arange(500)
    >>> abs(strongest_line(t, np.sin(2 * np.pi * 2.53 * t + 1.0)) - 2.53) < 0.02
    True
    """
    step = _STEP / np.ptp(t)
    hertz = np.arange(_LEAST_PERIODS / _STEP, 0.5 / np.median(np.diff(t)) / step) * step
    power = []
    for some in np.array_split(hertz, len(hertz) // _AT_ONCE + 1):
        power.append(np.square(_sine_and_cosine(t, some) @ values).sum(axis=0))
    return float(hertz[np.argmax(np.concatenate(power))])


def _sine_and_cosine(t: np.ndarray, hertz: np.ndarray) -> np.ndarray:
    """Of each frequency, at each time: (2, F, R)."""
    angle = 2 * np.pi * np.outer(hertz, t)
    return np.stack([np.sin(angle), np.cos(angle)])
