"""A command in a copy of this process: a whole one, but for the seconds in which Python and JAX are loaded."""

import importlib
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path

# What the commands load at their start. None of it may start a device, whose threads no copy would have.
_LOADED = (
    "jax",
    "scipy.optimize",
    "scipy.signal",
    "matplotlib.figure",
    "matplotlib.backends.backend_agg",
    "jaxswarm.cli",
    "jaxswarm.tasks",
    "jaxswarm.identify.run",
    "jaxswarm.diagnose.run",
    "jaxswarm.diagnose.run_against",
)
_OUT_OF_TIME = -1


def load() -> None:
    """Load what every command needs, once."""
    for name in _LOADED:
        importlib.import_module(name)


class Copy:
    """A copy of this process that does a piece of work in a folder, with both streams kept.

    Args:
        work: What it does; a :class:`SystemExit` of it is its exit code.
        place: Folder it works in.
        space: Largest address space [bytes]; 0: any.
    """

    def __init__(self, work: Callable[[], object], place: Path, space: int = 0):
        load()
        self._out, self._told = tempfile.TemporaryFile(), tempfile.TemporaryFile()
        sys.stdout.flush()
        sys.stderr.flush()
        self._process = os.fork()
        if self._process == 0:
            os._exit(_child(work, place, space, self._out.fileno(), self._told.fileno()))

    def ended(self, seconds: float) -> int | None:
        """Wait so long [s] for its exit code, below zero where a signal ended it; None: it still works."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            done, status = os.waitpid(self._process, os.WNOHANG)
            if done:
                return os.waitstatus_to_exitcode(status)
            time.sleep(0.01)
        return None

    def kill(self) -> None:
        """End it as a lack of memory or of current would."""
        os.kill(self._process, signal.SIGKILL)
        os.waitpid(self._process, 0)

    def tell(self, number: signal.Signals) -> None:
        """Send it a signal."""
        os.kill(self._process, number)

    def said(self) -> tuple[bytes, bytes]:
        """What went to stdout and stderr."""
        texts = []
        for file in (self._out, self._told):
            file.seek(0)
            texts.append(file.read())
            file.close()
        return texts[0], texts[1]


def run_copy(
    words: Sequence[str], place: Path, seconds: float, space: int
) -> tuple[int, bytes, bytes]:
    """Run a command line.

    Args:
        words: After the name of the program.
        place: Folder it works in.
        seconds: Longest time [s]; then it is killed.
        space: Largest address space [bytes].

    Returns:
        Exit code, -1 if it was killed, and what went to both streams.
    """
    copy = Copy(lambda: command(words), place, space)
    code = copy.ended(seconds)
    if code is None:
        copy.kill()
        code = _OUT_OF_TIME
    return code, *copy.said()


def command(words: Sequence[str]) -> None:
    """Be a command, in a copy."""
    from jaxswarm.cli import main

    sys.argv = ["jaxswarm", *words]
    main()


def _child(work: Callable[[], object], place: Path, space: int, out: int, told: int) -> int:
    """Do the work; whatever happens, the copy ends with a code."""
    try:
        os.chdir(place)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(out, 1)
        os.dup2(told, 2)
        if space:
            resource.setrlimit(resource.RLIMIT_AS, (space, space))
        work()
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        traceback.print_exc()
        code = 1
    sys.stdout.flush()
    sys.stderr.flush()
    return code
