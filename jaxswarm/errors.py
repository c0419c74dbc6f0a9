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


# Characters of a message that are shown; what a file holds may be quoted in it and be of any length.
_LONGEST = 1600


def shown_message(text: str) -> str:
    """A message fit for a terminal: printable, and with its middle left out where it is too long.

    >>> len(shown_message("x" * 10**6)) < 2000
    True
    """
    text = printable(text)
    half = _LONGEST // 2
    return text if len(text) <= _LONGEST else f"{text[:half]} ... {text[-half:]}"


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
