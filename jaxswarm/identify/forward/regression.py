"""The linear problem of one model on one or several logs: decimated columns and torque, with their clock."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.body import arm_of
from jaxswarm.identify.forward.columns import Rigid
from jaxswarm.identify.forward.event_rows import event_columns
from jaxswarm.identify.forward.finite_columns import check_finite, check_rows
from jaxswarm.identify.forward.link_lag import as_read, lag_slopes, slope_terms
from jaxswarm.identify.forward.load_slopes import load_slopes, loaded
from jaxswarm.identify.forward.measuring_chain import assemble
from jaxswarm.identify.forward.metrics import is_moving
from jaxswarm.identify.forward.names import column_names
from jaxswarm.identify.forward.row_shares import row_shares
from jaxswarm.identify.forward.written_down import report
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot


@dataclass(frozen=True)
class Regression:
    """Rows of all logs on the decimated clock.

    Attributes:
        names: Column names, p of them.
        columns: Shape (T, n, p): derivatives of the model's torque by the parameters.
        torque: Measured torque through the same low-pass, shape (T, n).
        moving: Whether the joint moves there, shape (T, n).
        t: Time in its own log [s], shape (T,).
        log: Index of the log each row comes from, shape (T,).
        step: Sampling interval of the decimated clock [s], one per log.
        shift: ``columns @ theta`` minus the model's torque where the columns were made, (T, n),
            where a soft joint or a load makes the torque nonlinear in the rigid parameters; None: zero.
        share: How much of a joint's row counts, (T, n): columns, torque and shift are multiplied by it. It is
            zero where the row is not used. None: all rows count whole.
        prior: Rows whose products with the rigid parameters, the first columns', are taken to be about zero, to
            one each, (r, 10 n); None: none.
    """

    names: tuple[str, ...]
    columns: np.ndarray
    torque: np.ndarray
    moving: np.ndarray
    t: np.ndarray
    log: np.ndarray
    step: tuple[float, ...]
    shift: np.ndarray | None = None
    share: np.ndarray | None = None
    prior: np.ndarray | None = None

    @property
    def target(self) -> np.ndarray:
        """What ``columns @ theta`` has to meet, (T, n)."""
        return self.torque if self.shift is None else self.torque + self.shift

    @property
    def used_rows(self) -> np.ndarray:
        """Whether a joint's row is used, (T, n), also where all are."""
        return np.ones(self.torque.shape, bool) if self.share is None else self.share > 0.0

    @property
    def whole_rows(self) -> np.ndarray:
        """Whether a joint's row counts whole, (T, n)."""
        return self.shares == 1.0

    @property
    def shares(self) -> np.ndarray:
        """How much of a joint's row counts, (T, n), also where all of every one does."""
        return np.ones(self.torque.shape) if self.share is None else self.share

    @property
    def rows_counted(self) -> np.ndarray:
        """How many whole rows of every joint are used, (n,)."""
        rows = np.ones(self.torque.shape) if self.share is None else self.share
        return (rows**2).sum(axis=0)

    def counted(self, values: np.ndarray, out: np.ndarray | None = None) -> np.ndarray:
        """Values of all rows, (T, n) or (T, n, k), each by how much of it counts, into ``out`` if given."""
        if self.share is None:
            return values
        share = self.share.reshape(self.share.shape + (1,) * (values.ndim - 2))
        return np.multiply(values, share, out=out)

    def rms(self, values: np.ndarray) -> np.ndarray:
        """Root mean square (n,) of values (T, n) that are :meth:`counted`."""
        used = np.where(self.used_rows, values, 0.0)
        return np.sqrt((used**2).sum(axis=0) / np.maximum(self.rows_counted, 1.0))

    def rows(self, selected: np.ndarray) -> "Regression":
        """The same problem on the selected rows."""
        return Regression(
            self.names,
            self.columns[selected],
            self.torque[selected],
            self.moving[selected],
            self.t[selected],
            self.log[selected],
            self.step,
            None if self.shift is None else self.shift[selected],
            None if self.share is None else self.share[selected],
            self.prior,
        )


