r"""The RX60 experiment as data: motions, the thirteen columns, noise, the triangular factor, errors.

Torque is linear in the thirteen parameters, :math:`\tau = W(q, \dot q, \ddot q)\,\theta`. With
:math:`[W\ \tau]/\sqrt{T} = Q \begin{pmatrix} R & z \\ 0 & \rho \end{pmatrix}` the paper's fitness over T
samples is exactly

.. math:: f(\theta) = \sqrt{\textstyle\sum_j \tfrac1T \sum_t e_j(t)^2} = \sqrt{\|R\theta - z\|^2 + \rho^2},

so a particle costs 13 x 13 operations instead of 7001 x 3 x 13, and near zero error no digit is lost.
"""

from dataclasses import dataclass
from functools import cache

import jax
import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.identify.estimation.factors import triangular_factor
from jaxswarm.robot import regressor, rx60
from jaxswarm.studies.rx60.paper import NAMES, NOISE, TRUE

# Columns of the 3 x 10 link parameters in the order of the paper, and its signs of the products.
_COLUMNS = np.array((9, 14, 16, 19, 18, 17, 15, 24, 26, 29, 28, 27, 25))
_SIGNS = np.array([-1.0 if name[0] in "DEF" else 1.0 for name in NAMES])
_RATE = np.pi / 4.0  # rad/s, as printed
_BLOCK = 1024
READINGS = {
    "c pi": "q1 = c pi sin(pi t/4), q2 = c pi cos(pi t/4), q3 = r cos(pi t/4)",
    "c t": "q1 = c t sin(pi t/4), q2 = c t cos(pi t/4), q3 = r cos(pi t/4)",
    "c r": "q1 = c r sin(pi t/4), q2 = c r cos(pi t/4), q3 = r cos(pi t/4)",
}
FIT, VALIDATION = (0.6, -1.1), (0.4, 0.9)


@dataclass(frozen=True)
class Experiment:
    """A motion with its torques; arrays (T, 3).

    Attributes:
        t: Time in s, (T,).
        q, dq, ddq: Motion in rad, rad/s, rad/s^2.
        tau: Torques in N m.
    """

    t: np.ndarray
    q: np.ndarray
    dq: np.ndarray
    ddq: np.ndarray
    tau: np.ndarray

    @property
    def columns(self) -> np.ndarray:
        """W, (T, 3, 13)."""
        return columns(self.q, self.dq, self.ddq)


@dataclass(frozen=True)
class Compressed:
    """The fitness of an experiment: R (13, 13), z (13,) and rho^2, all per sample."""

    factor: np.ndarray
    target: np.ndarray
    rest: float

    def fitness(self, theta: np.ndarray) -> np.ndarray:
        """F of parameters (..., 13)."""
        error = np.asarray(theta) @ self.factor.T - self.target
        return np.sqrt((error**2).sum(axis=-1) + self.rest)

    def least_squares(self) -> np.ndarray:
        """The parameters of least fitness that are shortest, (13,): the null directions get nothing."""
        return np.linalg.lstsq(self.factor, self.target, rcond=1e-9)[0]


def motion(reading: str, c: float, r: float, t: np.ndarray) -> tuple[np.ndarray, ...]:
    """Positions, velocities and accelerations (T, 3) of a reading of the trajectory.

    Raises:
        InputError: If there is no such reading.

    >>> [x.tolist() for x in motion("c r", 2.0, 1.0, np.zeros(1))][0]
    [[0.0, 2.0, 1.0]]
    """
    if reading not in READINGS:
        raise InputError(f"reading={reading!r} is unknown. {nearest(reading, READINGS)}")
    sine, cosine = np.sin(_RATE * t), np.cos(_RATE * t)
    zero = np.zeros_like(t)
    size, growth = {"c pi": (c * np.pi + zero, zero), "c t": (c * t, c + zero)}.get(
        reading, (c * r + zero, zero)
    )
    q = np.stack([size * sine, size * cosine, r * cosine], axis=1)
    dq = np.stack(
        [
            growth * sine + size * _RATE * cosine,
            growth * cosine - size * _RATE * sine,
            -r * _RATE * sine,
        ],
        axis=1,
    )
    extra = 2.0 * growth * _RATE
    ddq = np.stack([extra * cosine, -extra * sine, zero], axis=1) - _RATE**2 * q
    return q, dq, ddq


