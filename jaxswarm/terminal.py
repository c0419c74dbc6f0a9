"""What the command line meets before any work: streams that cannot say everything, signals, no home."""

import atexit
import math
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NoReturn

from jaxswarm.errors import Notice

INTERRUPTED, TERMINATED, PIPE_CLOSED = 130, 143, 141  # 128 and the number of the signal

_LENT: list[str] = []  # homes that end with this process
_AGAIN = 3.0  # seconds after which a termination that was not heeded is repeated
_HEARD = [-math.inf]  # when [s], by the clock that never goes back
# Lines that an end of the work in this place has to say.
LAST_WORDS: list[str] = []


class Interrupted(KeyboardInterrupt):
    """SIGINT. A class of its own: CPython kills the process at its end, whatever the exit code, where the
    built-in one has passed through ``exec`` of a text (as within ``dataclass`` and ``namedtuple``).
    """


class Terminated(KeyboardInterrupt):
    """SIGTERM: the work ends as it does on an interrupt, with another word and exit code."""


def prepare_streams() -> None:
    """Let both streams take any character: what an encoding lacks is escaped; a closed one is a sink."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
        stream = getattr(sys, name)
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def show_notices(note: Callable[[str], None]) -> None:
    """Have notices told as sentences, each time they are given."""
    before = warnings.showwarning

    def show(message, category, *place, **more) -> None:
        if issubclass(category, Notice):
            note(str(message))
        else:
            before(message, category, *place, **more)

    warnings.simplefilter("always", Notice)
    warnings.showwarning = show


@contextmanager
def catch_termination() -> Iterator[None]:
    """Turn SIGTERM and SIGINT into exceptions that are not lost, for as long as a command runs."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    timer = hasattr(signal, "setitimer")

    def ending(error: type[BaseException]) -> Callable:
        def end(number, frame) -> None:
            _HEARD[0] = time.monotonic()
            if timer:  # an exception within a callback of compiled code may be lost: raise it again
                signal.signal(signal.SIGALRM, end)
                signal.setitimer(signal.ITIMER_REAL, _AGAIN)
            raise error

        return end

    kinds = {signal.SIGTERM: Terminated, signal.SIGINT: Interrupted}
    before = {number: signal.signal(number, ending(error)) for number, error in kinds.items()}
    hook = sys.unraisablehook

    def quiet(lost) -> None:
        # Raised where nothing can be, as while garbage is collected: it is repeated, and no word for the user.
        if not issubclass(lost.exc_type, tuple(kinds.values())):
            hook(lost)

    sys.unraisablehook = quiet
    try:
        yield
    finally:
        if timer:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        sys.unraisablehook = hook
        for number, former in before.items():
            signal.signal(number, former)


def last_heard() -> float:
    """When [s, monotonic] a signal was last heard by its handler."""
    return _HEARD[0]


def leave(code: int) -> NoReturn:
    """End this process as it is, with its streams written out.

    Compiled code goes on in threads of its own after a signal has ended the work: Python would wait for it, for
    minutes, or end in an abort when it calls back.
    """
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    for home in _LENT:
        shutil.rmtree(home, ignore_errors=True)
    os._exit(code)


def finish(code: int) -> NoReturn:
    """End this process whose work is done, with what was left for its end.

    To take down all that Python holds, which the system frees at once, takes 0.3 s after a short command and
    more after a long one.
    """
    atexit._run_exitfuncs()
    leave(code)


def find_home() -> Path | None:
    """The user's home, or None where there is none: then a private one is lent for this process.

    In containers a user may have neither ``HOME`` nor an entry in the list of users; libraries that
    keep settings at home fail there.
    """
    try:
        return Path.home()
    except RuntimeError:
        home = tempfile.mkdtemp(prefix="jaxswarm-home-")
        atexit.register(shutil.rmtree, home, ignore_errors=True)
        _LENT.append(home)
        os.environ["HOME"] = home
        return None


def drop_stdout() -> None:
    """Give up stdout, whose reader is gone or whose disk is full, so that nothing more fails on it."""
    sink = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(sink, sys.stdout.fileno())
    except (OSError, ValueError, AttributeError):
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