def build_regression(
    robot: Robot,
    terms: tuple[Term, ...],
    motions: Sequence[Motion],
    width: Sequence[float],
    pi: np.ndarray | None = None,
    rigids: Sequence[Rigid] | None = None,
    prior: np.ndarray | None = None,
) -> Regression:
    """Stack the decimated rows of all logs.

    Args:
        robot: Kinematics.
        terms: With values of their nonlinear parameters.
        motions: Prepared logs with torque.
        width: Width of every joint's smooth sign, (n,).
        pi: Rigid parameters for loads and soft joints, (10 n,); None: zeros.
        rigids: Rigid columns of the logs where known.
        prior: What is known of the rigid parameters before, as :attr:`Regression.prior`.

    Raises:
        InputError: If there are fewer rows than columns to determine.
        Diverged: If a column is not finite, or too large to be squared.
    """
    pi = np.zeros(10 * robot.num_joints) if pi is None else pi
    columns, torque, moving, clock, log, share = [], [], [], [], [], []
    for k, motion in enumerate(motions):
        rigid = None if rigids is None else rigids[k]
        columns.append(assemble(robot, terms, motion, width, pi, rigid, decimate=True, log=k))
        check_finite(columns[-1], terms, motion)
        kept = motion.decimator.kept(len(motion.t))
        torque.append(motion.low_torque)
        moving.append(is_moving(motion.dq)[kept])
        clock.append(motion.t[kept])
        log.append(np.full(len(kept), k))
        share.append(row_shares(terms, motion, k))
    every = np.concatenate(share)
    stacked = columns.pop() if len(columns) == 1 else np.concatenate(columns)
    stacked[:, :, event_columns(robot, terms)] = 0.0
    check_rows(stacked, motions[0].source)
    whole = np.all(every == 1.0) and not any(t.law.recurring for t in terms)
    plain = Regression(
        column_names(robot, terms),
        stacked,
        np.concatenate(torque),
        np.concatenate(moving),
        np.concatenate(clock),
        np.concatenate(log),
        tuple(float(m.decimator.factor / m.rate) for m in motions),
        share=None if whole else every,
        prior=prior,
    )
    for held in (plain.columns, plain.torque):
        plain.counted(held, out=held)
    return _with_slopes(plain, robot, terms, motions, width, pi, rigids)


def _with_slopes(
    plain: Regression,
    robot: Robot,
    terms: tuple[Term, ...],
    motions: Sequence[Motion],
    width: Sequence[float],
    pi: np.ndarray,
    rigids: Sequence[Rigid] | None,
) -> Regression:
    """Rows with what their torque owes to lags and loads; columns are written anew in place.

    Raises:
        Diverged: If a column is not finite, or too large to be squared.
    """
    if not slope_terms(terms) and not any(loaded(t) for t in terms):
        return plain
    shift, events = np.zeros(plain.torque.shape), event_columns(robot, terms)
    for k, motion in enumerate(motions):
        rigid = None if rigids is None else rigids[k]
        bent = _slopes(robot, terms, motion, width, pi, rigid, k)
        rows = slice(*np.searchsorted(plain.log, [k, k + 1]))
        known = [t.values.get(n, 0.0) for t in terms for n in t.linear_names(motion.joints)]
        shift[rows] = bent @ np.concatenate([pi, known])
        if plain.share is not None:
            bent *= plain.share[rows, :, None]
        bent[:, :, events] = 0.0
        plain.columns[rows] += bent
        check_finite(plain.columns[rows], terms, motion)
    return replace(plain, shift=plain.counted(shift))


def _slopes(
    robot: Robot,
    terms: tuple[Term, ...],
    motion: Motion,
    width: Sequence[float],
    pi: np.ndarray,
    rigid: Rigid | None,
    log: int,
) -> np.ndarray:
    """What the torque of a log owes to the linear parameters by way of lags and loads, (T', n, p)."""
    parts = []
    if slope_terms(terms):
        true, known = as_read(terms, motion, rigid)
        slopes = lag_slopes(arm_of(robot, terms), terms, true, pi, known)
        rigid_part = motion.decimator.apply(report(terms, motion, slopes))
        others = sum(len(t.columns(robot.joints)) for t in terms)
        before = len(pi) - rigid_part.shape[2]
        parts.append(np.pad(rigid_part, ((0, 0), (0, 0), (before, others))))
    if any(loaded(t) for t in terms):
        parts.append(load_slopes(robot, terms, motion, width, pi, rigid, log))
    return sum(parts[1:], parts[0])
