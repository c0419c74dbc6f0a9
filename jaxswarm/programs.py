"""Compiled programs that the next process finds ready, without tracing and lowering them again.

JAX keeps what it compiled on disk, and knows it again only by the text it was lowered to. Of the time until
the two largest programs of a diagnosis ran, 1.59 of 1.70 s went into that text. Here a program is known by what
it is made from: its function and its fixed arguments, the shapes of its data, the source of this package, the
versions of JAX and the processor (:mod:`jaxswarm.program_names`). One that cannot be known so, or not be read,
is compiled as ever.
"""

import functools
import hashlib
import inspect
import uuid
from collections.abc import Callable
from pathlib import Path
from threading import Lock
from typing import Any

import jax
import numpy as np

from jaxswarm.program_files import read, write
from jaxswarm.program_names import PLAIN, Unknown, described, settings
from jaxswarm.room import holds_programs

# The folder beside JAX's own compiled code.
FOLDER = "jaxswarm-programs"
_CONFIG: Any = jax.config  # its settings have no types


class Program:
    """A function as compiled programs, one for each fixed argument and each shape of its data.

    Within another program, on several devices and without a compile cache it is that of :func:`jax.jit`.

    Args:
        function: Pure, of positional arguments.
        static: Names of the arguments that are fixed, hashable.

    >>> double = Program(lambda x: 2 * x)
    >>> double(np.ones(2)).tolist()
    [2.0, 2.0]
    """

    def __init__(self, function: Callable, static: tuple[str, ...] = ()):
        functools.update_wrapper(self, function)
        self._function = function
        self._jit: Any = jax.jit(function, static_argnames=static)
        parameters = inspect.signature(function).parameters
        self._fixed = [name in static for name in parameters]
        self._defaults = [p.default for p in parameters.values()]
        # What is fixed is known by where it stands in memory, and so kept from being replaced there.
        self._ready: dict[tuple, tuple[Callable, tuple]] = {}
        # Two threads that ask for the same make it once, and then run it at the same time.
        self._making = Lock()
        self._traced: set[tuple] = set()
        holds_programs(self)

    def __call__(self, *args: Any) -> Any:
        """What the function gives."""
        args = (*args, *self._defaults[len(args) :])
        fixed = tuple(x for x, is_fixed in zip(args, self._fixed, strict=True) if is_fixed)
        data = tuple(x for x, is_fixed in zip(args, self._fixed, strict=True) if not is_fixed)
        leaves, tree = jax.tree.flatten(data)
        kinds = _kinds(leaves)
        if kinds is None:
            return self._jit(*args)
        place = (_handle(fixed), tree, kinds, _CONFIG.jax_enable_x64)
        folder = _folder()
        if folder is None:
            return self._called(place, *args)
        found = self._ready.get(place)
        if found is None:  # another thread may let go of it before it is called
            with self._making:
                found = self._ready.get(place)
                if found is None:
                    given = tree, tuple(map(_shape, kinds))
                    found = self._ready[place] = self._program(folder, place, given, args), fixed
        return found[0](*data)

    def _called(self, place: tuple, *args: Any) -> Any:
        """What the function gives where nothing is kept on disk; traced by one thread."""
        if place in self._traced:
            return self._jit(*args)
        with self._making:
            found = self._jit(*args)
            self._traced.add(place)
        return found

    def forget(self) -> None:
        """Let go of the programs of this process; what is kept on disk stays."""
        self._ready.clear()
        self._traced.clear()
        self._jit.clear_cache()

    @property
    def made(self) -> int:
        """Programs that this process has made or read."""
        return len(self._ready) + self._jit._cache_size()

    def _program(self, folder: Path, place: tuple, given: tuple, args: tuple) -> Callable:
        """The program for arguments, read or made; the function itself where it cannot be kept."""
        fixed = tuple(x for x, is_fixed in zip(args, self._fixed, strict=True) if is_fixed)
        try:
            told = [described(self._function), described(fixed), repr(given), settings()]
        except Unknown:
            called = functools.partial(self._called, place)
            return functools.partial(_with_fixed, called, self._fixed, fixed)
        name = hashlib.sha256("\n".join(told).encode()).hexdigest()
        found = read(folder / name)
        if found is None:
            found = self._compiled(args)
            write(folder / name, found)
        return found

    def _compiled(self, args: tuple) -> Any:
        """The program for arguments, made here: what JAX read from its own cache cannot be written again."""

        def alone(*given: Any) -> Any:
            return self._function(*given)

        # A name that no cache has.
        alone.__name__ = f"{getattr(self._function, '__name__', 'program')}_{uuid.uuid4().hex}"
        places = [k for k, is_fixed in enumerate(self._fixed) if is_fixed]
        return jax.jit(alone, static_argnums=places).lower(*args).compile()


def program(*static: str) -> Callable[[Callable], Program]:
    """Decorator: the function as a :class:`Program` whose arguments of these names are fixed."""
    return lambda function: Program(function, static)


def _with_fixed(function: Callable, is_fixed: list[bool], fixed: tuple, *data: Any) -> Any:
    """Call a function with its fixed arguments and its data, each in their order."""
    parts = iter(fixed), iter(data)
    return function(*(next(parts[0] if one else parts[1]) for one in is_fixed))


def _kinds(leaves: list) -> tuple[tuple, ...] | None:
    """What of data a program is compiled for; None within another program, which holds no data.

    Asked thousands of times: types stand for themselves here, whose names take longer than all else.
    """
    found: list[tuple] = []
    for x in leaves:
        if isinstance(x, jax.core.Tracer):
            return None
        if isinstance(x, (np.ndarray, np.generic)):
            found.append((x.shape, x.dtype))
        elif isinstance(x, jax.Array):
            found.append((x.shape, x.dtype, getattr(x, "weak_type", False)))
        else:
            found.append((type(x),))
    return tuple(found)


def _shape(kind: tuple) -> Any:
    """One of :func:`_kinds` in words that hold in another process."""
    if len(kind) == 1:
        return kind[0].__name__
    shape, dtype, *weak = kind
    return (shape, str(dtype), *weak) if weak else (shape, dtype.str)


def _handle(fixed: Any) -> Any:
    """What is fixed by its value if it is plain, else by where it stands in memory: quicker than its hash."""
    if isinstance(fixed, tuple):
        return tuple(_handle(x) for x in fixed)
    return fixed if isinstance(fixed, PLAIN) else id(fixed)


def _folder() -> Path | None:
    """Where programs are kept; None where they are not."""
    config = _CONFIG
    place = config.jax_compilation_cache_dir
    off = not config.jax_enable_compilation_cache or config.jax_disable_jit or config.jax_debug_nans
    if off or not place or "://" in place or not _is_alone():
        return None
    return _within(place)


@functools.cache
def _within(place: str) -> Path:
    """The folder of programs in the one of JAX's own: to put a path together takes longer than to call one."""
    return Path(place) / FOLDER


@functools.cache
def _is_alone() -> bool:
    """Whether there is one device, and it is a processor."""
    return jax.device_count() == 1 and jax.devices()[0].platform == "cpu"
