"""What is wrong with a log, and whether the work may go on with it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from jaxswarm.errors import InputError
from jaxswarm.logs.log import Log


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


def with_findings(
    log: Log, findings: Iterable[Finding], accept: Iterable[str], known: Iterable[Finding] = ()
) -> Log:
    """The log with its findings as notes, unless one of them forbids to go on.

    Args:
        log: With notes of its own.
        findings: What is new about it.
        accept: Names of checks whose findings are told only.
        known: What was found before: a refusal names it too, for it may be the cause.

    Raises:
        InputError: Naming all findings that are refused and not accepted.
    """
    findings, accepted = tuple(findings), set(accept)
    bad = [f for f in findings if f.refused and f.check not in accepted]
    if bad:
        names = " ".join(f"--accept {name}" for name in dict.fromkeys(f.check for f in bad))
        told = " ".join(f.note for f in bad)
        if before := " ".join(f.note for f in (*known, *findings) if f not in bad):
            told = f"{told} Besides, {before}"
        raise InputError(f"{log.source}: {told} To fit the log as it is, pass {names}")
    return replace(log, notes=(*log.notes, *(f.note for f in findings)))


Check = Callable[[Log], Finding | None]
