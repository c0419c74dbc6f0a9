"""A command in a copy of this process: a whole one, but for the seconds in which Python and JAX are loaded."""

import importlib
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
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
    load()
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as told:
        sys.stdout.flush()
        sys.stderr.flush()
        process = os.fork()
        if process == 0:
            os._exit(_child(words, place, space, out.fileno(), told.fileno()))
        code = _wait(process, seconds)
        out.seek(0)
        told.seek(0)
        return code, out.read(), told.read()


def _wait(process: int, seconds: float) -> int:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        done, status = os.waitpid(process, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    os.kill(process, signal.SIGKILL)
    os.waitpid(process, 0)
    return _OUT_OF_TIME


def _child(words: Sequence[str], place: Path, space: int, out: int, told: int) -> int:
    """Be the command; whatever happens, the copy ends with a code."""
    try:
        os.chdir(place)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(out, 1)
        os.dup2(told, 2)
        resource.setrlimit(resource.RLIMIT_AS, (space, space))
        sys.argv = ["jaxswarm", *words]
        from jaxswarm.cli import main

        main()
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        traceback.print_exc()
        code = 1
    sys.stdout.flush()
    sys.stderr.flush()
    return code
