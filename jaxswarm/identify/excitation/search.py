r"""Exciting trajectories: the motion on which the parameters of a model can be told apart best.

With W the rows of the model along a motion, reduced to base columns and each column scaled to length
one, the error of a parameter grows with the condition number of W. A swarm minimizes

.. math:: \log \operatorname{cond}(W D), \qquad D = \operatorname{diag}(1/\|w_k\|)

over periodic motions that keep their limits by construction
(:mod:`jaxswarm.identify.excitation.fourier`), and torques and distances by a penalty
(:mod:`jaxswarm.identify.excitation.constraints`). Columns are scaled because a condition number
compares parameters of different units otherwise. Where torques and distances are kept, a motion may be smaller
than its limits ask; the mean logarithm of its size then counts too.

References: J. Swevers et al., IEEE Trans. Robotics and Automation 13 (1997); M. Gautier, W. Khalil, Int.
J. Robotics Research 11 (1992); C. Presse, M. Gautier, ICRA 1993 (scaling).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.base_parameters import BaseParameters, find_base
from jaxswarm.identify.excitation.columns import (
    Planned,
    condition,
    log_condition,
    planned,
    planned_columns,
    refuse_terms,
)
from jaxswarm.identify.excitation.constraints import (
    Constraints,
    excess_along,
    kept,
    penalized,
)
from jaxswarm.identify.excitation.fourier import Fourier, num_coordinates, shares, widest
from jaxswarm.identify.excitation.limits import Limits
from jaxswarm.identify.forward.names import column_names
from jaxswarm.robot.model import Robot
from jaxswarm.swarm import Space, cma_es, minimize_runs

# Samples of a period for each harmonic: in the search, and where the result is looked at.
_COARSE, FINE = 20, 100
_RANDOM = 20


@dataclass(frozen=True)
class Excitation:
    """An exciting motion and what it is worth.

    Attributes:
        trajectory: The best motion found.
        condition: Condition number of its scaled base columns.
        random: The same for random motions within the limits, shape (20,).
        base: The base parameters it was chosen for.
        used: Largest position range, speed and acceleration as shares of their limits, (n, 3).
        evaluations: Motions tried.
    """

    trajectory: Fourier
    condition: float
    random: np.ndarray
    base: BaseParameters
    used: np.ndarray
    evaluations: int


def excite(
    robot: Robot,
    terms: tuple[Term, ...],
    limits: Limits,
    fundamental: float,
    *,
    seed: int = 0,
    runs: int = 2,
    num_steps: int = 250,
    pi: np.ndarray | None = None,
    constraints: Constraints | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> Excitation:
    """Search the motion with the smallest condition number of the scaled base columns.

    Args:
        robot: Kinematics; its parameters are not used.
        terms: Effects to be identified beside the rigid body; nonlinear parameters at nominal values.
        limits: What the motion has to keep, for every joint of the robot.
        fundamental: Frequency of the period [Hz].
        seed: Seed of the search.
        runs: Independent searches; the best one counts.
        num_steps: Steps of each.
        pi: Rigid-body parameters (10 n,), for effects that depend on the load.
        constraints: What the motion has to keep beside its limits; None: nothing.
        progress: Called with one line per stage.

    Raises:
        InputError: If a term has no columns that follow from the motion, or no motion keeps everything.

    Needs double precision: in single, condition numbers above a thousand are lost in rounding.
    """
    refuse_terms(terms, robot.joints, pi is not None)
    progress("random motions")
    # Known numbers make a far smaller program than traced ones.
    arm = jax.tree.map(np.asarray, robot)
    size, fine, period = num_coordinates(limits), FINE * limits.harmonics, 1.0 / fundamental
    build = partial(planned, limits=limits, fundamental=fundamental)

    @jax.jit
    def along(motion: Planned) -> jax.Array:
        return planned_columns(arm, terms, limits, *motion, period, pi)

    starts = np.random.default_rng(seed).uniform(-1.0, 1.0, (_RANDOM, size))
    columns = [np.asarray(along(build(x, samples=fine))) for x in starts]
    stacked = np.concatenate([x.T for x in columns[:4]])
    base = find_base(stacked, column_names(robot, terms))
    chosen = base.kept

    def value(x: jax.Array) -> jax.Array:
        moved = build(x, samples=_COARSE * limits.harmonics)
        found = log_condition(planned_columns(arm, terms, limits, *moved, period, pi)[chosen])
        # Half the motion doubles the error of a parameter, as twice the condition number does.
        found = found - jnp.log(shares(x, limits)).mean()
        return penalized(found, excess_along(constraints, limits, moved, period))

    progress("searching")
    best, tried = _searched(value, size, seed, runs, num_steps)
    trajectory = kept(widest(best, limits, fundamental, fine), constraints, limits)
    moved = trajectory.motion(np.arange(fine) * period / fine)
    return Excitation(
        trajectory=trajectory,
        condition=condition(np.asarray(along(tuple(x.T for x in moved)))[chosen]),
        random=np.array([condition(x[chosen]) for x in columns]),
        base=base,
        used=used_shares(trajectory, limits),
        evaluations=tried,
    )


def _searched(
    fn: Callable, size: int, seed: int, runs: int, num_steps: int
) -> tuple[np.ndarray, int]:
    """The best point (size,) of several searches in [-1, 1], and how many points were tried."""
    found = minimize_runs(
        lambda population, _: jax.vmap(fn)(population),
        cma_es(),
        Space.vector(-np.ones(size), np.ones(size)),
        jax.random.split(jax.random.key(seed), runs),
        num_steps=num_steps,
    )
    best = np.asarray(found.params)[int(np.argmin(np.asarray(found.value)))]
    return best, int(np.sum(np.asarray(found.num_evaluations)))


def used_shares(trajectory: Fourier, limits: Limits) -> np.ndarray:
    """Position range, speed and acceleration of a motion as shares of their limits, (n, 3)."""
    size = trajectory.sine.shape[1]
    t = np.arange(FINE * size) / (FINE * size * trajectory.fundamental)
    q, dq, ddq = trajectory.motion(t)
    reach = np.ptp(q, axis=0) / (limits.upper - limits.lower)
    top = np.abs(dq).max(axis=0) / limits.velocity
    return np.stack([reach, top, np.abs(ddq).max(axis=0) / limits.acceleration], axis=1)
