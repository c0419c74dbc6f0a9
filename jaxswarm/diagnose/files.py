"""The logs of a diagnosis: read once, prepared, and told in its result."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jaxswarm.identify.run import read_motions, told_of
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import Filtering, Motion
from jaxswarm.logs.segments import prepare_all
from jaxswarm.provenance import provenance
from jaxswarm.robot.model import Robot


@dataclass(frozen=True)
class ReadLogs:
    """Logs as read and as prepared.

    Attributes:
        files: Where they came from, those to score on last.
        fitted, scored: Logs that are fitted, and logs to score on.
        motions, unseen: Their stretches between gaps.
    """

    files: tuple[Path, ...]
    fitted: list[Log]
    scored: list[Log]
    motions: list[Motion]
    unseen: list[Motion]

    @property
    def all(self) -> list[Log]:
        """All logs, those to score on last."""
        return [*self.fitted, *self.scored]

    def prepared_like(self, filtering: Filtering) -> list[Motion]:
        """The stretches to score on, prepared as the model asks for."""
        return prepare_all(self.scored, filtering)

    def told(self, options: dict, *further: Path) -> dict:
        """What a result says of its origin: the logs, what is wrong with them, digests and options.

        ``further`` are files that were read beside the logs.
        """
        origin = provenance([*self.files, *further], options)
        return told_of(self.fitted, self.scored) | {"provenance": origin}


@dataclass(frozen=True)
class Files:
    """Log files, and findings in spite of which they are used.

    What cannot be scored on is refused before the work, not after it: all are read at once.
    """

    fitted: Sequence[Path]
    scored: Sequence[Path]
    accept: tuple[str, ...] = ()

    def read(self, robot: Robot, filtering: Filtering, gains: np.ndarray | None = None) -> ReadLogs:
        """Read and prepare all of them; ``gains`` (n,) are torques per current other than the robot's."""
        files = (*self.fitted, *self.scored)
        logs, prepared = read_motions([*files], robot, filtering, gains, self.accept)
        count = len(self.fitted)
        motions, unseen = (
            [part for parts in some for part in parts]
            for some in (prepared[:count], prepared[count:])
        )
        return ReadLogs(files, logs[:count], logs[count:], motions, unseen)
