"""Jobs killed again and again at random moments, each time going on from what is left, until one may end.

They are copies of one process that has loaded everything, so that the moments fall into the work.
"""

import shutil
import signal
import time
from pathlib import Path

import numpy as np

from benchmarks.trust.forked import Copy, command
from benchmarks.trust.jobs import JOBS, content, prepare
from benchmarks.trust.reference import KEPT, names, same

# Kills of one chain, and the longest time [s] of a job that is not killed.
KILLS = 4
_LONGEST = 600.0
# Chains of each job in a round of fifty: what is quick is killed most.
_CHAINS = {
    "identify": 15,
    "minimize_resumable": 10,
    "study": 10,
    "diagnose": 5,
    "diagnose --model": 5,
    "fleet": 5,
}
_ROUND = sum(_CHAINS.values())
# Jobs that keep what they have done where their results will be.
_KEEPING = ("minimize_resumable", "fleet")
# What a command that is asked to end answers: its exit code, and a word.
_CODES = {signal.SIGINT: (130, "interrupted"), signal.SIGTERM: (143, "terminated")}
ASKED = tuple(_CODES)
# A copy that ended before its moment was no kill: the next one is tried sooner by this factor.
_SOONER = 0.8


def job_of(number: int) -> str:
    """The job of a chain; within a round the jobs are mixed."""
    places = [((k + 0.5) / often, job) for job, often in _CHAINS.items() for k in range(often)]
    return sorted(places)[number % _ROUND][1]


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
    rng = np.random.default_rng([number, 11])
    moments: list[float] = []
    while len(moments) < KILLS:
        moment = float(rng.uniform(0.05, 1.0)) * seconds
        copy = _begun(job, folder)
        code = copy.ended(moment)
        if code is not None:
            wrong = same(whole, folder, code, copy.said()[1].decode(), "not killed")
            if wrong:
                return f"{wrong}, after kills at {np.round(moments, 1)} s"
            shutil.rmtree(folder)
            prepare(folder)
            seconds *= _SOONER
            continue
        copy.kill()
        copy.said()
        moments.append(moment)
        visible = {n for n in content(folder) if not n.startswith(".") and n not in KEPT}
        if visible and job not in _KEEPING and visible != names(whole):
            return f"at {moment:.1f} s: a part of the results was left: {sorted(visible)}"
    told = f"after kills at {np.round(moments, 1)} s"
    return same(whole, folder, *_ended(_begun(job, folder)), told)


def ended_early(folder: Path, copies: Copies, job: str, sent: signal.Signals, number: int) -> str:
    """Ask a job to end at a random moment; what is wrong with what it said, left and makes of it later."""
    seconds, whole = copies.of(job)
    moment = float(np.random.default_rng([number, 9]).uniform(0.05, 1.0)) * seconds
    copy = _begun(job, folder)
    code = copy.ended(moment)
    while code is not None:  # it was done before its moment
        shutil.rmtree(folder)
        prepare(folder)
        moment *= _SOONER
        copy = _begun(job, folder)
        code = copy.ended(moment)
    copy.tell(sent)
    code, told = _ended(copy)
    left = {n for n in content(folder) if not n.startswith(".") and n not in KEPT}
    expected, word = _CODES[sent]
    done = code == 0 and left == names(whole)  # nothing was left to do
    if not done and (code != expected or "Traceback" in told or word not in told):
        return f"at {moment:.1f} s of {seconds:.1f} s: code {code}: {told}"
    if left and job not in _KEEPING and left != names(whole):
        return f"at {moment:.1f} s: a part of the results was left: {sorted(left)}"
    return same(whole, folder, *_ended(_begun(job, folder)), f"after {sent.name} at {moment:.1f} s")


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
