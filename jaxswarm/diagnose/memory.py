"""How much memory a diagnosis takes, told before it is begun."""

from collections.abc import Sequence

from jaxswarm.diagnose.candidates.link_lag import MOST_NUMBERS
from jaxswarm.diagnose.candidates.thinned import interval_of
from jaxswarm.identify.forward.columns import is_kept, numbers_of
from jaxswarm.logs.motion import Motion
from jaxswarm.memory import GIB, refuse_beyond_free

# Signals of a joint that stand in memory at once: motion, torques, loads, what laws see, each with copies.
_SIGNALS = 60
# Derivatives of a torque by every joint that are kept from one candidate to the next.
_TURNED = 3
# Curves of transmissions that are held at a time, with what they are made of; of a long log some at a time.
_CURVES, _WITH = 200, 6


def needed(motions: Sequence[Motion]) -> float:
    """Memory [GiB] that a diagnosis of motions holds at its peak, beside the program's own half.

    The columns of the rigid body and their derivatives by the motion of every joint where they are kept, or on
    every few samples, the curves of transmissions, and the signals themselves, on the working clock.
    """
    numbers = 0.0
    for motion in motions:
        samples, joints = motion.q.shape
        every = 1 if is_kept(motion) else interval_of(motion)
        numbers += numbers_of(motion) / every if is_kept(motion, every) else 0
        numbers += min(samples * joints * _CURVES, _WITH * MOST_NUMBERS)
        numbers += samples * joints * (_SIGNALS + _TURNED * joints)
    return 8.0 * numbers / GIB


def refuse_too_large(motions: Sequence[Motion]) -> None:
    """Refuse motions whose diagnosis would not fit into memory.

    Raises:
        InputError: With what is needed and what there is.
    """
    longest = max(motions, key=lambda motion: len(motion.t))
    total = sum(len(motion.t) for motion in motions)
    refuse_beyond_free(
        needed(motions),
        f"{longest.source}: to diagnose {total} samples of {len(longest.joints)} joints at "
        f"{longest.rate:.4g} Hz takes",
        "give a shorter stretch of the log, or a --motion-cutoff below "
        f"{max(longest.motion_cutoff):.3g} Hz, with which fewer samples do",
    )
