"""A rough model of a log, to try guesses on: what it tells of delays and of which torque is whose."""

from copy import copy
from dataclasses import replace

import numpy as np
import scipy

from jaxswarm.decomposition import lstsq, thin_svd
from jaxswarm.identify.checks.lateness import Lateness, late_by
from jaxswarm.identify.checks.rough_columns import Place, Wave, slow_rows, strongest_line
from jaxswarm.identify.checks.rough_fit import (
    DEPENDENT,
    DRY,
    PARTS,
    VISCOUS,
    RoughFit,
    of_one_length,
)
from jaxswarm.identify.estimation.factors import narrow_factor


class Rough(RoughFit):
    """Rigid body, rotors, friction and springs on one motion, and what is asked of what they leave."""

    def lateness(self, sigma: np.ndarray) -> Lateness:
        """By how much torques are late: what is left against their derivatives, freed of all columns.

        Args:
            sigma: Standard deviation of every joint's residual [N m or N], (n,).
        """
        return self.lateness_in_parts(sigma, 1)[0]

    def lateness_in_parts(self, sigma: np.ndarray, parts: int) -> list[Lateness]:
        """The same of each of two, three or six equal parts of the log, with one arm and one friction for all.

        A part of its own would often bend its own arm until nothing is late.
        """
        left, rates = self._against_rates(sigma)
        return late_by(left, *rates.reshape(parts, -1, *rates.shape[1:]).sum(axis=1))

    def lateness_beside_a_line(self, sigma: np.ndarray, joint: int) -> Lateness:
        """The same, where the strongest line of what is left of a joint is taken off as well.

        Args:
            sigma: Standard deviation of every joint's residual [N m or N], (n,).
            joint: That joint, from 0.
        """
        left = np.split(self._against_rates(sigma)[0], len(self._factors))[joint]
        factor = self._factors[joint]
        scale = np.maximum(np.linalg.norm(factor, axis=0), 1e-300)
        weights = lstsq(factor / scale, left) / scale
        hertz = strongest_line(self.samples.t, self._block(joint) @ weights)
        return Rough(self._robot, self.samples, Wave(joint, hertz)).lateness(sigma)

    def lateness_beside_its_place(self, sigma: np.ndarray, joint: int) -> Lateness:
        """The same, where what goes by the position of a joint, from 0, is taken off as well."""
        return Rough(self._robot, self.samples, Place(joint)).lateness(sigma)

    def lateness_in_motion(self, sigma: np.ndarray) -> Lateness:
        """The same by the ``sigma`` of above, without the rows of every joint in which it hardly moves."""
        factors = []
        for joint, speed in enumerate(self.speed):
            block = self._block(joint)
            block[slow_rows(self.samples, joint, speed)] = 0.0
            factors.append(narrow_factor(block))
        other = copy(self)
        other._factors = of_one_length(factors)
        return other.lateness(sigma)

    def lateness_without_friction(self, sigma: np.ndarray, joint: int) -> Lateness:
        """The same, where the derivative of a joint's friction is left out of its torque's.

        Args:
            sigma: Standard deviation of every joint's residual [N m or N], (n,).
            joint: That joint, from 0.
        """
        own = self._as_fitted(sigma)[1][joint]
        of_friction = slice(VISCOUS, DRY + self._dry)
        friction = self._columns.own[:, joint, of_friction] @ own[of_friction]
        rate = self.samples.tau_rate.copy()
        rate[:, joint] -= self.samples.derivative(friction)
        return self._by_rates(rate).lateness(sigma)

    def lateness_without_noise(self, sigma: np.ndarray) -> Lateness:
        """The same by the derivatives of what is fitted to the torques, which have no noise of the torques.

        Args:
            sigma: Standard deviation of every joint's residual [N m or N], (n,).
        """
        fitted = self._fitted(sigma)
        rate = np.stack([self.samples.derivative(torque) for torque in fitted.T], axis=1)
        return self._by_rates(rate).lateness(sigma)

    def residual(self, sigma: np.ndarray) -> np.ndarray:
        """What the fit to the torques as logged leaves of them [N m or N], (R, n).

        Args:
            sigma: Standard deviation of every joint's residual [N m or N], (n,).
        """
        return self.samples.tau - self._fitted(sigma)

    def _fitted(self, sigma: np.ndarray) -> np.ndarray:
        """The torques (R, n) as fitted to those that are logged."""
        rigid, own = self._as_fitted(sigma)
        return self._columns.rigid @ rigid + np.einsum("rnk,nk->rn", self._columns.own, own)

    def _by_rates(self, rate: np.ndarray) -> "Rough":
        """The same model with other derivatives of the torques, (R, n)."""
        return Rough(self._robot, replace(self.samples, tau_rate=rate))

    def _as_fitted(self, sigma: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Parameters of the links (p,) and of every joint's own columns (n, k), of the torques as logged."""
        joints, (u, inverse) = len(self._factors), self._solved(sigma)
        torque = self._size + self._own * joints
        right = [
            f[:, torque + j] / s for j, (f, s) in enumerate(zip(self._factors, sigma, strict=True))
        ]
        rigid, own = np.split(inverse @ (u.T @ np.concatenate(right)), [self._size])
        return rigid, own.reshape(joints, self._own)

    def _against_rates(self, sigma: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Torques (R,), and their derivatives in every part of the log (parts, R, n), freed of all columns."""
        joints, (u, _) = len(self._factors), self._solved(sigma)
        torque = self._size + self._own * joints
        last, extra = torque + joints, self._memory
        right = np.zeros((joints, len(self._factors[0]), 1 + joints * (PARTS + extra)))
        for j, (f, s) in enumerate(zip(self._factors, sigma, strict=True)):
            right[j, :, 0] = f[:, torque + j] / s
            for part in range(PARTS):
                right[j, :, 1 + part * joints + j] = f[:, last + part] / s
            place = 1 + PARTS * joints + extra * j
            right[j, :, place : place + extra] = f[:, last + PARTS :] / s
        flat = right.reshape(-1, right.shape[2])
        left = flat - u @ (u.T @ flat)
        left, memory = np.split(left, [1 + PARTS * joints], axis=1)
        left = left - memory @ lstsq(memory, left, rcond=DEPENDENT)
        return left[:, 0], left[:, 1:].reshape(len(left), PARTS, joints).transpose(1, 0, 2)

    def likely_order(self) -> tuple[int, ...]:
        """For each joint the torque that its own columns explain best, every torque once."""
        left = []
        for joint in range(len(self._factors)):
            u, torques = self._own_basis(joint)
            rest = np.linalg.norm(torques - u @ (u.T @ torques), axis=0)
            left.append(np.log(np.maximum(rest / self.spread, 1e-12)))
        return tuple(map(int, scipy.optimize.linear_sum_assignment(np.array(left))[1]))

    def alone(self, joint: int) -> float:
        """Share of its spread that a joint's own columns alone leave of its torque, freed of chance."""
        u, torques = self._own_basis(joint)
        own = torques[:, joint]
        freedom = max(self._rows - u.shape[1], 1.0)
        rest = np.linalg.norm(own - u @ (u.T @ own)) / np.sqrt(freedom)
        return float(rest / self.spread[joint])

    def _own_basis(self, joint: int) -> tuple[np.ndarray, np.ndarray]:
        """Orthonormal basis of a joint's own columns, and all torques on the same rows."""
        parameters = self._size + self._own * len(self._factors)
        factor = self._factors[joint]
        matrix, torques = factor[:, :parameters], factor[:, parameters:][:, : len(self._factors)]
        scale = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
        u, values, _ = thin_svd(matrix / scale)
        return u[:, values > DEPENDENT * values[0]], torques
