"""The rigid body of a model along a log: in which gravity its links move, and how."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

import jax
import numpy as np

from jaxswarm.effects.kinds import BodyChange, TransmissionLaw
from jaxswarm.effects.placement import moved_joint, own_moves
from jaxswarm.effects.term import Term, of_kind, valued
from jaxswarm.identify.forward.columns import (
    Moved,
    Rigid,
    is_kept,
    load_along,
    low_columns,
    torque_of,
)
from jaxswarm.identify.forward.joint_series import Load
from jaxswarm.identify.forward.latest import last_of
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.identify.forward.link_lag import as_read, link_motion
from jaxswarm.logs.motion import Motion
from jaxswarm.programs import program
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.model import Robot


def arm_of(robot: Robot, terms: tuple[Term, ...]) -> Robot:
    """The robot in the gravity and with its joints where its terms say."""
    for term in of_kind(terms, BodyChange):
        if term.law.gravity is not None:
            values = {name: np.float64(value) for name, value in term.values.items()}
            robot = robot.replace(gravity=_gravity(term.law, values, robot.gravity))
        if term.law.placement is not None:
            # A turn that is told as the parent's wrong zero is none of the joint's.
            moves = own_moves(robot, term.index) * np.asarray(term.law.placement(term.values))
            robot = moved_joint(robot, term.index, moves)
    return robot


@program("law")
def _gravity(law: BodyChange, values: dict, gravity: jax.Array) -> jax.Array:
    assert law.gravity is not None
    return law.gravity(values, gravity)


def moves_links(terms: tuple[Term, ...]) -> bool:
    """Whether a term changes the rigid columns themselves."""
    return any(t.law.changes_rigid_columns for t in terms)


@dataclass(frozen=True)
class Body:
    """A rigid body on its way. Its columns are made where they are asked for, and then kept.

    Attributes:
        arm: The robot in its gravity, with its joints where they are.
        moved: Motion of the links, q, dq, ddq, each (T, n).
        motion: The log, with what its encoders say too much taken off.
        pi: Rigid parameters, (10 n,).
        rigid: What is known of the log's columns where the links do as it says; else None.
        laws: What is known of columns of laws where the motors do as the log says; else None.
        unmoved: How many links, the first ones, do as the log says, in its gravity.
    """

    arm: Robot
    moved: Moved
    motion: Motion
    pi: np.ndarray
    rigid: Rigid | None
    laws: Rigid | None
    unmoved: int = 0

    @cached_property
    def columns(self) -> np.ndarray:
        """On the working clock, (T, n, 10 n)."""
        return rigid_columns(self.arm, *self.moved) if self.rigid is None else self.rigid.full

    @property
    def last(self) -> np.ndarray:
        """Those of the last link, (T, n, 10)."""
        if self.rigid is not None and is_kept(self.motion):
            return self.columns[:, :, -10:]
        return rigid_columns(self.arm, *self.moved, first=self.arm.num_joints - 1)

    @property
    def low(self) -> np.ndarray:
        """Through the decimator, (T', n, 10 n)."""
        if self.rigid is not None:
            return self.rigid.low
        moved = low_columns(self.arm, self.moved, self.motion.decimator, self.unmoved)
        if self.laws is None or not self.unmoved:
            return moved
        # A link lags by itself and those that it carries: what comes before it is known.
        return np.concatenate([self.laws.low[:, :, : 10 * self.unmoved], moved], axis=2)

    def torque(self, pi: np.ndarray) -> np.ndarray:
        """Torque (T, n) for rigid parameters (10 n,), its own or others."""
        if self.rigid is not None:
            return self.rigid.torque(pi)
        return torque_of(self.arm, *self.moved, pi)

    def load(self, joints: Collection[int] | None = None) -> Load:
        """Load torque of its own parameters; those of other joints than some may be NaN."""
        if self.rigid is not None:
            return self.rigid.load(self.pi, joints)
        return load_along(self.arm, self.moved, self.pi)


def body_along(
    robot: Robot,
    terms: tuple[Term, ...],
    motion: Motion,
    pi: np.ndarray,
    rigid: Rigid | None = None,
) -> Body:
    """The rigid body of a model along a log; ``rigid``: columns of the plain motion, where known."""
    if rigid is not None and not moves_links(terms):
        return Body(robot, (motion.q, motion.dq, motion.ddq), motion, pi, rigid, rigid)
    arm, (true, known) = arm_of(robot, terms), as_read(terms, motion, rigid)
    moving = [t for t in terms if t.law.changes_rigid_columns]
    lag_alone = known is not None and all(isinstance(t.law, TransmissionLaw) for t in moving)
    unmoved = min(t.index for t in moving) if lag_alone else 0
    return Body(arm, _moved(arm, terms, true, pi, known), true, pi, None, known, unmoved)


def _moved(
    arm: Robot, terms: tuple[Term, ...], motion: Motion, pi: np.ndarray, rigid: Rigid | None
) -> Moved:
    """Motion of the links; a fit asks for its torque, then for its columns where it goes there."""
    if rigid is None or not is_kept(motion):
        return link_motion(arm, terms, motion, pi, rigid)
    lagging = [t for t in terms if t.law.changes_rigid_columns]
    place = (pi.tobytes(), valued(lagging))
    return last_of(rigid.moved, place, lambda: link_motion(arm, terms, motion, pi, rigid))


def carried(term: Term, motion: Motion) -> np.ndarray:
    """How much of a term's body is carried along a log, (T,)."""
    return np.asarray(term.law_of(BodyChange).weight(term.values, filled(motion.t)))[
        : len(motion.t)
    ]


def body_basis(law: BodyChange) -> np.ndarray:
    """Inertial parameters of the last link by each parameter of a body, (10, 10)."""
    names = law.candidate_names(())
    unit = [{name: float(name == one) for name in names} for one in names]
    return np.stack([np.asarray(_added(law, p)) for p in unit], axis=1)


@program("law")
def _added(law: BodyChange, values: dict) -> jax.Array:
    assert law.body is not None
    return law.body(values)
