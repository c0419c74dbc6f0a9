"""What may happen to any input: success, or an :class:`InputError` that is fit for a terminal, in time."""

import resource
import signal
import time
import traceback
import warnings
from collections.abc import Callable
from contextlib import contextmanager
from typing import Any, NamedTuple

from jaxswarm.errors import InputError, shown_message

# Time [s] an input may take, growth of the memory [bytes] it may cause, length of a message.
SLOWEST, LARGEST, LONGEST = 10.0, 3 * 2**30, 2000


class Outcome(NamedTuple):
    """What happened.

    Attributes:
        kind: ``accepted`` or ``refused``, else what is wrong: ``raised``, ``hung``, ``slow``, ``memory``,
            ``message``.
        what: The refusal, or the end of the traceback.
        seconds: Time it took.
    """

    kind: str
    what: str
    seconds: float

    @property
    def wrong(self) -> bool:
        """Whether it must not happen."""
        return self.kind not in ("accepted", "refused")


class HungError(BaseException):
    """Time is over; no handler of ordinary exceptions takes it for one."""


def watched(call: Callable[[], Any]) -> Outcome:
    """Call something that may refuse its input, and see what happens.

    Args:
        call: Without arguments; what it returns is dropped.
    """
    before, start, computed = _peak(), time.perf_counter(), time.process_time()
    kind, what = "accepted", ""
    with _alarm(2.0 * SLOWEST), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            call()
        except InputError as error:
            kind, what = "refused", str(error)
        except HungError:
            kind, what = "hung", f"more than {2.0 * SLOWEST:g} s"
        except Exception as error:
            where = traceback.extract_tb(error.__traceback__)[-3:]
            lines = [f"{f.filename.split('/')[-1]}:{f.lineno} {f.name}" for f in where]
            kind, what = (
                "raised",
                f"{type(error).__name__}: {error} ({' > '.join(lines)})"[:LONGEST],
            )
    seconds = time.perf_counter() - start
    grown = _peak() - before
    if kind in ("accepted", "refused") and grown > LARGEST:
        return Outcome("memory", f"{grown / 2**30:.1f} GiB more", seconds)
    # A busy machine makes everything slow: only what computes so long is.
    if kind in ("accepted", "refused") and time.process_time() - computed > SLOWEST:
        return Outcome("slow", f"{seconds:.1f} s; {what}", seconds)
    if kind == "refused" and (wrong := wrong_message(what)):
        return Outcome("message", f"{wrong}: {what!r}"[:LONGEST], seconds)
    return Outcome(kind, what, seconds)


def wrong_message(text: str) -> str:
    """What is wrong with a message as the command line prints it; empty: nothing.

    >>> wrong_message("arm.csv: no such file")
    ''
    """
    if not text.strip():
        return "no message"
    shown = shown_message(text)
    if len(shown) > LONGEST:
        return "message too long"
    if any(not c.isprintable() for c in shown):
        return "control characters"
    return ""


def _peak() -> int:
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


@contextmanager
def _alarm(seconds: float):
    def ring(number, frame):
        raise HungError

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
