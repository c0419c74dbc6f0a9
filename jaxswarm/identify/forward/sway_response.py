r"""What a base that gives way does to the torque along rigid parameters, from its response to single turns.

The torque that the joints feel of a base's turn :math:`\theta` about a level axis e is linear in the rigid
parameters and, to first order, in the turn and its derivatives: gravity turns the other way, the velocity bends
the paths of all links, the acceleration carries them along,

.. math:: \tau_\theta\,\theta + \tau_{\dot\theta}\,\dot\theta + \tau_{\ddot\theta}\,\ddot\theta.

The moment of the base, whose share the turn is, is linear in them too, so that a compliance is bilinear in the
parameters that load the base and those that are carried by it. The six responses are made once for all of them.
"""

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property

import numpy as np

from jaxswarm.effects.hinged_base import TURNS, hinged
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.base_swing import (
    below_cutoff,
    inertia_along,
    softness,
    softness_by,
    swings,
    swung,
)
from jaxswarm.identify.forward.columns import Moved
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.logged import BLOCK, rigid_torques
from jaxswarm.robot.model import Robot

_LEVEL = np.zeros(TURNS)


class SwayResponse:
    """What turns of the base do to the torque of a log, by rigid parameters and along them.

    A body is a sum of ``every`` with weights (m,).

    Args:
        arm: The robot in its gravity.
        moved: Motion of the links, q, dq, ddq, each (T, n).
        motion: The log, for its rate and the cutoff of its torque.
        every: Rigid parameters, (10 n, m).
        again: Whether more than one compliance or body is asked for: the responses are kept.
    """

    def __init__(
        self, arm: Robot, moved: Moved, motion: Motion, every: np.ndarray, again: bool = False
    ):
        self.arm, self.moved, self.motion, self.every, self.again = arm, moved, motion, every, again
        self.robot, count = hinged(arm), len(moved[0])
        # Of a long log some samples at a time: the torques of all masses are many times the motion.
        self.parts = [slice(start, start + BLOCK) for start in range(0, count, BLOCK)]
        held = [_moment(self.robot, [x[part] for x in moved], every) for part in self.parts]
        moments = np.concatenate(held, axis=1).T.reshape(count, TURNS, -1)
        self.moments = below_cutoff(moments, motion)
        self.kept: dict[int, np.ndarray] = {}
        self.last: tuple[np.ndarray, dict[int | str, np.ndarray]] = np.empty(0), {}

    @cached_property
    def inertias(self) -> np.ndarray:
        """What the base swings with, less its mean, (T, 2, 2, m)."""
        return inertia_along(self.arm, self.moved[0], self.every)

    def columns(self, term: Term, body: np.ndarray) -> np.ndarray:
        """Torque by the linear parameters of a compliance, (T, n, k)."""
        sways = (self._turns(soft, term, body) for soft in softness_by(term.law_of(BodyChange)))
        return self._torques([s[..., None] for s in sways], body)

    def bends(self, term: Term, body: np.ndarray) -> np.ndarray:
        """What the torque gains by these beside its columns, (T, n, k).

        The softer a base, the more the inertia of the arm slows its swing.
        """
        push, inertia = self._turns(softness(term), term, body)[:, 2], self._inertia(body)
        held = np.einsum("tab,tb->ta", inertia, push)[..., None]
        sways = []
        for soft in softness_by(term.law_of(BodyChange)):
            still = np.zeros((len(push), 3, TURNS, 1))
            sways.append(swung(still, self.motion, inertia, term, -held * soft[:, None]))
        return self._torques(sways, body)

    def at(self, term: Term, body: np.ndarray) -> np.ndarray:
        """Torque of a compliance with its values, then its derivatives along every body, (T, n, 1 + m)."""
        return self._along([softness(term)], term, body)

    def further(self, term: Term, body: np.ndarray) -> np.ndarray:
        """The columns, then their derivatives along every body, (T, n, k + m k), body by body."""
        return self._along(softness_by(term.law_of(BodyChange)), term, body)

    def _turns(self, soft: np.ndarray, term: Term, body: np.ndarray) -> np.ndarray:
        """Turns (T, 3, 2) of a base that holds a body with a softness (2,) about both axes."""
        still = -self._of(body, "moments", lambda: self.moments @ body) * soft
        if not swings(term):
            return still
        return swung(still[..., None], self.motion, self._inertia(body), term)[..., 0]

    def _inertia(self, body: np.ndarray) -> np.ndarray:
        """What the base swings with under a body, less its mean, (T, 2, 2)."""
        return self._of(body, "inertia", lambda: self.inertias @ body)

    def _turns_by(
        self, soft: np.ndarray, term: Term, body: np.ndarray, sway: np.ndarray
    ) -> np.ndarray:
        """Derivatives (T, 3, 2, m) along every body of these turns, which are ``sway``."""
        by = -self.moments * soft[:, None]
        if not swings(term):
            return by
        more = np.einsum("tabm,tb->tam", self.inertias, sway[:, 2]) * -softness(term)[:, None]
        return swung(by, self.motion, self._inertia(body), term, more)

    def _along(self, softs: Sequence[np.ndarray], term: Term, body: np.ndarray) -> np.ndarray:
        """Torque by each softness (2,) of k, then its derivatives along every body, (T, n, k + m k)."""
        sways = [self._turns(soft, term, body) for soft in softs]
        bys = [self._turns_by(soft, term, body, s) for soft, s in zip(softs, sways, strict=True)]
        size = len(softs) * (1 + self.every.shape[1])
        found = np.empty((len(sways[0]), self.arm.num_joints, size))
        for number, part in enumerate(self.parts):
            felt = self._felt(number)
            own = self._felt_of(body, number, felt)
            for k, (sway, by) in enumerate(zip(sways, bys, strict=True)):
                turn, turns = _by_turn(sway[part, ..., None]), _by_turn(by[part])
                # One turn or derivative after the other: all together they are six times as large.
                total = np.zeros(felt.shape[1:])
                for each, whole, one, others in zip(felt, own, turn, turns, strict=True):
                    total += each * one
                    total += whole[:, None] * others
                found[part, :, k] = np.einsum("snt,st->tn", own, turn[:, 0])
                found[part, :, len(softs) + k :: len(softs)] = total.transpose(2, 0, 1)
        return found

    def _torques(self, sways: Iterable[np.ndarray], body: np.ndarray) -> np.ndarray:
        """Torque (T, n, k) by turns of the base with two derivatives, (T, 3, 2, 1) each."""
        sway = np.concatenate(list(sways), axis=3)
        found = np.empty((len(sway), self.arm.num_joints, sway.shape[3]))
        for number, part in enumerate(self.parts):
            own = self._felt_of(body, number, self._felt(number))
            found[part] = np.einsum("snt,skt->tnk", own, _by_turn(sway[part]))
        return found

    def _felt_of(self, body: np.ndarray, number: int, felt: np.ndarray) -> np.ndarray:
        """Torque by each turn of the base and its derivatives, of a body, (6, n, T)."""
        # Of a long log what every part makes is not kept.
        return self._of(body, number, lambda: body @ felt) if self.again else body @ felt

    def _of(self, body: np.ndarray, name: int | str, make: Callable[[], np.ndarray]) -> np.ndarray:
        """What was made of a body under a name: of the last one it is kept."""
        if not np.array_equal(body, self.last[0]):
            self.last = body.copy(), {}
        if name not in self.last[1]:
            self.last[1][name] = make()
        return self.last[1][name]

    def _felt(self, number: int) -> np.ndarray:
        """Torque by each turn of the base and its derivatives, by every body, (6, n, m, T)."""
        if number in self.kept:
            return self.kept[number]
        part, (q, dq, _) = self.parts[number], self.moved
        felt = _felt(self.arm, self.robot, q[part], dq[part], self.every)
        if self.again:
            self.kept[number] = felt
        return felt


