"""A planned motion and what is told of it, the same for the command and for the function ``excite``."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.identify.excitation.columns import (
    condition,
    planned_columns,
    refuse_terms,
)
from jaxswarm.identify.excitation.constraints import Constraints
from jaxswarm.identify.excitation.fourier import Fourier
from jaxswarm.identify.excitation.limits import Limits
from jaxswarm.identify.excitation.search import FINE, Excitation, excite, used_shares
from jaxswarm.identify.excitation.separation import Separation
from jaxswarm.identify.excitation.separation import separate as find_apart
from jaxswarm.identify.excite_constraints import constraints_of, refuse_joints, told_constraints
from jaxswarm.identify.excite_question import question_of
from jaxswarm.identify.forward.model import Model
from jaxswarm.robot.joints import Description
from jaxswarm.robot.model import Robot

# Length of a period [s] where neither the file nor the duration says otherwise.
_PERIOD = 10.0
_MOST_SAMPLES = 2_000_000


@dataclass(frozen=True)
class Plan:
    """A motion to run on an arm.

    Attributes:
        trajectory: One period of it.
        limits: What it keeps.
        t: Times of all periods [s], (T,).
        condition: Condition number of its scaled base columns.
        random: The same for random motions.
        constraints: What it keeps beside the limits; None: nothing.
    """

    trajectory: Fourier
    limits: Limits
    t: np.ndarray
    condition: float
    random: np.ndarray
    constraints: Constraints | None = None

    @property
    def motion(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position, velocity and acceleration, each (T, n)."""
        return self.trajectory.motion(self.t)


def plan_motion(
    robot: Robot,
    limits: Limits,
    effects: str | None = None,
    duration: float | None = None,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    *,
    separate: str | None = None,
    given: Model | None = None,
    description: Description | None = None,
    check: Callable[[], object] = lambda: None,
) -> tuple[Plan, dict]:
    """Plan the motion that excites best, or the one that tells two effects apart best.

    Args:
        robot: Kinematics.
        limits: What the motion has to keep.
        effects: Effects beside the rigid body; None: viscous and dry friction.
        duration: Length [s], filled with whole periods; None: one period.
        seed: Seed of the search.
        progress: Called with one line per stage.
        separate: Two effects to tell apart, ``A,B``.
        given: A model: its masses and effects say what torque a motion needs, and are taken for granted by
            ``separate``.
        description: The robot with its shapes and torque limits; None: as the robot itself says.
        check: Called when the input is known to be good, before the work.

    Returns:
        The motion, and all that is told of it as plain data.

    Raises:
        InputError: On anything that cannot be used.
    """
    refuse_joints(robot, given)
    asked, terms, left_out = question_of(robot, effects, separate, given)
    refuse_terms(terms, robot.joints, given is not None)
    periods, samples = schedule(limits, duration)
    keep, notes = constraints_of(robot, description, limits, given)
    check()
    fundamental = limits.rate / samples
    limits = replace(limits, fundamental=fundamental, smaller=keep is not None)
    pi = None if given is None else np.asarray(given.robot.parameters).ravel()
    how: dict[str, Any] = {"seed": seed, "constraints": keep, "progress": progress}
    found = excite(robot, terms, limits, fundamental, pi=pi, **how)
    trajectory, condition, extra = found.trajectory, found.condition, {}
    if asked is None:
        notes += [f"not planned for, as it does not follow from the motion: {x}" for x in left_out]
    else:
        apart = find_apart(robot, asked, limits, found, **how)
        trajectory = apart.trajectory
        condition = _condition_on(trajectory, robot, terms, limits, found, pi)
        extra = {"separation": _told(apart, asked.pair, left_out, robot.joints)}
    t = np.arange(periods * samples + 1) / limits.rate
    plan = Plan(trajectory, limits, t, condition, found.random, keep)
    content = _content(robot, terms, plan, periods, found, seed)
    told = {**told_constraints(keep, trajectory, limits), "notes": notes}
    return plan, {**content, **extra, **told}


