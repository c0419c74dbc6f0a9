"""The fit that a rough model is: rigid body, and rotor, friction and spring of every joint, by any torques."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.decomposition import thin_svd
from jaxswarm.identify.checks.rough_columns import Place, Wave, columns_of
from jaxswarm.identify.checks.samples import Samples
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.identify.estimation.factors import narrow_factor
from jaxswarm.robot.model import Robot

# A fit with fewer rows than this per parameter bends: a wrong guess gains what it should not, the more the
# fewer there are. On a clean log of seven joints with 2.4 of them half a torque gained 1.1.
ROWS_THAT_HOLD = 3.0
# There a guess has to gain more, by this power of the lack of rows, but no more than so many times: wrong
# scales of six joints with one or two rows per parameter gain 2.7 to 28.
_STRICTER, STRICTEST = 3.5, 4.0
# Columns that depend on others to this part of their length are not told apart.
DEPENDENT = 1e-7
# Friction below this many of its standard errors is none: what is left is no white noise, and a joint whose
# torque is mostly noise had "friction" of a tenth of it at two.
_CHANCE = 6.0
# Rounds of weights at most, and the gain of a round, as a sum of logarithms, at which they have settled: less
# than half the least gain of a guess that anything is made of.
_ROUNDS, _SETTLED = 30, 0.02
# Columns of a joint: viscous and dry friction, then offset and spring, which many arms have undeclared, and the
# rotor behind its gear, which no link feels: a rigid arm alone bends its links to make up for it.
VISCOUS, DRY = 0, 1
# Parts of a log whose torques may each be late by something else: halves and thirds of them are wholes, too.
PARTS = 6


class RoughFit:
    """Rigid body, rotors, friction and springs on one motion, ready to be fitted to any mixture of the torques.

    Attributes:
        samples: The motion, and the torques as logged.
        speed: RMS speed of the joints [rad/s or m/s], (n,).
        spread: Standard deviation of the logged torques [N m or N], (n,).

    Args:
        robot: Kinematics.
        samples: The motion, and the torques as logged.
        beside: A line, or a joint's way, that delays are asked beside; None: nothing.
    """

    def __init__(self, robot: Robot, samples: Samples, beside: Wave | Place | None = None):
        self.samples, self._robot = samples, robot
        self.speed = np.sqrt(np.mean(samples.dq**2, axis=0))
        self.spread = np.maximum(samples.tau.std(axis=0), 1e-12)
        self._columns = columns_of(robot, samples, self.speed, beside)
        self._dry = self._columns.dry
        self._size, self._own, self._memory = self._columns.sizes
        self._rows = len(samples.tau)
        factors = [narrow_factor(self._block(j)) for j in range(samples.q.shape[1])]
        self._factors = of_one_length(factors)

    def _block(self, joint: int) -> np.ndarray:
        """What a joint's rows are fitted by, all torques, its torque's derivative by parts, and its memory."""
        columns, samples = self._columns, self.samples
        own = np.zeros((self._rows, self._own * samples.q.shape[1]))
        own[:, self._own * joint : self._own * (joint + 1)] = columns.own[:, joint]
        part = PARTS * np.arange(self._rows) // self._rows
        rates = samples.tau_rate[:, joint, None] * (part[:, None] == np.arange(PARTS))
        memory = columns.memory[:, joint]
        return np.concatenate([columns.rigid[:, joint], own, samples.tau, rates, memory], axis=1)

    @property
    def rows_per_parameter(self) -> float:
        """Rows over what is fitted to them, dependent columns counted once."""
        return self._rows / self._solved(self.spread)[0].shape[1]

    @property
    def strictness(self) -> float:
        """How many times more than on a long log a guess has to gain on this one to be believed."""
        lack = ROWS_THAT_HOLD / self.rows_per_parameter
        return min(max(lack, 1.0) ** _STRICTER, STRICTEST)

    def fit(self, mixtures: Sequence[np.ndarray], sigma: np.ndarray) -> list[Tried]:
        """Fit several mixtures of the torques at once, with the same weights.

        Args:
            mixtures: Each (n, n): row j says which of the logged torques is taken for joint j.
            sigma: Standard deviation of every joint's residual [N m or N], (n,).
        """
        joints, (u, inverse) = len(self._factors), self._solved(sigma)
        first = self._size + self._own * joints
        taken = np.stack(mixtures, axis=2)
        right = np.concatenate(
            [
                f[:, first : first + joints] @ taken[j] / s
                for j, (f, s) in enumerate(zip(self._factors, sigma, strict=True))
            ]
        )
        projected = u.T @ right
        theta = inverse @ projected
        residual = (right - u @ projected).reshape(joints, -1, len(mixtures))
        spread = np.stack([np.abs(m) @ self.spread for m in mixtures], axis=1)
        freedom = max(self._rows - u.shape[1] / joints, 1.0)
        left = np.linalg.norm(residual, axis=1) * sigma[:, None] / np.sqrt(freedom) / spread
        friction = theta[self._size :].reshape(joints, self._own, -1)
        dry = slice(DRY, DRY + self._dry)
        brake = friction[:, VISCOUS] * self.speed[:, None] + friction[:, dry].sum(axis=1)
        own = inverse[self._size :].reshape(joints, self._own, -1)
        usual = own[:, VISCOUS] * self.speed[:, None] + own[:, dry].sum(axis=1)
        chance = np.linalg.norm(usual, axis=1)
        brake = np.where(np.abs(brake) > _CHANCE * chance[:, None], brake, 0.0)
        return [Tried(left[:, k], brake[:, k] / spread[:, k]) for k in range(len(mixtures))]

    def _solved(self, sigma: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Orthonormal basis of the weighted columns, and what makes parameters of its coordinates."""
        parameters = self._size + self._own * len(self._factors)
        matrix = np.concatenate(
            [f[:, :parameters] / s for f, s in zip(self._factors, sigma, strict=True)]
        )
        scale = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
        u, values, v = thin_svd(matrix / scale)
        seen = values > DEPENDENT * values[0]
        return u[:, seen], v[seen].T / values[seen] / scale[:, None]

    def as_logged(self) -> tuple[Tried, np.ndarray]:
        """The fit to the torques as logged, and the weights it settled on."""
        return self.settled(np.eye(len(self._factors)))

    def settled(self, mixture: np.ndarray, rounds: int = _ROUNDS) -> tuple[Tried, np.ndarray]:
        """The fit to a mixture (n, n) of the torques, and the weights it settled on.

        What joints leave is traded slowly where one lacks a law: a fit that has not settled would credit the
        next guess with what one more round gains.
        """
        spread = np.abs(mixture) @ self.spread
        sigma, before = spread, np.inf
        for _ in range(rounds):
            (found,) = self.fit([mixture], sigma)
            if found.power > before - _SETTLED:
                break
            before, sigma = found.power, np.maximum(found.left, 1e-6) * spread
        return found, sigma


def of_one_length(factors: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Factors with as many rows each, zeros below."""
    most = max(map(len, factors))
    return [np.pad(f, ((0, most - len(f)), (0, 0))) for f in factors]
