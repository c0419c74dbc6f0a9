"""What the rigid torque does when one joint moves otherwise than logged: columns and their derivatives."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from threading import Lock
from typing import NamedTuple

import numpy as np

from jaxswarm.identify.forward.columns import Rigid, is_kept
from jaxswarm.logs.motion import Motion
from jaxswarm.memory import joined
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.model import Robot

# Steps of the differences along position and velocity [rad, rad/s]. The torque is quadratic in velocity,
# so that its step may be any, and linear in acceleration.
_POSITION, _VELOCITY = 1e-5, 1e-2
# Samples of a long log whose columns are made at a time.
BLOCK = 8_192
# Two threads that ask for another arm at once let go of what the log keeps once.
_KEEPING = Lock()


class _Columns(NamedTuple):
    """Rigid columns of a stretch and their derivatives by the motion of one joint, j.

    Links before the joint do not feel it: the derivatives have the columns of the links from it on.

    Attributes:
        full: Rigid columns, (T, n, 10 n).
        by_q, by_dq, by_ddq: Derivatives of the last 10 (n - j) columns by the joint's position,
            velocity and acceleration.
    """

    full: np.ndarray
    by_q: np.ndarray
    by_dq: np.ndarray
    by_ddq: np.ndarray


@dataclass(frozen=True)
class Sensitivity:
    """What the rigid torque of a log does when one joint moves otherwise.

    Attributes:
        robot: Kinematics and gravity.
        motion: The log.
        joint: The joint, j.
        full: Rigid columns where they are known, (T, n, 10 n).
        asked: Torques that were asked for last, by their parameters: many ask for the same.
        thinner: The same on every few samples, by how many, with those samples.
        making: Held while columns are made: two threads that ask for the same make them once.
    """

    robot: Robot
    motion: Motion
    joint: int
    full: np.ndarray | None = None
    asked: dict = field(default_factory=dict, repr=False, compare=False)
    thinner: dict = field(default_factory=dict, repr=False, compare=False)
    making: Lock = field(default_factory=Lock, repr=False, compare=False)

    def at(self, pi: np.ndarray, joints: slice = slice(None)) -> tuple[np.ndarray, ...]:
        """Torque of joints and its three derivatives, (T, n) each, for rigid parameters (10 n,).

        Of several sets of parameters (k, 10 n) they are (T, n, k).
        """
        if is_kept(self.motion):
            return self._torques(self._whole, pi, joints)
        if (
            pi.size > self.robot.parameters.size
        ):  # of many sets a long log's are as large as its columns
            return self._in_parts(pi, joints)
        place = pi.tobytes()
        if place not in self.asked:
            self.asked.clear()
            self.asked[place] = self._in_parts(pi.ravel())
        return tuple(x[:, joints].reshape(len(x), -1, *pi.shape[:-1]) for x in self.asked[place])

    def slopes(self, pi: np.ndarray) -> tuple[np.ndarray, ...]:
        """The three derivatives of :meth:`at`, of all joints."""
        if is_kept(self.motion):
            return self._slopes(self._whole, pi, slice(None))
        return self.at(pi)[1:]

    def during(self, part: slice, pi: np.ndarray, joints: slice = slice(None)) -> tuple:
        """What :meth:`at` gives, of a stretch of the log alone: its columns are made for that."""
        return self._torques(self._columns(part), pi, joints)

    def averaged(
        self, motion: Motion, every: int, mean: Callable[[np.ndarray], np.ndarray]
    ) -> "Sensitivity":
        """The same on every few samples, a motion of its own, by what ``mean`` makes of columns (T, ...).

        A mean reaches to the samples next to it that are given: of a long log some of them are made at a time.
        """
        other, count = Sensitivity(self.robot, motion, self.joint), len(motion.t)
        if is_kept(self.motion):
            made = _Columns(*(mean(x)[:count] for x in self._whole))
        else:
            made = self._averaged_in_parts(count, every, mean)
        vars(other)["_made"] = made
        return other

    def _averaged_in_parts(
        self, count: int, every: int, mean: Callable[[np.ndarray], np.ndarray]
    ) -> _Columns:
        parts: list[_Columns] = []
        for first in range(0, count, BLOCK // every):
            last, before = min(count, first + BLOCK // every), min(first, 1)
            whole = self._columns(slice((first - before) * every, last * every))
            parts.append(_Columns(*(mean(x)[before : last - first + before] for x in whole)))
        return _Columns(*(joined(list(own), axis=0) for own in zip(*parts, strict=True)))

    def inertia(self, pi: np.ndarray) -> np.ndarray:
        """The joint's own inertia along the log, (T,)."""
        if is_kept(self.motion):
            return self._whole.by_ddq[:, self.joint] @ pi[10 * self.joint :]
        return self.at(pi)[3][:, self.joint]

    def own(self) -> np.ndarray:
        """The joint's own row of columns and derivatives, of the links from it on, (4, T, 10 (n - j))."""
        (count, joints), first = self.motion.q.shape, 10 * self.joint
        rows = np.zeros((4, count, 10 * joints - first))
        for part, columns in self._parts():
            rows[0, part] = columns.full[:, self.joint, first:]
            for row, slope in zip(rows[1:], columns[1:], strict=True):
                row[part] = slope[:, self.joint]
        return rows

    @property
    def _whole(self) -> _Columns:
        with self.making:
            return self._made

    @cached_property
    def _made(self) -> _Columns:
        return self._columns(slice(None), self.full)

    def _parts(self) -> Iterator[tuple[slice, _Columns]]:
        """Stretches of the log with their columns."""
        if is_kept(self.motion):
            yield slice(None), self._whole
            return
        for start in range(0, len(self.motion.t), BLOCK):
            part = slice(start, start + BLOCK)
            yield part, self._columns(part)

    def _torques(self, columns: _Columns, pi: np.ndarray, joints: slice) -> tuple[np.ndarray, ...]:
        return (_times(columns.full, pi.T, joints), *self._slopes(columns, pi, joints))

    def _slopes(self, columns: _Columns, pi: np.ndarray, joints: slice) -> tuple[np.ndarray, ...]:
        felt = pi[..., 10 * self.joint :].T
        return tuple(_times(slope, felt, joints) for slope in columns[1:])

    def _in_parts(self, pi: np.ndarray, joints: slice = slice(None)) -> tuple[np.ndarray, ...]:
        shape = (*self.motion.q[:, joints].shape, *pi.shape[:-1])
        found = tuple(np.empty(shape) for _ in _Columns._fields)
        for part, columns in self._parts():
            for x, own in zip(found, self._torques(columns, pi, joints), strict=True):
                x[part] = own
        return found

    def _columns(self, part: slice, full: np.ndarray | None = None) -> _Columns:
        motion, joint = self.motion, self.joint
        here = (motion.q[part], motion.dq[part], motion.ddq[part])
        full = rigid_columns(self.robot, *here) if full is None else full

        def moved(argument: int, step: float) -> np.ndarray:
            there = list(here)
            there[argument] = here[argument] + step * (np.arange(self.robot.num_joints) == joint)
            return rigid_columns(self.robot, *there, first=joint)

        def central(argument: int, step: float) -> np.ndarray:
            return (moved(argument, step) - moved(argument, -step)) / (2.0 * step)

        by_ddq = moved(2, 1.0) - full[:, :, 10 * joint :]
        return _Columns(full, central(0, _POSITION), central(1, _VELOCITY), by_ddq)


