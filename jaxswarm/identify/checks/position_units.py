"""Positions in another unit than rad and m: degrees, revolutions, millimeters."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from jaxswarm.identify.checks.guess import Guess, named
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import Samples
from jaxswarm.robot.model import Robot

# Turns of a joint [rad] and travels [m] that no arm makes. What such a unit makes of them needs to gain less.
_FAR, _LIKELY = 4.0 * np.pi, 0.3
# What revolutions of all that turns need to gain, times the strictness of few rows: on 96 right logs they cost
# 0.04 to 28. Of the same logs in revolutions 89 gain this much, 81 gain 0.8.
_REVOLUTIONS = 0.3
# And speed of a slide [m/s] that none reaches: linear axes on sale end at 5 to 15 m/s. Where a slide changes
# nobody's lever no torque tells its unit: there it is enough that no more is left, but for what rounding makes.
_FASTEST, _NO_MORE = 20.0, -0.02
# And by how many of its unit something has to move: motion of a fraction of a degree or of a millimeter tells
# nothing. Two slides that went 0.1 and 0.3 m beside five turns, of which point-to-point motion told little,
# were called millimeters.
_LEAST = 1.0
# By the name that ``--columns`` takes: its size, and its name in words.
_TURNS = {
    "deg": (np.pi / 180.0, "degrees"),
    "rev": (2.0 * np.pi, "revolutions"),
    "mrad": (1e-3, "milliradians"),
}
_WAYS = {"mm": (1e-3, "millimeters"), "cm": (1e-2, "centimeters")}


def revolution_guesses(robot: Robot, joints: Iterable[int]) -> Iterator[Guess]:
    """The position of one joint in revolutions, for each of some joints."""
    for j in joints:
        if robot.kinds[j] == "revolute":
            yield _guess(
                robot, np.zeros(robot.num_joints, bool), {"rev": np.arange(robot.num_joints) == j}
            )


def position_unit_guesses(robot: Robot, rough: Rough, poor: bool) -> Iterator[Guess]:
    """Positions in a smaller unit where joints go far or much is left, and in revolutions anyhow.

    A controller tells degrees of what turns and millimeters of what slides; a logger that converts its whole
    table multiplies the travel of slides as well.

    Args:
        robot: Kinematics.
        rough: Model of the log as it is.
        poor: Whether much of the torque is left as logged.
    """
    turning = np.array([kind == "revolute" for kind in robot.kinds])
    samples = rough.samples
    far = np.ptp(samples.q, axis=0) > _FAR
    if turning.any():
        yield replace(_guess(robot, far, {"rev": turning}), needed=_REVOLUTIONS * rough.strictness)
    if poor or far.any():
        moving = np.ptp(samples.q, axis=0) > _LEAST
        kinds = (chosen & (chosen & moving).any() for chosen in (turning, ~turning))
        yield from _smaller(robot, samples, far, *kinds)


def _smaller(
    robot: Robot, samples: Samples, far: np.ndarray, turning: np.ndarray, slides: np.ndarray
) -> Iterator[Guess]:
    """Positions in each smaller unit: which joints go far, turn, and slide, (n,) each."""
    fast = np.abs(samples.dq).max(axis=0) > _FASTEST
    certain = bool(slides.any() and (far & fast)[slides].all())
    if turning.any():
        # Where slides are known to be in millimeters, turns in degrees alone are half of it.
        beside = {"mm": slides} if certain else {}
        yield _guess(robot, far, {"deg": turning} | beside, certain)
        yield _guess(robot, far, {"mrad": turning} | beside, certain)
        if (turning & far).any() and (turning & ~far).any():
            yield _guess(robot, far, {"deg": turning & far})
    if turning.any() and slides.any() and not certain:
        yield _guess(robot, far, {"deg": turning | slides})
    if slides.any():
        yield _guess(robot, far, {"mm": slides}, certain)
        yield _guess(robot, far, {"cm": slides})


def _guess(
    robot: Robot, far: np.ndarray, units: dict[str, np.ndarray], certain: bool = False
) -> Guess:
    """A guess by the joints (n,) of every unit."""
    factor, told = np.ones(robot.num_joints), []
    for unit, chosen in units.items():
        size, words = (_TURNS | _WAYS)[unit]
        factor = np.where(chosen, size, factor)
        those = tuple(map(int, np.flatnonzero(chosen)))
        told.append(f"{named(robot, those)} {'is' if len(those) == 1 else 'are'} in {words}")
    joints = tuple(int(j) for j in np.flatnonzero(factor != 1.0))
    if certain:
        told[-1] += ", or in centimeters, for nothing slides as fast as that in m"
    likely = _LIKELY if far[list(joints)].all() else None
    return Guess(
        "encoder_scale",
        f"the position{'s' * (len(joints) > 1)} of {' and of '.join(told)}",
        joints,
        motion=partial(Samples.placed, scale=factor),
        remedy=_remedy(tuple(units), factor),
        needed=_NO_MORE if certain else likely,
    )


def _remedy(units: tuple[str, ...], factor: np.ndarray) -> str:
    if len(units) == 1 and (factor == factor[0]).all():
        return f"Name the unit: --columns q:{units[0]}"
    scale = ", ".join(f"{x:.7g}" for x in factor)
    return f"Convert them, or give q a scale in a file for --columns: q = {{ scale = [{scale}] }}"
