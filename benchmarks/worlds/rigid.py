"""What a declared model can absorb, by plain weighted least squares with Pinocchio's regressor.

Columns: ten parameters a link, and of the declared effects ``dq``, ``sign(dq)`` and ``ddq`` of their joint.
"""

import numpy as np
import pinocchio

from benchmarks.worlds.arm import GRAVITY, Arm, pin_model

# Rows a projection is computed on, at most.
ROWS = 3000


def inverse_dynamics(arm: Arm, q, dq, ddq, gravity=GRAVITY) -> np.ndarray:
    """Torque of the bodies alone along a motion, (T, n)."""
    model = pin_model(arm, gravity)
    data = model.createData()
    rows = [pinocchio.rnea(model, data, *row).copy() for row in zip(q, dq, ddq, strict=True)]
    return np.array(rows)


def declared_columns(arm: Arm, declared, q, dq, ddq, gravity=GRAVITY) -> np.ndarray:
    """Columns of the declared model, (T, n, p)."""
    model = pin_model(arm, gravity)
    data = model.createData()
    n = arm.size
    body = np.array(
        [
            pinocchio.computeJointTorqueRegressor(model, data, *row).copy()
            for row in zip(q, dq, ddq, strict=True)
        ]
    )
    parts = [body]
    for effect, joint in declared:
        column = np.zeros((len(q), n, 1))
        column[:, joint, 0] = {
            "viscous_friction": lambda j: dq[:, j],
            "coulomb_friction": lambda j: np.tanh(dq[:, j] / arm.width[j]),
            "rotor_inertia": lambda j: ddq[:, j],
        }[effect](joint)
        parts.append(column)
    return np.concatenate(parts, axis=2)


class Absorber:
    """Least squares on the declared columns along one motion, rows weighted by ``1 / noise``."""

    def __init__(self, columns: np.ndarray, noise: np.ndarray):
        self.noise = noise
        flat = (columns / noise[:, None]).reshape(-1, columns.shape[2])
        scale = np.maximum(np.linalg.norm(flat, axis=0), 1e-12)
        u, s, vt = np.linalg.svd(flat / scale, full_matrices=False)
        keep = s > 1e-8 * s[0]
        self.basis = u[:, keep]
        self.inverse = (vt[keep].T / s[keep]) / scale[:, None]

    def left(self, torque: np.ndarray) -> np.ndarray:
        """The part of a torque that the columns cannot take up, (T, n)."""
        flat = (torque / self.noise).ravel()
        flat = flat - self.basis @ (self.basis.T @ flat)
        return flat.reshape(torque.shape) * self.noise

    def fit(self, torque: np.ndarray) -> np.ndarray:
        """Values of the columns, (p,)."""
        return self.inverse @ (self.basis.T @ (torque / self.noise).ravel())


def rms(x: np.ndarray) -> np.ndarray:
    return np.sqrt((x**2).mean(axis=0))
