"""Torques that are a multiple of what is logged: other units, motors before gears, percents of a rating."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from jaxswarm.identify.checks.guess import Guess, Scale, times
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.robot.model import Robot

TORQUE_SCALE = "torque_scale"
# Wrong scales: ratios of gears and units, and of a reading that is taken once for twice.
_FACTORS = (1e-3, 0.01, 0.1, 0.5, 2.0, 10.0, 100.0, 1e3)
# Between them the best one is looked for, but not where the gain of a drive may be.
_BETWEEN, _STEPS, _GAINS = 10.0**0.5, 21, (0.5, 2.0)
_NEARLY = (1.25, 0.8)
# What the scale of one more torque has to gain, as a sum of logarithms.
_WORTH = 0.2


def torque_scale_guesses(robot: Robot) -> Iterator[Scale]:
    """A torque of one joint that is a multiple of what is logged.

    Couplings tell it: what one link asks of two joints, by its weight or its inertia, has to be of the same
    size on both. A joint that nothing couples to the others, such as the last one about an axis through its
    center of mass, or a single slide, may have any scale.
    """
    for j in range(robot.num_joints):
        for factor in _FACTORS:
            yield _torque_scale(robot, j, factor)


def scales_between(
    robot: Robot, rough: Rough, sigma: np.ndarray, tried: list[tuple[Scale, Tried]]
) -> list[tuple[Scale, Tried]]:
    """The same scales with the best one of every joint moved to where it leaves least.

    A torque of a motor before a gear of 160 is 160 times what is logged: at 100 much of it is left.

    Args:
        robot: For the names.
        rough: Model of the log as it is.
        sigma: Standard deviation of every joint's residual [N m or N], (n,).
        tried: The scales of :func:`torque_scale_guesses`, with what they leave.
    """
    rows = [[one for one in tried if one[0].joints == (j,)] for j in range(robot.num_joints)]
    best = [min(row, key=lambda one: one[1].power) for row in rows]
    steps = [
        _torque_scale(robot, guess.joints[0], factor)
        for guess, _ in best
        for factor in guess.factor * np.geomspace(1.0 / _BETWEEN, _BETWEEN, _STEPS)
        if not _GAINS[0] < factor < _GAINS[1]
    ]
    found = list(zip(steps, rough.fit([_mixture(g) for g in steps], sigma), strict=True))
    kept = []
    for (guess, left), row in zip(best, rows, strict=True):
        near = [one for one in found if one[0].joints == guess.joints]
        nearest = min(near, key=lambda one: one[1].power)
        clearly = nearest[1].power < left.power - _WORTH
        kept += [one for one in row if one[0] is not guess]
        kept.append(nearest if clearly else (guess, left))
    return kept


def every_scale(
    robot: Robot, rough: Rough, sigma: np.ndarray, logged: Tried
) -> Iterator[tuple[Guess, Tried]]:
    """A scale for each of several torques, if one after the other gains clearly.

    What all torques have in common no motion tells.

    Args:
        robot: For the names.
        rough: Model of the log as it is.
        sigma: Standard deviation of every joint's residual [N m or N], (n,).
        logged: What the log as it is leaves.
    """
    n, left = robot.num_joints, logged
    scales = np.ones(n)
    # One joint, or all from one on: the last ones may agree among themselves.
    groups = [*np.eye(n, dtype=bool), *np.triu(np.ones((n, n), bool))[1:]]
    factors = (*_FACTORS, _BETWEEN, 1.0 / _BETWEEN, *_NEARLY)
    for _ in range(2 * n):
        several = [
            np.where(moved, scales * factor, scales) for moved in groups for factor in factors
        ]
        fits = rough.fit([np.diag(x) for x in several], sigma)
        best = min(range(len(fits)), key=lambda k: fits[k].power)
        if fits[best].power > left.power - _WORTH:
            break
        scales = several[best]
        left, sigma = rough.settled(np.diag(scales))
    scales = scales / np.median(scales)
    wrong = tuple(int(j) for j in np.flatnonzero((scales < _GAINS[0]) | (scales > _GAINS[1])))
    if len(wrong) > 1:
        guess = _several(robot, scales, wrong)
        yield replace(guess, needed=len(wrong) * _WORTH * rough.strictness), left


def _several(robot: Robot, scales: np.ndarray, wrong: tuple[int, ...]) -> Guess:
    told = ", ".join(f"{robot.joints[j]} {scales[j]:.2g}" for j in range(len(scales)))
    return Guess(
        TORQUE_SCALE,
        f"torques have scales of their own, times what is logged about {told}, and all times one number",
        wrong,
        mixture=np.diag(scales),
        remedy="Take motor torques times their gears, and percents of a rated torque times it",
    )


def _torque_scale(robot: Robot, joint: int, factor: float) -> Scale:
    text = f"the torque of {robot.joints[joint]} is {times(factor)} what is logged"
    mixture = np.diag(np.where(np.arange(robot.num_joints) == joint, factor, 1.0))
    return Scale(
        TORQUE_SCALE, text, (joint,), mixture,
        factor=factor, nearby=lambda more: _torque_scale(robot, joint, factor * more),
    )  # fmt: skip


def _mixture(guess: Scale) -> np.ndarray:
    assert guess.mixture is not None
    return guess.mixture
