"""Bad user input, what a user should know though the work went on, and helpers for their words.

The command line turns :class:`InputError` into one message and exit code 2; library users may catch
it as the ``ValueError`` it is.
"""

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Input that cannot be used: the message names it, shows its value and says what to do."""


class Notice(UserWarning):
    """Something a user should know although the work goes on; the command line prints it on stderr."""


def printable(text: str) -> str:
    r"""Escape control characters and whatever else moves a cursor or hides text on a terminal.

    >>> printable("joint\x1b[31m\n2")
    'joint\\x1b[31m\\n2'
    >>> printable("Gelenk Größe")
    'Gelenk Größe'
    """
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def nearest(name: str, known: Iterable[str]) -> str:
    """Return a sentence that offers the known names closest to ``name``, or lists all of them.

    >>> nearest("ur10", ["rx60", "ur10e"])
    'Did you mean ur10e?'
    >>> nearest("abc", ["rx60", "ur10e"])
    'Known: rx60, ur10e.'
    """
    known = sorted(known)
    close = difflib.get_close_matches(name, known, n=3, cutoff=0.55)
    if close:
        return f"Did you mean {' or '.join(close)}?"
    return f"Known: {', '.join(known)}."