def _times(columns: np.ndarray, values: np.ndarray, joints: slice) -> np.ndarray:
    """Columns (T, n, p) of some joints times values (p,) or (p, k), in one product.

    A stack of small ones takes up to ten times as long.
    """
    some = range(columns.shape[1])[joints]
    if len(some) == 1:
        return (columns[:, some[0]] @ values)[:, None]
    own = columns[:, joints]
    return (own.reshape(-1, own.shape[2]) @ values).reshape(*own.shape[:2], *values.shape[1:])


def sensitivity_of(
    robot: Robot, motion: Motion, joint: int, rigid: Rigid | None = None
) -> Sensitivity:
    """Differences of the rigid columns along one joint's motion.

    They follow from the motion, gravity and placements alone: found once for every log and arm, whatever else
    is fitted to it.

    Args:
        robot: Kinematics and gravity.
        motion: The log.
        joint: The joint.
        rigid: The log's rigid columns where they are known; it keeps what is found here.
    """
    if rigid is None:
        return Sensitivity(robot, motion, joint)
    with _KEEPING:
        return _kept(rigid, robot, motion, joint)


def _kept(rigid: Rigid, robot: Robot, motion: Motion, joint: int) -> Sensitivity:
    """What a log keeps of an arm; of the one that was asked for last.

    An arm whose base is tilted, or one of whose links stands otherwise, is not the one that the columns were
    made with. Made anew for everyone who asked, what it feels took a third of a diagnosis of seven joints.
    """
    kept = rigid.sensed
    one = next(iter(kept.values()), None)
    if one is not None and not _same_arm(robot, one.robot):
        kept.clear()
    if joint not in kept:
        if not is_kept(motion):  # of a long log the torques of one joint are enough
            for other in kept.values():
                other.asked.clear()
        kept[joint] = Sensitivity(robot, motion, joint, _full(rigid, robot, motion))
    return kept[joint]


def _full(rigid: Rigid, robot: Robot, motion: Motion) -> np.ndarray | None:
    """Rigid columns of an arm where they are known: the log's own, or those that another joint has made."""
    if not is_kept(motion):
        return None
    if _same_arm(robot, rigid.robot):
        return rigid.full
    made = (vars(own).get("_made") for own in rigid.sensed.values())
    return next((columns.full for columns in made if columns is not None), None)


def _same_arm(one: Robot, other: Robot) -> bool:
    """Whether two arms have the same gravity and geometry."""
    names = ("gravity", "translation", "rotation")
    return all(np.array_equal(getattr(one, n), getattr(other, n)) for n in names)
