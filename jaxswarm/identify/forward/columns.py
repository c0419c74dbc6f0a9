r"""The regression matrix of a model: rigid-body columns and the columns of every linear law parameter.

For one working clock, ``tau[t, j] = sum_c W[t, j, c] theta[c]`` with ``theta`` the standard parameters
of all links followed by the linear parameters of the terms in their order. Nonlinear parameters and the
load torque enter as given numbers. Torque and columns then pass the same decimator.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial

import jax
import numpy as np

from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.sample import Sample
from jaxswarm.effects.series import law_columns
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.joint_series import Load, filled_series, load_series
from jaxswarm.identify.forward.latest import Latest, last_of
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.logs.filtering import Decimator
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.resampling import earlier
from jaxswarm.programs import program
from jaxswarm.robot.logged import rigid_columns, rigid_torque
from jaxswarm.robot.model import Robot

# Position, velocity and acceleration along a log, each (T, n).
Moved = tuple[np.ndarray, np.ndarray, np.ndarray]

# Samples whose columns stand in memory at a time where only what follows from them is kept.
_BLOCK = 16_384
# Numbers that the columns of a log and their derivatives by all joints may hold together: a gigabyte, half a
# minute of computing saved. Of a longer log they are made anew, so many samples at a time.
_KEPT = 2**27
# Numbers that decimated columns of laws may hold: of a log of seconds those of some hundred laws, 32 MB.
_OF_LAWS = 2**22


@program("law")
def _law(law: TorqueLaw, nonlinear: dict, series: Sample) -> jax.Array:
    return law_columns(law, nonlinear, series)


def torque_of(
    robot: Robot, q: np.ndarray, dq: np.ndarray, ddq: np.ndarray, pi: np.ndarray
) -> np.ndarray:
    """Rigid-body torque (T, n) for parameters (10 n,), without the columns in between."""
    return rigid_torque(robot.replace(parameters=pi.reshape(-1, 10)), q, dq, ddq)


def low_columns(robot: Robot, moved: Moved, decimator: Decimator, first: int = 0) -> np.ndarray:
    """Decimated rigid columns of the links from one on, (T', n, 10 (n - first)); a part at a time."""
    joints, length = robot.num_joints, len(moved[0])
    low, row = np.empty((len(decimator.kept(length)), joints, 10 * (joints - first))), 0
    for part in decimator.blocks(length, _BLOCK):
        own = decimator.apply(rigid_columns(robot, *(x[part] for x in moved), first=first))
        low[row : row + len(own)] = own
        row += len(own)
    return low


def early_columns(robot: Robot, motion: Motion, decimator: Decimator) -> np.ndarray:
    """Decimated columns (T', n, 10 n) of the weight as its clock tells it, less those of the weight there is.

    Drives go by the weight of the arm that they were told of.
    """
    return _early(motion, lambda moved: low_columns(robot, moved, decimator))


def early_torque(robot: Robot, motion: Motion, pi: np.ndarray) -> np.ndarray:
    """The same as a torque on the working clock, (T, n), for parameters (10 n,)."""
    return _early(motion, lambda moved: torque_of(robot, *moved, pi))


def _early(motion: Motion, along: Callable[[Moved], np.ndarray]) -> np.ndarray:
    rest, told = np.zeros_like(motion.q), earlier(motion.t, motion.q, motion.weight_skew)
    return along((told, rest, rest)) - along((motion.q, rest, rest))


def numbers_of(motion: Motion) -> int:
    """Numbers of a log's columns and their derivatives by all joints."""
    samples, joints = motion.q.shape
    return samples * joints * (10 * joints + 3 * 10 * joints * (joints + 1) // 2)


def is_kept(motion: Motion, every: int = 1) -> bool:
    """Whether the columns and derivatives of a log, or on every few samples, are few enough to be kept."""
    return numbers_of(motion) <= every * _KEPT


@dataclass(frozen=True)
class Rigid:
    """Rigid-body columns of one log, kept because every model on it needs them.

    Those on the working clock, a few hundred times as large as the motion, are made where they are asked
    for; a torque does not ask for those of a long log.

    Attributes:
        robot: What they are made with.
        motion: The log.
        sensed: What :mod:`jaxswarm.identify.forward.sensitivity` found, by joint, of the arm asked for last.
        swayed: What :mod:`jaxswarm.identify.forward.compliance` found about turns of the base.
        loads: The load torque that was asked for last, by its parameters: all laws of a model ask for one.
        moved: Motion of links that lag that was asked for last, by all that it follows from.
        read: What is known of the log as its encoders should have said it, by the errors asked for last.
        laws: Decimated columns of laws by all that they follow from, the oldest first.
        reported: Those of ``low`` as drives write them down that were asked for last, by what says how.
    """

    robot: Robot
    motion: Motion
    sensed: dict = field(default_factory=dict, repr=False, compare=False)
    swayed: dict = field(default_factory=dict, repr=False, compare=False)
    loads: dict = field(default_factory=dict, repr=False, compare=False)
    moved: dict = field(default_factory=dict, repr=False, compare=False)
    read: dict = field(default_factory=dict, repr=False, compare=False)
    laws: Latest = field(default_factory=partial(Latest, _OF_LAWS), repr=False, compare=False)
    reported: dict = field(default_factory=dict, repr=False, compare=False)

    @property
    def gravity(self) -> np.ndarray:
        """What they are made with, (3,)."""
        return np.asarray(self.robot.gravity)

    @cached_property
    def low(self) -> np.ndarray:
        """Through the decimator, shape (T', n, 10 n)."""
        moved = (self.motion.q, self.motion.dq, self.motion.ddq)
        return low_columns(self.robot, moved, self.motion.decimator)

    @cached_property
    def full(self) -> np.ndarray:
        """On the working clock, shape (T, n, 10 n)."""
        return rigid_columns(self.robot, self.motion.q, self.motion.dq, self.motion.ddq)

    @cached_property
    def still(self) -> np.ndarray:
        """The same without acceleration."""
        rest = np.zeros_like(self.motion.ddq)
        return rigid_columns(self.robot, self.motion.q, self.motion.dq, rest)

    @cached_property
    def early(self) -> np.ndarray:
        """What the clock of the weight adds to ``low``; see :func:`early_columns`."""
        return early_columns(self.robot, self.motion, self.motion.decimator)

    def forget(self) -> None:
        """Let go of what is as large as the columns on the working clock; it is made anew where asked for."""
        for name in ("full", "still"):
            vars(self).pop(name, None)
        self.sensed.clear()
        self.swayed.clear()
        self.moved.clear()
        self.read.clear()
        self.reported.clear()

    def torque(self, pi: np.ndarray) -> np.ndarray:
        """Rigid-body torque (T, n) for parameters (10 n,)."""
        if is_kept(self.motion):
            return _times(self.full, pi)
        return torque_of(self.robot, self.motion.q, self.motion.dq, self.motion.ddq, pi)

    def load(self, pi: np.ndarray, joints: Collection[int] | None = None) -> Load:
        """Load torque for rigid parameters (10 n,); of some joints alone, NaN where nobody asked for it."""
        load, known = last_of(self.loads, np.asarray(pi).tobytes(), lambda: self._loads(pi))
        every = range(self.motion.q.shape[1])
        for j in every if joints is None else joints:
            if j not in known:
                # By all columns, zeros too: sums are rounded as those of all joints are.
                load.full[:, j] = self.full[:, j] @ pi
                load.static[:, j] = self.still[:, j] @ pi
                known.add(j)
        return load

    def _loads(self, pi: np.ndarray) -> tuple[Load, set[int]]:
        """The loads that are told at once, a joint in one piece, and the joints of which they are known.

        A fit asks for dozens: the recursion takes ten times as long as the product of all joints' columns, and
        that six times as long as the one of a joint.
        """
        q, dq, ddq = self.motion.q, self.motion.dq, self.motion.ddq
        if not is_kept(self.motion):
            return load_along(self.robot, (q, dq, ddq), pi), set(range(q.shape[1]))
        full, static = np.full((2, *q.shape[::-1]), np.nan)
        return Load(full.T, static.T), set()

    def law(
        self,
        term: Term,
        width: Sequence[float],
        make: Callable[[], np.ndarray],
        reports: tuple,
    ) -> np.ndarray:
        """Decimated columns (T', k) of a term on its joint; made once where they follow from the motion.

        Args:
            term: With its nonlinear parameters.
            width: Width of every joint's smooth sign, (n,).
            make: Makes them.
            reports: How the torque of its joint is written down.
        """
        law = term.law
        if law.uses_load:
            return make()
        bent = tuple(term.values[p.name] for p in law.nonlinear)
        own_width = width[term.index] if law.uses_direction else None
        place = (term.place, term.formula, bent, own_width, reports)
        return self.laws.of(place, make)


def _times(columns: np.ndarray, pi: np.ndarray) -> np.ndarray:
    """Torque (T, n) of columns (T, n, p), in one product: a stack of small ones takes three times as long."""
    return (columns.reshape(-1, columns.shape[2]) @ pi).reshape(columns.shape[:2])


def rigid_of(robot: Robot, motion: Motion) -> Rigid:
    """The rigid-body columns of a log in nominal gravity and motion."""
    return Rigid(robot, motion)


def load_along(arm: Robot, moved: Moved, pi: np.ndarray) -> Load:
    """Load torque along a motion (q, dq, ddq) of the links, for rigid parameters (10 n,)."""
    q, dq, ddq = moved
    rest = torque_of(arm, q, dq, np.zeros_like(ddq), pi)
    return Load(torque_of(arm, q, dq, ddq, pi), rest)


def term_columns(
    term: Term, motion: Motion, width: Sequence[float], load: Load | None = None
) -> np.ndarray:
    """Columns of the linear parameters of a joint or pair term, shape (T, k), on its own joint."""
    series = filled_series(motion, width, term.index, term.other)
    if term.law.uses_load and load is not None:
        series = series._replace(**filled(load_series(load, term.index)))
    return columns_along(term, series)[: len(motion.t)]


def columns_along(term: Term, series: Sample) -> np.ndarray:
    """Columns of a joint or pair term along a series of a length that has a program, :func:`filled`."""
    nonlinear = {p.name: np.float64(term.values[p.name]) for p in term.law.nonlinear}
    return np.asarray(_law(term.law, nonlinear, series))
