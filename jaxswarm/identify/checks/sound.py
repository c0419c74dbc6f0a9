"""Whether what a guess leaves is that of an arm: friction brakes, and the torques are explained."""

from jaxswarm.identify.checks.guesses import Guess
from jaxswarm.identify.checks.rough import Tried

# Friction of a guess that drives by less than this share of the torque is none.
NONE = 0.05
# Share of the torque left, on the geometric mean over the joints, from which on motion explains nothing. Pure
# noise leaves all of it, the worst clean log 0.3.
UNRELATED = 0.5
# A torque's scale is believed where it leaves less than this share of its own joint's torque: of one that is
# badly explained, as one that hardly moved on a clean log of 16 s, nothing is known, and the others bend.
_SCALE_LEAVES = 0.15


def is_sound(guess: Guess, found: Tried) -> bool:
    """Whether friction brakes in what a guess leaves, and enough of the torques is explained by it."""
    if found.braking.min() < -NONE or found.size > UNRELATED:
        return False
    own = found.left[list(guess.joints)].max()
    return bool(guess.check != "torque_scale" or own <= _SCALE_LEAVES)
