"""Jobs killed again and again at random moments, each time going on from what is left, until one may end.

They are copies of one process that has loaded everything, so that the moments fall into the work.
"""

import time
from pathlib import Path

import numpy as np

from benchmarks.trust.forked import Copy, command
from benchmarks.trust.jobs import JOBS, content, prepare
from benchmarks.trust.reference import KEPT, names, same

# Kills of one chain, and the longest time [s] of a job that is not killed.
KILLS = 4
_LONGEST = 600.0
# Jobs that a copy of a process can be: fleets and studies are killed as processes of their own.
COPIED = ("identify", "diagnose", "diagnose --model", "minimize_resumable")


class Copies:
    """Time and bytes of every job as a copy that nothing disturbs, each run twice: the first one compiles."""

    def __init__(self, place: Path):
        self.place = place
        self.known: dict[str, tuple[float, dict[str, str]]] = {}

    def of(self, job: str) -> tuple[float, dict[str, str]]:
        """Time [s] and digests of the files of a job."""
        if job not in self.known:
            for turn in range(2):
                folder = prepare(self.place / f"copy {turn} {job}")
                begun = time.perf_counter()
                code, told = _ended(_begun(job, folder))
                if code:
                    raise RuntimeError(f"{job} ended with {code}: {told}")
            self.known[job] = time.perf_counter() - begun, content(folder)
        return self.known[job]


def chain(folder: Path, copies: Copies, job: str, number: int) -> str:
    """Kill a job :data:`KILLS` times on its way; what is wrong in the end, empty: nothing."""
    seconds, whole = copies.of(job)
    moments = np.random.default_rng([number, 11]).uniform(0.05, 1.0, KILLS) * seconds
    for moment in moments:
        copy = _begun(job, folder)
        if copy.ended(float(moment)) is None:
            copy.kill()
        copy.said()
        visible = {n for n in content(folder) if not n.startswith(".") and n not in KEPT}
        if visible and job != "minimize_resumable" and visible != names(whole):
            return f"at {moment:.1f} s: a part of the results was left: {sorted(visible)}"
    return same(whole, folder, *_ended(_begun(job, folder)), f"after kills at {moments.round(1)} s")


def _begun(job: str, folder: Path) -> Copy:
    kind, *words = JOBS[job]
    if kind == "-c":
        return Copy(lambda: exec(words[0], {}), folder)
    return Copy(lambda: command(words[1:]), folder)


def _ended(copy: Copy) -> tuple[int, str]:
    code = copy.ended(_LONGEST)
    if code is None:
        copy.kill()
        code = -1
    return code, copy.said()[1].decode("utf-8", "replace")
