"""The one exception that stands for bad user input, and the helper that suggests the near miss.

The command line turns :class:`InputError` into one message and exit code 2; library users may catch
it as the ``ValueError`` it is.
"""

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Input that cannot be used: the message names it, shows its value and says what to do."""


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
