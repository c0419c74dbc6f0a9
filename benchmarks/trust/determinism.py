"""The same log, versions and seed in other surroundings: the same bytes of every file."""

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

from benchmarks.trust.jobs import finish, prepare, start
from benchmarks.trust.reference import Reference, same
from benchmarks.trust.rows import add_row, read_rows

JOBS = ("identify", "diagnose", "diagnose --model", "minimize_resumable", "study")
_ODD_PLACE = "another folder, with blanks/and names ä"


def _environment(**changes: str) -> Callable[[Path], dict[str, str]]:
    return lambda folder: changes


# What is changed: variables of the process, and words before the command.
WAYS: dict[str, tuple[Callable[[Path], dict[str, str]], str]] = {
    "an empty cache": (lambda folder: {"JAX_COMPILATION_CACHE_DIR": str(folder / "cache")}, ""),
    "no cache": (_environment(JAX_ENABLE_COMPILATION_CACHE="0"), ""),
    "hash seed 1": (_environment(PYTHONHASHSEED="1"), ""),
    "hash seed 4711": (_environment(PYTHONHASHSEED="4711"), ""),
    "one core": (_environment(), "taskset -p -c 0 $$ > /dev/null"),
    "one core, empty cache": (
        lambda folder: {"JAX_COMPILATION_CACHE_DIR": str(folder / "cache")},
        "taskset -p -c 0 $$ > /dev/null",
    ),
    "one thread of Eigen": (_environment(XLA_FLAGS="--xla_cpu_multi_thread_eigen=false"), ""),
    "two threads of BLAS": (_environment(OPENBLAS_NUM_THREADS="2"), ""),
    "two devices": (_environment(XLA_FLAGS="--xla_force_host_platform_device_count=2"), ""),
    "another language and zone": (
        _environment(LC_ALL="C", LANG="de_DE.UTF-8", TZ="Asia/Kathmandu"),
        "",
    ),
    "another folder": (_environment(), ""),
}


def determinism(jobs: int = len(JOBS)) -> None:
    """Do so many jobs in all surroundings; rows that exist are not made again."""
    done = {(row["job"], row["way"]) for row in read_rows("determinism")}
    with tempfile.TemporaryDirectory(prefix="trust-") as place:
        reference = Reference(Path(place))
        for job in JOBS[:jobs]:
            for way, (environment, prefix) in WAYS.items():
                if (job, way) in done:
                    continue
                folder = Path(place) / (_ODD_PLACE if way == "another folder" else "work")
                shutil.rmtree(folder, ignore_errors=True)
                prepare(folder)
                _, whole = reference.of(job)
                ended = finish(start(job, folder, prefix, **environment(folder)))
                wrong = same(whole, folder, *ended, f"with {way}")
                add_row("determinism", {"job": job, "way": way, "same": not wrong, "what": wrong})
