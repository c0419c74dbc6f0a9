"""What a search tells on its way, and what is raised by those who are told.

A compiled program that calls the host and meets an exception there ends with an error of JAX's own, in whose
text the exception is and nowhere else. So it is kept where it was raised, and raised again by whoever called
the program: with its type, its traceback and what it was raised from.
"""

from collections.abc import Callable
from typing import Any, ClassVar

import jax

__all__ = ["Telling", "told"]


class Telling:
    """A progress function that keeps what it raises; two of one function are one to a compiled program."""

    raised: ClassVar[dict[Any, BaseException]] = {}

    def __init__(self, function: Callable[[Any, Any], Any]):
        self.function = function

    def __call__(self, count: Any, value: Any) -> None:
        """Tell; the exception goes on, so that the program ends at this step."""
        try:
            self.function(count, value)
        except BaseException as error:
            self.raised[self.function] = error
            raise

    def taken(self) -> BaseException | None:
        """What was raised since this was asked last."""
        return self.raised.pop(self.function, None)

    def __eq__(self, other: object) -> bool:
        """Whether the function is the same."""
        return isinstance(other, Telling) and self.function == other.function

    def __hash__(self) -> int:
        """Of the function."""
        return hash(self.function)


def told(progress: Telling | None, program: Callable[..., Any], *given: Any) -> Any:
    """Return ``program(*given)``, and let what ``progress`` raises in it through as it was raised.

    Where there is somebody to be told, the program is waited for: what is raised has to find its caller. Within
    a program of somebody else it is that one's caller who meets JAX's error.
    """
    if progress is None:
        return program(*given)
    progress.taken()  # of a program that nobody waited for
    try:
        return jax.block_until_ready(program(*given))
    except jax.errors.JaxRuntimeError:
        error = progress.taken()
        if error is None:
            raise
    raise error
