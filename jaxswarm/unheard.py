"""A signal that Python does not come to hear: one call of compiled code may take minutes.

A compilation and a wait for arrays hear it (jaxlib 0.10.2: within 0.04 s of a compilation of 34 s); reading
a result that is not there yet does not, nor does every other library. The handlers of
:mod:`jaxswarm.terminal` run between two steps of Python in the main thread. A thread of its own is told of
every signal at once; where no handler has run some seconds later, it ends the process. Whatever is written is
written beside its place and moved there whole, so that nothing is left half done.
"""

import os
import signal
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from jaxswarm import terminal

# Time [s] that a signal may wait for its handler: Python itself comes by in milliseconds, most calls of
# compiled code end within it, and a user who has asked for an end waits no longer.
_PATIENCE = 5.0
# Signals within this time [s] of each other call their handler once.
_TOGETHER = 1.0
# What a display that was not taken down has hidden.
_CURSOR = b"\x1b[?25h"
_ENDS = {
    signal.SIGTERM: (b"terminated\n", terminal.TERMINATED),
    signal.SIGINT: (b"interrupted\n", terminal.INTERRUPTED),
}


@contextmanager
def watched() -> Iterator[None]:
    """End this process, which is a command's own, on a signal that is not heard; only in the main thread."""
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    over = threading.Event()
    before = signal.set_wakeup_fd(theirs.fileno(), warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(ours, over), daemon=True).start()
    try:
        yield
    finally:
        over.set()
        signal.set_wakeup_fd(before)
        theirs.close()


def _watch(told: socket.socket, over: threading.Event) -> None:
    with told, suppress(OSError):
        while numbers := told.recv(64):
            asked, kinds = time.monotonic(), [n for n in numbers if n in _ENDS]
            if not kinds or over.wait(_PATIENCE):
                continue
            if terminal.last_heard() < asked - _TOGETHER:
                _leave(kinds[-1])


def _leave(number: int) -> None:
    word, code = _ENDS[signal.Signals(number)]
    # The stream may be held by the display, whose lock nobody gives back.
    with suppress(OSError):
        kept = "".join(f"{line}\n" for line in terminal.LAST_WORDS).encode("ascii", "replace")
        os.write(2, (_CURSOR if os.isatty(2) else b"") + kept + word)
    terminal.leave(code)