def _by_turn(sway: np.ndarray) -> np.ndarray:
    """Turns and derivatives (T, 3, 2, m) as signals, (6, m, T)."""
    return np.ascontiguousarray(sway.reshape(len(sway), 3 * TURNS, -1).transpose(1, 2, 0))


def _moment(robot: Robot, moved: Sequence[np.ndarray], every: np.ndarray) -> np.ndarray:
    """Moments (2 m, T) of a base at rest below a motion (T, n) each, of parameters (10 n, m)."""
    q, dq, ddq = map(_on_base, moved)
    return rigid_torques(robot, q, dq, ddq, every, first=TURNS)[:TURNS].reshape(-1, len(q))


def _felt(arm: Robot, robot: Robot, q: np.ndarray, dq: np.ndarray, every: np.ndarray) -> np.ndarray:
    """Torque (6, n, m, T) by turns of the base and by two derivatives of them, of parameters (10 n, m)."""
    rest, floating = np.zeros_like(q), robot.replace(gravity=np.zeros(3))

    def on_moving_base(speed: np.ndarray, push: np.ndarray) -> np.ndarray:
        return rigid_torques(floating, _on_base(q), speed, push, every, first=TURNS)[TURNS:]

    turned, sped, pushed = [], [], []
    for turn in np.eye(TURNS):
        # Seen from the base it is gravity that turns, the other way.
        lean = np.cross(np.asarray(arm.gravity, float), np.append(turn, 0.0))
        turned.append(rigid_torques(arm.replace(gravity=lean), q, rest, rest, every))
        ahead, behind = (
            on_moving_base(_on_base(dq, way * turn), _on_base(rest)) for way in (1.0, -1.0)
        )
        sped.append((ahead - behind) / 2.0)
        pushed.append(on_moving_base(_on_base(rest), _on_base(rest, turn)))
    return np.stack([*turned, *sped, *pushed])


def _on_base(x: np.ndarray, turn: np.ndarray = _LEVEL) -> np.ndarray:
    """A motion of the arm (T, n) on a base that turns, (T, 2 + n)."""
    return np.concatenate([np.broadcast_to(turn, (len(x), TURNS)), x], axis=1)
