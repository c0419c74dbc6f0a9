"""How long a search may go on: it ends at the first step after that, with what is known so far."""

import time
from dataclasses import dataclass, field

from jaxswarm.errors import InputError


@dataclass(frozen=True)
class Budget:
    """A span of time that begins when it is made.

    A step under way is finished, and what follows the search (what remains, the report) is not counted:
    the whole takes longer than the budget by a step and by that.

    Attributes:
        seconds: Length [s]; infinite: none was given.
        started: When it began, by the clock of :func:`time.monotonic` [s].
    """

    seconds: float = float("inf")
    started: float = field(default_factory=time.monotonic)

    def __post_init__(self):
        if not self.seconds > 0.0:
            raise InputError(f"budget {self.seconds:g}: give seconds, more than zero")

    @property
    def spent(self) -> bool:
        """Whether the time is over."""
        return time.monotonic() - self.started > self.seconds


@dataclass(frozen=True)
class Spent:
    """A budget that ended a search.

    Attributes:
        seconds: What was given [s].
        rounds: Rounds of the search that were finished.
    """

    seconds: float
    rounds: int

    @property
    def sentence(self) -> str:
        """What a reader has to know."""
        rounds = f"{self.rounds} round{'' if self.rounds == 1 else 's'}"
        return (
            f"stopped by the budget of {self.seconds:g} s after {rounds}; what is left may hold more: the "
            "same command with a larger budget goes on from there"
        )


def given_budget(seconds: float | None) -> Budget:
    """The budget of a command that begins now; None: no limit."""
    return Budget() if seconds is None else Budget(float(seconds))
