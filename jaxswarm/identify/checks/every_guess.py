"""Every guess about a log with what it leaves: which are asked, and of which logs."""

from collections.abc import Iterable

import numpy as np

from jaxswarm.identify.checks.clock_apart import clock_guesses
from jaxswarm.identify.checks.column_order import column_order_guesses, exchanged_positions
from jaxswarm.identify.checks.conventions import convention_guesses
from jaxswarm.identify.checks.guess import Guess, Scale
from jaxswarm.identify.checks.guesses import (
    likely_order_guess,
    motion_scale_guesses,
    position_sign_guesses,
    torque_guesses,
)
from jaxswarm.identify.checks.mounting import mounting_guesses
from jaxswarm.identify.checks.position_units import (
    position_unit_guesses,
    revolution_guesses,
)
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.sound import NONE, Tried
from jaxswarm.identify.checks.torque_scales import (
    every_scale,
    scales_between,
    torque_scale_guesses,
)
from jaxswarm.identify.checks.zeros import zero_guesses
from jaxswarm.robot.model import Robot

# The log is asked for columns in another order and smaller units too, which costs a regressor a guess, where it
# leaves this much, or so much on one joint.
_POOR, _POOR_JOINT = 0.1, 0.3
# And for other conventions, which cost seven a joint, where it leaves this much: half of 85 logs of right
# robots leave 0.04, three quarters less than 0.08. Of 65 random conventions of one or two joints on 36 logs, 38
# leave clearly more than the right one (0.7 as a sum of logarithms). All of these leave 0.07 and more, and 37
# are told, five of them beside a base that hangs; of the other 27, which show little or nothing, none is.
_UNUSUAL = 0.06
# The scale of a torque is asked for closely where a coarse one gains this.
_FAINTLY = 0.05


def every_guess(
    robot: Robot, rough: Rough, logged: Tried, sigma: np.ndarray
) -> list[tuple[Guess, Tried]]:
    """All guesses that a log is asked for, with what each leaves.

    Args:
        robot: Kinematics.
        rough: Model of the log as it is.
        logged: What that leaves.
        sigma: Standard deviation of every joint's residual [N m or N], (n,).
    """
    torques, scales = list(torque_guesses(robot)), list(torque_scale_guesses(robot))
    mixtures = [g.mixture for g in (*torques, *scales) if g.mixture is not None]
    fits = rough.fit(mixtures, sigma)
    tried: list[tuple[Guess, Tried]] = list(zip(torques, fits, strict=False))
    coarse = list(zip(scales, fits[len(torques) :], strict=True))
    tried += coarse
    if min(t.power for _, t in coarse) < logged.power - _FAINTLY:
        tried = [*tried[: -len(coarse)], *scales_between(robot, rough, sigma, coarse)]
        tried += every_scale(robot, rough, sigma, logged)
    tried += _with_its_own_weights(robot, rough)
    tried += _with_another_motion(robot, rough, logged)
    tried += clock_guesses(robot, rough, logged)
    tried += zero_guesses(robot, rough, logged)
    tried += mounting_guesses(robot, rough, logged)
    if logged.size > _UNUSUAL:
        tried += convention_guesses(robot, rough, logged)
    return tried


def _with_another_motion(robot: Robot, rough: Rough, logged: Tried) -> list[tuple[Guess, Tried]]:
    """Guesses that change positions or time."""

    def left(guesses: Iterable[Guess]) -> list[tuple[Guess, Tried]]:
        return [(g, Rough(robot, g.moved(rough.samples)).as_logged()[0]) for g in guesses]

    poor = logged.size > _POOR or logged.left.max() > _POOR_JOINT or logged.braking.min() < -NONE
    tried = left(motion_scale_guesses(robot))
    # Of a revolution that is taken for a radian twice as much leaves less already.
    more = [
        g.joints[0]
        for g, t in tried
        if isinstance(g, Scale) and len(g.joints) == 1 and g.factor > 1 and t.power < logged.power
    ]
    tried += left(revolution_guesses(robot, more))
    tried += left(position_sign_guesses(robot))
    tried += left(position_unit_guesses(robot, rough, bool(poor)))
    if poor:
        tried += left(exchanged_positions(robot))
        tried += column_order_guesses(robot, rough, logged)
    return tried


def _with_its_own_weights(robot: Robot, rough: Rough) -> list[tuple[Guess, Tried]]:
    """The likely order of the torques, if it is another one, weighted by what it leaves itself.

    The weights of the log as it is belong to its order: a joint that gets the torque of a far weaker one would
    not count at all.
    """
    order = likely_order_guess(robot, rough.likely_order())
    if order is None or order.mixture is None:
        return []
    return [(order, rough.settled(order.mixture)[0])]
