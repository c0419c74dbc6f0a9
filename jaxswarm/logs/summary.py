"""What was read, in numbers: the clock, and for each joint how far it was moved, loaded and seen.

Coverage decides what can be identified at all: a joint that never moves has no friction to see, one
that never reverses cannot tell Coulomb friction from an offset. The words for it are in
:mod:`jaxswarm.logs.findings`.
"""

from collections import deque
from dataclasses import asdict, dataclass
from typing import NamedTuple
from weakref import ref

import numpy as np

from jaxswarm.logs.clipping import clipped
from jaxswarm.logs.log import Log
from jaxswarm.logs.quality import (
    held_share,
    longest_stuck,
    quantum,
    reversals,
    slowest_motion,
    velocity,
)
from jaxswarm.logs.sampling import Sampling, sampling

# A joint that stays within this range [rad or m], or within four quanta, only trembles.
_LEAST_RANGE = 1e-3
_LEAST_QUANTA = 4.0


@dataclass(frozen=True)
class JointSummary:
    """Coverage and quality of one joint.

    Attributes:
        name: Joint name.
        position_min, position_max: Range of q [rad or m].
        moves: Whether the joint moves at all.
        speed_max: Largest speed [rad/s or m/s], over 20 ms where no velocity was logged.
        moving_share: Share of samples in which the joint moves.
        reversals: Changes of direction.
        torque_min, torque_max: Range of tau [N m or N], None without torque.
        position_quantum, torque_quantum: Step of the quantized signal, 0 if none is visible, None
            without torque.
        saturated: Samples in which the torque sits at its largest or smallest value while the
            robot moves.
        stuck: Longest stretch of samples with one value of torque while the joint moves, if 10 or
            more.
        wraps: Steps of a full turn between two samples (an angle that was wrapped).
        velocity_ratio: Logged velocity by differentiated position (least squares), None if not
            logged or the two do not resemble each other.
    """

    name: str
    position_min: float
    position_max: float
    moves: bool
    speed_max: float
    moving_share: float
    reversals: int
    torque_min: float | None
    torque_max: float | None
    position_quantum: float
    torque_quantum: float | None
    saturated: int
    stuck: int
    wraps: int
    velocity_ratio: float | None


@dataclass(frozen=True)
class LogSummary:
    """What was read.

    Attributes:
        source: File name.
        samples: Number of samples.
        duration: Last minus first time stamp [s].
        sampling: The clock.
        moving_share: Share of samples in which any joint moves.
        held_share: Share of samples whose positions and torques all repeat the sample before, apart
            from long rests.
        joints: Coverage and quality of each joint.
    """

    source: str
    samples: int
    duration: float
    sampling: Sampling
    moving_share: float
    held_share: float
    joints: tuple[JointSummary, ...]

    @property
    def still_joints(self) -> tuple[str, ...]:
        """Names of the joints that never move."""
        return tuple(joint.name for joint in self.joints if not joint.moves)

    def to_dict(self) -> dict:
        """Plain dictionaries, lists and numbers, ready for JSON."""
        return asdict(self)


class _Known(NamedTuple):
    """A summary with the arrays it was made of, which it does not keep alive."""

    arrays: tuple[ref | None, ...]
    summary: LogSummary

    def of(self, log: Log) -> bool:
        """Whether it is that of a log."""
        same = zip(self.arrays, _looked_at(log), strict=True)
        summary = self.summary
        named = summary.source == log.source
        named &= tuple(joint.name for joint in summary.joints) == log.joints
        return named and all((None if a is None else a()) is b for a, b in same)


# A log is summarized where it is read, checked and told; of ten million samples that takes a minute each time.
_known: deque[_Known] = deque(maxlen=8)


def _looked_at(log: Log) -> tuple[np.ndarray | None, ...]:
    """What a summary follows from."""
    return log.t, log.q, log.dq, log.tau


def summarize(log: Log) -> LogSummary:
    """Summarize a log in numbers; the arrays of a log are not changed, so that they are looked at once.

    Args:
        log: A checked log of at least two samples.

    Returns:
        Clock, coverage and quality.

    >>> t = np.arange(500) * 0.01
    >>> log = Log("demo", ("joint1",), t, np.sin(t)[:, None])
    >>> found = summarize(log)
    >>> round(found.sampling.rate), found.joints[0].reversals, found.still_joints
    (100, 2, ())
    """
    for known in tuple(_known):  # another thread may add one
        if known.of(log):
            return known.summary
    found = _summarized(log)
    arrays = tuple(None if x is None else ref(x) for x in _looked_at(log))
    _known.append(_Known(arrays, found))
    return found


def _summarized(log: Log) -> LogSummary:
    columns = range(len(log.joints))
    steps = [quantum(log.q[:, k]) for k in columns]
    moves = [
        bool(np.ptp(log.q[:, k]) > max(_LEAST_RANGE, _LEAST_QUANTA * steps[k])) for k in columns
    ]
    derived = [velocity(log.t, log.q[:, k]) for k in columns]
    threshold = [slowest_motion(log.t, log.q[:, k], np.abs(derived[k]), steps[k]) for k in columns]
    moving = np.stack([moves[k] & (np.abs(derived[k]) > threshold[k]) for k in columns], axis=1)
    any_moves = np.asarray(moving.any(axis=1))
    joints = []
    for k, name in enumerate(log.joints):
        tau = None if log.tau is None else log.tau[:, k]
        torque_step = None if tau is None else quantum(tau)
        least_motion = max(_LEAST_RANGE, 10 * steps[k])
        stuck = 0 if tau is None or not moves[k] else longest_stuck(tau, log.q[:, k], least_motion)
        joints.append(
            JointSummary(
                name=name,
                position_min=float(log.q[:, k].min()),
                position_max=float(log.q[:, k].max()),
                moves=moves[k],
                speed_max=float(np.abs(derived[k] if log.dq is None else log.dq[:, k]).max()),
                moving_share=float(np.mean(moving[:, k])),
                reversals=reversals(derived[k], threshold[k]) if moves[k] else 0,
                torque_min=None if tau is None else float(tau.min()),
                torque_max=None if tau is None else float(tau.max()),
                position_quantum=steps[k],
                torque_quantum=torque_step,
                saturated=0 if tau is None else int(clipped(tau, moving[:, k]).sum()),
                stuck=stuck if stuck >= 10 else 0,
                wraps=int(np.sum(np.abs(np.abs(np.diff(log.q[:, k])) - 2 * np.pi) < 0.5)),
                velocity_ratio=None if log.dq is None else _ratio(log.dq[:, k], derived[k]),
            )
        )
    return LogSummary(
        source=log.source,
        samples=len(log.t),
        duration=float(log.t[-1] - log.t[0]),
        sampling=sampling(log.t, log.q),
        moving_share=float(np.mean(any_moves)),
        held_share=held_share(*(x for x in (log.q, log.tau) if x is not None)),
        joints=tuple(joints),
    )


def _ratio(logged: np.ndarray, derived: np.ndarray) -> float | None:
    """Slope of logged over derived velocity, if one explains at least 80 % of the other."""
    power, cross = float(derived @ derived), float(derived @ logged)
    own = float(logged @ logged)
    if power == 0.0 or own == 0.0 or cross**2 < 0.8 * power * own:
        return None
    return cross / power
