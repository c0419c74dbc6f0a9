"""What is wrong with a log, and whether the work may go on with it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """Something that is wrong with a log.

    Attributes:
        check: Name of the check that found it.
        what: What it found, a sentence without its period.
        remedy: What to do, likewise.
        refused: Whether nothing is fitted to the log unless the user accepts the finding.
    """

    check: str
    what: str
    remedy: str
    refused: bool = True

    @property
    def note(self) -> str:
        """The sentence that the results hold."""
        return f"{self.check}: {self.what}. {self.remedy}."
