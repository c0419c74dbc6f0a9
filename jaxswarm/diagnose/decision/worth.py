"""What a candidate is worth, and whether that is enough."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.decision.rules import Rules

# Runners-up of a chosen candidate that are remembered.
_MOST_OTHERS = 8


@dataclass(frozen=True, eq=False)
class Score:
    """What a candidate is worth on held-out time.

    Attributes:
        candidate: Who.
        gain: Fall of the weighted squared error, all joints.
        per_joint: The same per joint, shape (n,).
        blocks: Per block, shape (B,).
        share: Share of its joint's squared error taken off.
        trained: The same on the rows it was fitted to, where it is largest.
        joint: The joint where that is.
        p_value: One-sided, that the prediction is not in the residual of unseen blocks.
        repeats: Share of blocks in which it helps.
        coefficients: Linear coefficients of the whole fit, (k,).
        allowed: Whether signs agree with physics.
        over_noise, over_torque: RMS torque that it takes off its joint's error, over that of the noise
            and of the torque; events are scored by their own torque instead.
        own: Per block, on its own joint, (B,); None where it does not show there, or not there alone.
        on_all: The same candidate judged by all joints, of a law by which links move otherwise than motors.
    """

    candidate: Candidate
    gain: float
    per_joint: np.ndarray
    blocks: np.ndarray
    share: float
    trained: float
    joint: int
    p_value: float
    repeats: float
    coefficients: np.ndarray
    allowed: bool
    over_noise: float = np.inf
    over_torque: float = np.inf
    own: np.ndarray | None = None
    on_all: "Score | None" = None

    @property
    def worth(self) -> float:
        """Gain on its own joint if it shows there, else on all.

        Half a short log may know so little of what joints share that the others lose more than its own gains:
        bristles that took 96 % off their joint's error at p = 1e-12 had a gain below zero in all.
        """
        return self.gain if self.own is None else float(self.own.sum())

    def beside(self, other: "Score") -> np.ndarray:
        """Gain per block (B,) by which it is compared: on their joint if both show on the same one."""
        return self.own if self.own is not None and self.shows_with(other) else self.blocks

    def relative_gain(self, chosen: "Score") -> float:
        """Gain over that of a chosen one, as the choice was made: on the joint where that shows, else on all.

        What the other joints of a short log gain by half of it is chance: it made 2.7 of an offset's 0.6.
        """
        if chosen.own is None:
            return self.gain / chosen.gain
        return float(self.per_joint[chosen.joint] / chosen.per_joint[chosen.joint])

    def judged_as(self, other: "Score") -> "Score":
        """The same candidate by all joints, where it has such a score and the other one is by all joints."""
        return self.on_all if self.on_all is not None and other.own is None else self

    def shows_with(self, other: "Score") -> bool:
        """Whether both show on one and the same joint of their own."""
        return self.own is not None and other.own is not None and self.joint == other.joint


def runners_up(
    chosen: Score, scores: Sequence[Score], refused: Collection[tuple] = ()
) -> tuple[Score, ...]:
    """Other candidates for what a chosen one explains, the best first: those that show on its joint.

    Beside a law of the whole arm that is everybody. What was refused, by the identities of terms, is none: it
    stood before a wound-up bristle as a delay of twice its gain.
    """
    place = chosen.candidate.term.joint

    def rivals(s: Score) -> bool:
        term = s.candidate.term
        here = place is None or term.joint is None or s.joint == chosen.joint
        gains = s is not chosen and s.relative_gain(chosen) > 0
        return gains and here and term.identity not in refused

    ranked = sorted(filter(rivals, scores), key=lambda s: -s.relative_gain(chosen))
    return tuple(ranked[:_MOST_OTHERS])


def passes(item: Score, asked: int, rules: Rules) -> bool:
    """Whether a candidate passes, alone against the current model."""
    return is_no_chance(item, asked, rules) and is_large(item, rules)


def is_no_chance(item: Score, asked: int, rules: Rules) -> bool:
    """Whether a candidate explains anything, however little, that chance does not."""
    return (
        item.allowed
        and item.worth > 0
        and item.p_value * asked < rules.significance
        and item.repeats >= rules.repeat
    )


def is_large(item: Score, rules: Rules) -> bool:
    """Whether a candidate explains enough to be an effect of its own."""
    return (
        item.share >= rules.share
        and item.over_noise >= rules.over_noise
        and item.over_torque >= rules.over_torque
    )


def adds(item: Score, rules: Rules) -> bool:
    """Whether a candidate explains what a rival leaves, beside which it was scored."""
    return item.gain > 0 and item.p_value < rules.rival
