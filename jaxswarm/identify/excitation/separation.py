r"""The motion that best tells two undecided effects apart.

Let R be the columns of the rigid body and of the effects that are taken for granted, A and B those of the
rivals, rows weighted by the noise of their joint. What a model with B could make of the torque of A is its
projection on [R, B]; the rest shows that A was meant. The motion maximizes the smaller of the two rests,

.. math:: \min\bigl(\sigma_{\min}((1 - P_{RB})A),\ \sigma_{\min}((1 - P_{RA})B)\bigr),

with every column scaled to length one on the ordinary exciting motion, where this is the sine of the
smallest angle between a rival and everything else. Effects with nonlinear parameters imitate with their
slopes too, which is what a refit would do at first. Directions that are equal on every motion, as those of
an effect that contains the other, cannot count. This is T-optimality (A. C. Atkinson, V. V. Fedorov,
Biometrika 62 (1975)) for models that are linear in their parameters, with the least favorable direction of
the true effect.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from operator import itemgetter

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.decomposition import lstsq, thin_svd
from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.identify.excitation.columns import planned, planned_columns, refuse_terms
from jaxswarm.identify.excitation.constraints import (
    Constraints,
    excess_along,
    kept,
    penalized,
)
from jaxswarm.identify.excitation.fourier import Fourier, num_coordinates, widest
from jaxswarm.identify.excitation.host_search import search_on_host
from jaxswarm.identify.excitation.limits import Limits
from jaxswarm.identify.excitation.search import Excitation
from jaxswarm.robot.model import Robot

# Added to the squares of unit columns: dependent columns of R drop out, and an angle of 1e-4 is still seen.
_RIDGE = 1e-9
# A direction with less than this of its length left on motions drawn at random is equal on every motion.
_EQUAL = 1e-3
_DRAWN = 4
# Samples of a period for each harmonic; friction turns over within a few of them.
_SAMPLES = 40


@dataclass(frozen=True)
class Question:
    """Which two effects are to be told apart, and what is known.

    Attributes:
        pair: The rivals.
        others: Effects that are taken for granted beside the rigid body.
        pi: Rigid-body parameters (10 n,), for laws that need the load; None: unknown.
        noise: Standard deviation of the torque of every joint [N m or N], (n,); None: equal.
    """

    pair: tuple[Term, Term]
    others: tuple[Term, ...] = ()
    pi: np.ndarray | None = None
    noise: np.ndarray | None = None


@dataclass(frozen=True)
class Separation:
    """How well a motion tells two effects apart.

    Attributes:
        trajectory: The best motion found, or the ordinary one if none was better.
        reached: What cannot be imitated of each rival on it, as a share of that rival's torque on the
            ordinary motion; NaN for one that the other contains.
        ordinary: The same on the ordinary exciting motion.
        evaluations: Motions tried.
    """

    trajectory: Fourier
    reached: tuple[float, float]
    ordinary: tuple[float, float]
    evaluations: int

    @property
    def ratio(self) -> float:
        """How many times as far apart the rivals are as on the ordinary motion, by the worse of the two."""
        return float(np.nanmin(self.reached) / max(np.nanmin(self.ordinary), 1e-12))


def unexplained(own: np.ndarray, others: np.ndarray, directions: np.ndarray) -> float:
    """Least length that is left of ``own`` columns (k, N) without ``others`` (p, N), in given directions.

    Args:
        own: Columns in question.
        others: What may imitate them.
        directions: Orthonormal combinations of the own columns, (k, r).

    >>> left = unexplained(np.array([[3.0, 4.0]]), np.array([[1.0, 0.0]]), np.eye(1))
    >>> round(left, 4)
    4.0
    """
    own, others = np.asarray(own), np.asarray(others)
    size = np.linalg.norm(others, axis=1, keepdims=True)
    unit = others / np.maximum(size, 1e-30)
    squares, vectors = np.linalg.eigh(unit @ unit.T)
    weight = 1.0 / np.sqrt(np.maximum(squares, 0.0) + _RIDGE)
    mixed = weight[:, None] * (vectors.T @ (unit @ own.T))
    left = own @ own.T - mixed.T @ mixed
    return float(np.sqrt(max(np.linalg.eigvalsh(directions.T @ left @ directions)[0], 0.0)))


def separate(
    robot: Robot,
    question: Question,
    limits: Limits,
    ordinary: Excitation,
    *,
    seed: int = 0,
    runs: int = 2,
    num_steps: int = 300,
    constraints: Constraints | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> Separation:
    """Search the motion within limits on which two effects are furthest apart.

    Args:
        robot: Kinematics.
        question: The two effects and what is known.
        limits: What the motion has to keep.
        ordinary: The exciting motion to compare with, for the same limits; its period is taken.
        seed: Seed of the search.
        runs: Independent searches; the best one counts.
        num_steps: Steps of each.
        constraints: What the motion has to keep beside its limits; None: nothing.
        progress: Called with one line per stage.

    Raises:
        InputError: If an effect has no columns that follow from the motion, or if no motion can tell them
            apart.
    """
    known = question.pi is not None
    refuse_terms((*question.others, *question.pair), robot.joints, known, "--separate")
    fundamental = ordinary.trajectory.fundamental
    blocks = _blocks(robot, question, limits, 1.0 / fundamental)
    size = num_coordinates(limits)
    build = partial(planned, limits=limits, fundamental=fundamental)
    samples = _SAMPLES * limits.harmonics
    t = np.arange(samples) / (samples * fundamental)

    def along(trajectory: Fourier) -> list:
        return blocks(*(jnp.asarray(x.T) for x in trajectory.motion(t)))

    usual = along(ordinary.trajectory)
    scales = [np.linalg.norm(own, axis=1, keepdims=True) for own, _ in usual]
    drawn = np.random.default_rng(seed).uniform(-1.0, 1.0, (_DRAWN, size))
    directions = _directions([blocks(*build(x, samples=samples)) for x in drawn], scales)
    _refuse_equal(directions, question, robot)

    def left(parts: list) -> np.ndarray:
        """What is left of each rival that has a direction of its own, infinite for another."""
        return np.array(
            [
                unexplained(np.asarray(own) / scale, others, d) if d.shape[1] else np.inf
                for (own, others), scale, d in zip(parts, scales, directions, strict=True)
            ]
        )

    def made(x: jax.Array) -> tuple:
        motion = build(x, samples=samples)
        return blocks(*motion), excess_along(constraints, limits, motion, 1.0 / fundamental)

    many = jax.jit(jax.vmap(made))

    def values(population: np.ndarray) -> np.ndarray:
        # The programs make columns only: projections of a few dozen rows are NumPy's.
        parts, excess = jax.tree.map(np.asarray, many(population))
        each = (jax.tree.map(itemgetter(k), parts) for k in range(len(population)))
        return np.asarray(penalized(np.array([-left(one).min() for one in each]), excess))

    best, tried = search_on_host(values, size, seed, runs, num_steps, progress)
    trajectory = kept(widest(best, limits, fundamental, samples), constraints, limits)
    before, after = np.asarray(left(usual)), np.asarray(left(along(trajectory)))
    better = after.min() > before.min()
    return Separation(
        trajectory=trajectory if better else ordinary.trajectory,
        reached=_told(after if better else before),
        ordinary=_told(before),
        evaluations=tried,
    )


def _refuse_equal(directions: list[np.ndarray], question: Question, robot: Robot) -> None:
    """Refuse rivals of which neither makes a torque that the other and the rest of the model do not."""
    if any(d.shape[1] for d in directions):
        return
    names = " and ".join(term.label(robot.joints) for term in question.pair)
    raise InputError(
        f"--separate: no motion tells {names} apart: beside the rigid body and the other effects each "
        "makes every torque of the other; name other effects, or leave one out of the model"
    )


def _told(left: np.ndarray) -> tuple[float, float]:
    one, other = (float(x) if np.isfinite(x) else float("nan") for x in left)
    return one, other


def _blocks(robot: Robot, question: Question, limits: Limits, period: float) -> Callable:
    """A function of a motion: for each rival its own columns, and what may imitate them."""
    arm = jax.tree.map(np.asarray, robot)
    noise = np.ones(robot.num_joints) if question.noise is None else np.asarray(question.noise)
    weight = np.exp(np.log(noise).mean()) / noise

    terms = (*question.others, *question.pair)
    sizes = [len(t.law.linear) + len(t.law.free({**t.law.nominal(), **t.values})) for t in terms]
    ends = 10 * robot.num_joints + np.cumsum([0, *sizes])
    first, second, end = ends[-3:]
    counts = [len(term.law.linear) for term in question.pair]

    @jax.jit
    def blocks(q, dq, ddq) -> list:
        # All at once: the rigid body is by far the largest part of the program.
        made = planned_columns(arm, terms, limits, q, dq, ddq, period, question.pi, True)
        made = made * np.repeat(weight, q.shape[1])
        shared, a, b = made[:first], made[first:second], made[second:end]
        return [
            (a[: counts[0]], jnp.concatenate([shared, b])),
            (b[: counts[1]], jnp.concatenate([shared, a])),
        ]

    return blocks


def _directions(drawn: list, scales: list[np.ndarray]) -> list[np.ndarray]:
    """Combinations of each rival's scaled columns that nothing else equals on motions drawn at random."""
    found = []
    for k, scale in enumerate(scales):
        own = np.concatenate([np.asarray(parts[k][0]) / scale for parts in drawn], axis=1)
        others = np.concatenate([np.asarray(parts[k][1]) for parts in drawn], axis=1)
        others = others / np.maximum(np.linalg.norm(others, axis=1, keepdims=True), 1e-300)
        coefficients = lstsq(others.T, own.T, rcond=1e-10)
        _, length, vectors = thin_svd(own.T - others.T @ coefficients)
        found.append(vectors[length > _EQUAL * np.linalg.norm(own)].T)
    return found
