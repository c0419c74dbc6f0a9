"""Around every command: its output place is held, and whatever ends it early ends in one message."""

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from jaxswarm import console, terminal
from jaxswarm.claim import claim
from jaxswarm.errors import InputError, shown_message

# Files that options of this command have read, beside what it is about.
_READ: ContextVar[tuple[Path, ...]] = ContextVar("read", default=())
# Where this command has finished its files; None: it writes none, or not yet.
_FINISHED: ContextVar[Path | None] = ContextVar("finished", default=None)


def run(command: Callable[[], None]) -> None:
    """Call the command line.

    Raises:
        SystemExit: With 2 on bad input and where the result cannot be printed, 128 and the number of the
            signal where one ended the work, and whatever the command itself ends with.
    """
    terminal.prepare_streams()
    terminal.show_notices(console.note)
    _FINISHED.set(None)
    _READ.set(())
    try:
        with terminal.catch_termination():
            try:
                command()
            finally:
                sys.stdout.flush()
    except InputError as error:
        print(f"error: {shown_message(str(error))}", file=sys.stderr)
        raise SystemExit(2) from None
    except OSError as error:
        raise SystemExit(_say_unprinted(error)) from None
    except (SystemExit, KeyboardInterrupt) as end:
        raise SystemExit(_explain(end)) from None
    except ImportError as error:
        # Compiled modules turn a signal that arrives while they load into a failed import.
        if not any(isinstance(cause, KeyboardInterrupt) for cause in _causes(error)):
            raise
        raise SystemExit(_explain(error)) from None


def _causes(error: BaseException) -> Iterator[BaseException]:
    cause: BaseException | None = error
    while cause is not None:
        yield cause
        cause = cause.__context__


def _explain(end: BaseException) -> int | str | None:
    """Exit code; the library for the command line ends without a word on interrupts and closed pipes."""
    for cause in _causes(end):
        if isinstance(cause, terminal.Terminated):
            print("terminated", file=sys.stderr)
            return terminal.TERMINATED
        if isinstance(cause, KeyboardInterrupt):
            print("interrupted", file=sys.stderr)
            return terminal.INTERRUPTED
        if isinstance(cause, BrokenPipeError):
            return _say_unprinted(cause)
    return end.code if isinstance(end, SystemExit) else 1


def _say_unprinted(error: OSError) -> int:
    terminal.drop_stdout()
    if isinstance(error, BrokenPipeError):
        return terminal.PIPE_CLOSED  # whoever reads has seen enough: no failure worth a word
    if error.filename is not None:  # a file, which no stream of ours has a name like
        print(f"error: {shown_message(f'{error.filename}: {error.strerror}')}", file=sys.stderr)
        return 2
    done = _FINISHED.get()
    kept = "" if done is None else f"; what --out {shown_message(str(done))} names is complete"
    print(
        f"error: cannot print the result ({error.strerror}){kept}; print to another place",
        file=sys.stderr,
    )
    return 2


def has_read(path: Path) -> None:
    """Remember a file that an option of this command has read: it may not be overwritten either."""
    _READ.set((*_READ.get(), path))


@contextmanager
def work(
    out: Path,
    inputs: Sequence[Path | None],
    names: Sequence[str] = (),
    resumable: bool = False,
    beside: Sequence[Path] = (),
) -> Iterator[Callable[[str], None]]:
    """Hold the output place, show the stage, and end with a message on an interrupt or bad numbers.

    Args:
        out: Folder or file to be written.
        inputs: Files that are read; None is passed over.
        names: Files written into ``out``; empty: ``out`` is itself the file.
        resumable: Whether the same command goes on where this one was interrupted.
        beside: Further files to be written.
    """
    kept = f"the same command goes on from what is kept in {out}"
    if resumable:
        terminal.LAST_WORDS.append(kept)
    try:
        # A name that no file system takes is no file here; whoever reads it says so.
        files = [path for path in inputs if path is not None and os.path.isfile(path)]
        every = (*inputs, *_READ.get())
        with claim(out, every, names, beside), console.working(files) as progress:
            yield progress
        _FINISHED.set(out)
    except KeyboardInterrupt:
        if resumable:
            print(kept, file=sys.stderr)
        raise
    finally:
        terminal.LAST_WORDS.clear()