def _condition_on(
    trajectory: Fourier,
    robot: Robot,
    terms: tuple[Term, ...],
    limits: Limits,
    found: Excitation,
    pi: np.ndarray | None,
) -> float:
    """Condition number of the base columns of an excitation on another motion."""
    samples = FINE * limits.harmonics
    period = 1.0 / trajectory.fundamental
    q, dq, ddq = (x.T for x in trajectory.motion(np.arange(samples) * period / samples))
    columns = planned_columns(robot, terms, limits, q, dq, ddq, period, pi)
    return condition(np.asarray(columns)[found.base.kept])


def _told(
    apart: Separation, pair: tuple[Term, Term], left_out: list[str], joints: tuple[str, ...]
) -> dict:
    """A separation as plain data; null for an effect that the other contains."""
    names = [term.label(joints) for term in pair]

    def by_name(values: tuple[float, float]) -> dict:
        known = (None if np.isnan(x) else x for x in values)
        return dict(zip(names, known, strict=True))

    return {
        "effects": names,
        "reached": float(np.nanmin(apart.reached)),
        "ordinary": float(np.nanmin(apart.ordinary)),
        "ratio": apart.ratio,
        "reached_by_effect": by_name(apart.reached),
        "ordinary_by_effect": by_name(apart.ordinary),
        "meaning": "torque of an effect that the other one and the rest of the model cannot imitate, as a "
        "share of the torque of that effect on the ordinary exciting motion",
        "left_out": left_out,
        "evaluations": apart.evaluations,
    }


def _content(
    robot: Robot,
    terms: tuple[Term, ...],
    plan: Plan,
    periods: int,
    found: Excitation,
    seed: int,
) -> dict:
    """The content of ``excitation.json``."""
    limits, start = plan.limits, plan.trajectory.motion(np.zeros(1))[0][0]
    used = used_shares(plan.trajectory, limits)
    return {
        "robot": robot.name,
        "joints": list(robot.joints),
        "effects": [term.label(robot.joints) for term in terms],
        "duration": float(plan.t[-1]),
        "periods": periods,
        "rate": limits.rate,
        "fundamental": limits.fundamental,
        "harmonics": limits.harmonics,
        "condition_number": {
            "before": float(plan.random[0]),
            "after": float(plan.condition),
            "random_median": float(np.median(plan.random)),
            "random_best": float(plan.random.min()),
        },
        "base_parameters": list(found.base.expressions()),
        "evaluations": found.evaluations,
        "seed": seed,
        "start": dict(zip(robot.joints, start, strict=True)),
        "coefficients": coefficients(plan.trajectory, robot.joints),
        "limits_used": {
            joint: dict(zip(("position", "velocity", "acceleration"), row, strict=True))
            for joint, row in zip(robot.joints, used, strict=True)
        },
        "law": "q = offset + sum over l of sine[l] sin(2 pi l fundamental t) + cosine[l] cos(..)",
    }


def schedule(limits: Limits, duration: float | None) -> tuple[int, int]:
    """Number of periods, and of samples in one, so that both ends of the motion are samples.

    Raises:
        InputError: If a period has too few samples for its harmonics, or there are too many in all.

    >>> schedule(Limits(*np.ones((4, 1)), rate=100.0), 25.0)
    (2, 1250)
    """
    if duration is not None and not 0.0 < duration < np.inf:
        raise InputError(f"--duration {duration}: a finite time above zero is needed")
    whole = duration or 1.0 / (limits.fundamental or 1.0 / _PERIOD)
    periods = max(1, round(whole * (limits.fundamental or 1.0 / _PERIOD)))
    period = whole / periods if limits.fundamental is None else 1.0 / limits.fundamental
    if period * periods * limits.rate > _MOST_SAMPLES:
        raise InputError(
            f"{period * periods * limits.rate:.3g} samples are too many (at most {_MOST_SAMPLES}); "
            "shorten --duration or lower rate in the limits file"
        )
    samples = round(period * limits.rate)
    if samples < 10 * limits.harmonics:
        raise InputError(
            f"{samples} samples in a period of {period:.4g} s are too few for {limits.harmonics} "
            "harmonics; raise rate or the duration, or lower fundamental or harmonics"
        )
    return periods, samples


def coefficients(trajectory: Fourier, joints: tuple[str, ...]) -> dict:
    """The numbers of a trajectory by joint."""
    parts = zip(joints, trajectory.offset, trajectory.sine, trajectory.cosine, strict=True)
    return {joint: {"offset": q, "sine": s, "cosine": c} for joint, q, s, c in parts}
