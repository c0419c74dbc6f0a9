r"""The regression matrix of a model: rigid-body columns and the columns of every linear law parameter.

For one working clock, ``tau[t, j] = sum_c W[t, j, c] theta[c]`` with ``theta`` the standard parameters
of all links followed by the linear parameters of the terms in their order. Nonlinear parameters and the
load torque enter as given numbers. Torque and columns then pass the same decimator.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.sample import Sample
from jaxswarm.effects.series import law_columns
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.logs.motion import Motion
from jaxswarm.robot import regressor, standard_parameter_names
from jaxswarm.robot.model import Robot

# Samples evaluated in one call: one compiled program for logs of any length, bounded memory.
_CHUNK = 2048


class _Kinematics:
    """A robot's kinematics as a hashable constant: known numbers make a far smaller program."""

    def __init__(self, robot: Robot):
        fields = ("rotation", "translation", "axis")
        known = {name: np.asarray(getattr(robot, name), dtype=float) for name in fields}
        self.robot = robot.replace(
            **known,
            parameters=np.zeros((robot.num_joints, 10)),
            drive_gain=np.zeros(robot.num_joints),
        )
        numbers = b"".join(x.tobytes() for x in known.values())
        self.key = (robot.joints, robot.kinds, robot.parents, numbers)

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other) -> bool:
        return self.key == other.key


@partial(jax.jit, static_argnames="kinematics")
def _rigid(
    kinematics: _Kinematics, gravity: jax.Array, q: jax.Array, dq: jax.Array, ddq: jax.Array
) -> jax.Array:
    return jax.vmap(partial(regressor, kinematics.robot.replace(gravity=gravity)))(q, dq, ddq)


@partial(jax.jit, static_argnames="law")
def _law(law: TorqueLaw, nonlinear: dict, series: Sample) -> jax.Array:
    return law_columns(law, nonlinear, series)


def rigid_columns(robot: Robot, q: np.ndarray, dq: np.ndarray, ddq: np.ndarray) -> np.ndarray:
    """Columns of the standard parameters, shape (T, n, 10 n), for (T, n) motion."""
    size, chunk = len(q), _CHUNK
    padded = [np.concatenate([x, np.repeat(x[-1:], -size % chunk, axis=0)]) for x in (q, dq, ddq)]
    kinematics, gravity = _Kinematics(robot), jnp.asarray(robot.gravity, float)
    parts = [
        np.asarray(_rigid(kinematics, gravity, *(x[k : k + chunk] for x in padded)))
        for k in range(0, len(padded[0]), chunk)
    ]
    return np.concatenate(parts)[:size]


@dataclass(frozen=True)
class Rigid:
    """Rigid-body columns of one log, kept because every model on it needs them.

    Attributes:
        full: On the working clock, shape (T, n, 10 n).
        low: Through the decimator, shape (T', n, 10 n).
        static: On the working clock, without acceleration.
        gravity: What they were made with, (3,).
        sensed: What :mod:`jaxswarm.identify.forward.sensitivity` found about them, by joint.
    """

    full: np.ndarray
    low: np.ndarray
    static: np.ndarray
    gravity: np.ndarray
    sensed: dict = field(default_factory=dict, repr=False, compare=False)


def rigid_of(robot: Robot, motion: Motion) -> Rigid:
    """The rigid-body columns of a log in nominal gravity and motion."""
    full = rigid_columns(robot, motion.q, motion.dq, motion.ddq)
    static = rigid_columns(robot, motion.q, motion.dq, np.zeros_like(motion.ddq))
    return Rigid(full, motion.decimator.apply(full), static, np.asarray(robot.gravity))


class Load(NamedTuple):
    """Torque of a model along a log [N m or N], (T, n).

    Attributes:
        full: Of the rigid body.
        static: Of the rigid body without acceleration.
        whole: Of the rigid body and of all effects that supply a torque; None where no law asks.
    """

    full: np.ndarray
    static: np.ndarray
    whole: np.ndarray | None = None


def load_of(full: np.ndarray, static: np.ndarray, pi: np.ndarray) -> Load:
    """Load torque for rigid parameters ``pi`` (10 n,), from columns with and without acceleration."""
    return Load(full @ pi, static @ pi)


def direction(dq: np.ndarray, width: float) -> np.ndarray:
    """Smooth sign of a velocity, ``tanh(dq / width)``; ``width`` [rad/s] > 0."""
    return np.tanh(np.asarray(dq) / width)


def joint_series(
    motion: Motion,
    width: Sequence[float],
    load: Load | None,
    joint: int,
    other: int | None = None,
) -> Sample:
    """What a law on ``joint`` (with partner ``other``) sees along a log: a Sample of (T,) NumPy arrays.

    ``width`` is that of every joint's smooth sign, (n,); a sum of velocities takes the joint's own.
    """
    zero = np.zeros(len(motion.t))
    temperature = motion.channels.get("temperature")
    dq = motion.dq[:, joint]
    partner = None if other is None else motion.dq[:, other]
    return Sample(
        t=motion.t,
        q=motion.q[:, joint],
        dq=dq,
        ddq=motion.ddq[:, joint],
        direction=direction(dq, width[joint]),
        load=zero if load is None else load.full[:, joint],
        static_load=zero if load is None else load.static[:, joint],
        temperature=zero + np.nan if temperature is None else temperature[:, joint],
        dq_other=zero if other is None else partner,
        ddq_other=zero if other is None else motion.ddq[:, other],
        direction_sum=zero if other is None else direction(dq + partner, width[joint]),
        state=zero,
        q_other=zero if other is None else motion.q[:, other],
    )


def term_columns(
    term: Term, motion: Motion, width: Sequence[float], load: Load | None = None
) -> np.ndarray:
    """Columns of the linear parameters of a joint or pair term, shape (T, k), on its own joint."""
    law = term.law
    nonlinear = {p.name: np.float64(term.values[p.name]) for p in law.nonlinear}
    series = joint_series(motion, width, load, term.joint, term.other)
    return np.asarray(_law(law, nonlinear, filled(series)))[: len(motion.t)]


def column_names(robot: Robot, terms: tuple[Term, ...]) -> tuple[str, ...]:
    """Names of all columns: standard parameters, then ``parameter_joint:effect``."""
    names = list(standard_parameter_names(robot))
    for term in terms:
        names.extend(term.columns(robot.joints))
    return tuple(names)
