"""What undisturbed commands leave, and whether disturbed ones left the same, or nothing."""

import time
from pathlib import Path

from benchmarks.trust.jobs import content, finish, prepare, start

# Files that an unfinished command may leave in its output: from them it goes on.
KEPT = ("diagnosis.partial.json",)


class Reference:
    """Time and bytes of every job that nothing disturbs, each run once."""

    def __init__(self, place: Path):
        self.place = place
        self.known: dict[str, tuple[float, dict[str, str]]] = {}

    def of(self, job: str) -> tuple[float, dict[str, str]]:
        """Time [s] and digests of the files of a job."""
        if job not in self.known:
            folder = prepare(self.place / f"reference {job}")
            begun = time.perf_counter()
            code, told = finish(start(job, folder))
            if code:
                raise RuntimeError(f"{job} ended with {code}: {told}")
            self.known[job] = time.perf_counter() - begun, content(folder)
        return self.known[job]


def names(whole: dict[str, str]) -> set[str]:
    """Files that a user sees."""
    return {name for name in whole if not name.startswith(".")}


def same(whole: dict[str, str], folder: Path, code: int, told: str, when: str) -> str:
    """What differs from the undisturbed job; empty: nothing."""
    found = content(folder)
    if code:
        return f"{when}: ended with {code}: {told}"
    other = {name for name in whole.keys() | found.keys() if whole.get(name) != found.get(name)}
    return f"{when}: other bytes: {sorted(other)}" if other else ""


def refused(folder: Path, code: int, told: str, words: tuple[str, ...]) -> str:
    """What is wrong with a refusal, which leaves nothing; empty: nothing."""
    left = {name for name in content(folder) if name not in KEPT}
    if code != 2 or "Traceback" in told or not all(word in told for word in words):
        return f"code {code}: {told}"
    return f"left {sorted(left)}" if left else ""