def selection() -> np.ndarray:
    """The (13, 30) matrix that takes the link parameters of a robot to the paper's thirteen."""
    matrix = np.zeros((13, 30))
    matrix[np.arange(13), _COLUMNS] = _SIGNS
    return matrix


@jax.jit
def _regressors(robot, q, dq, ddq):
    return jax.vmap(regressor, (None, 0, 0, 0))(robot, q, dq, ddq)


def columns(q: np.ndarray, dq: np.ndarray, ddq: np.ndarray) -> np.ndarray:
    """The thirteen columns W (T, 3, 13) of a motion (T, 3)."""
    signals = np.stack([q, dq, ddq])
    blocks = -(-signals.shape[1] // _BLOCK)  # whole blocks, so that every length is one program
    padded = np.zeros((3, blocks * _BLOCK, 3))
    padded[:, : signals.shape[1]] = signals
    parts = [np.asarray(_regressors(rx60(), *block)) for block in np.split(padded, blocks, axis=1)]
    return np.concatenate(parts)[: signals.shape[1]] @ selection().T


def experiment(
    reading: str = "c pi",
    constants: tuple[float, float] = FIT,
    *,
    noise_seed: int | None = None,
    samples: int = 7001,
) -> Experiment:
    """Simulate the experiment; with a seed, with the paper's noise on all four signals."""
    t, signals, tau = _clean(reading, constants, samples)
    if noise_seed is not None:
        rng = np.random.default_rng([noise_seed, 60])
        signals = tuple(x + rng.normal(0.0, NOISE["motion"], x.shape) for x in signals)
        tau = tau + rng.normal(0.0, NOISE["torque"], tau.shape)
    q, dq, ddq = signals
    return Experiment(t, q, dq, ddq, tau)


@cache
def _clean(reading, constants, samples):
    t = np.linspace(0.0, 7.0, samples)
    signals = motion(reading, *constants, t)
    return t, signals, columns(*signals) @ TRUE


def averaged(data: Experiment, width: int = 50) -> Experiment:
    """All signals averaged over blocks of ``width`` samples: filter motion and torque alike."""
    whole = len(data.t) // width * width

    def mean(x):
        return x[:whole].reshape(-1, width, *x.shape[1:]).mean(axis=1)

    return Experiment(*(mean(x) for x in (data.t, data.q, data.dq, data.ddq, data.tau)))


def compress(data: Experiment) -> Compressed:
    """R, z and rho^2 of an experiment."""
    matrix = np.concatenate([data.columns, data.tau[:, :, None]], axis=2).reshape(-1, 14)
    r = triangular_factor(matrix / np.sqrt(len(data.t)))
    return Compressed(r[:13, :13], r[:13, 13], float(r[13, 13] ** 2))


def relative_error(data: Experiment, theta: np.ndarray) -> np.ndarray:
    """RAE per joint (3,): sum abs(tau - tau_hat) / sum abs(tau - mean tau)."""
    error = np.abs(data.tau - data.columns @ theta).sum(axis=0)
    return error / np.abs(data.tau - data.tau.mean(axis=0)).sum(axis=0)


def bounds(stretch: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """The search box (13,), (13,); ``stretch`` multiplies its sides about the origin."""
    moments = np.array([name[0] in "ABC" for name in NAMES])
    return stretch * np.where(moments, 0.0, -1.0), stretch * np.where(moments, 6.0, 1.0)
