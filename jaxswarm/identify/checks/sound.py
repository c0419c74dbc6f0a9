"""What a guess leaves, and whether that is an arm's: friction brakes, and the torques are explained."""

from dataclasses import dataclass

import numpy as np

from jaxswarm.identify.checks.guess import Guess, OtherRobot

# Friction of a guess that drives by less than this share of the torque is none.
NONE = 0.05
# Share of the torque left, on the geometric mean over the joints, from which on motion explains nothing. Pure
# noise leaves all of it, the worst clean log 0.3.
UNRELATED = 0.5
# Of what may be a law that is missing, and no fault of the log.
UNLESS = ", unless something else that is missing looks so"
# A torque's scale is believed where it leaves less than this share of its own joint's torque: of one that is
# badly explained, as one that hardly moved on a clean log of 16 s, nothing is known, and the others bend.
_SCALE_LEAVES = 0.15
# Another robot than the one declared, by its base or its conventions, is believed where it leaves no more than
# this share: nine of ten logs of right robots, clean ones and ones that lack a law, leave less than 0.14. Where
# columns were exchanged or a joint turned the other way, another gravity left 0.20 to 0.26 of 0.25 to 0.33.
_ROBOT_LEAVES = 0.15


@dataclass(frozen=True)
class Tried:
    """What a fit with other signs or channels leaves.

    Attributes:
        left: RMS of the residual, freed of what chance fits, over the torque's standard deviation, (n,).
        braking: Friction at the usual speed over the torque's standard deviation, (n,); a joint below zero
            would be driven by its friction. Zero where chance makes as much.
    """

    left: np.ndarray
    braking: np.ndarray

    @property
    def logarithms(self) -> np.ndarray:
        """Those of what is left, (n,)."""
        return np.log(np.maximum(self.left, 1e-9))

    @property
    def size(self) -> float:
        """Geometric mean over the joints of what is left: no joint of large torque hides the others."""
        return float(np.exp(np.mean(self.logarithms)))

    @property
    def power(self) -> float:
        """Sum of the logarithms of what is left."""
        return float(np.sum(self.logarithms))


def may_be(found: Tried) -> bool:
    """Whether friction brakes in what is left, and motion explains the torques at all."""
    return bool(found.braking.min() >= -NONE and found.size <= UNRELATED)


def is_sound(guess: Guess, found: Tried) -> bool:
    """Whether friction brakes in what a guess leaves, and enough of the torques is explained by it."""
    if not may_be(found) or (isinstance(guess, OtherRobot) and found.size > _ROBOT_LEAVES):
        return False
    own = found.left[list(guess.joints)].max()
    return bool(guess.check != "torque_scale" or own <= _SCALE_LEAVES)
