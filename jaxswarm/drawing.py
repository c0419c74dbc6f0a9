"""Pictures drawn by a process of their own while the command goes on computing.

Drawing asks for no more than arrays and pictures of plain arrays (:mod:`jaxswarm.plots`); the library for it
takes half a second to load. Orders go through files of a temporary folder, so that neither process waits for
the other before the end. Several orders are drawn at the same time. What the other process cannot do is drawn
here.
"""

import importlib
import os
import pickle
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from jaxswarm import cores

_CHILD = "from jaxswarm.drawing import serve; serve()"
# Modules with pictures, which the other process loads before it is asked.
_PICTURES = ("plots", "loop_plots")
# How long [s] to wait for pictures before they are drawn here; they take a second each.
_PATIENCE = 60.0


class Drawing:
    """Pictures on order: a context that starts the other process and ends it.

    >>> import numpy as np
    >>> with Drawing() as drawing:
    ...     drawing.ask("a.png", "plots.convergence", {"one": np.array([[3.0, 2.0]])}, 1.0)
    ...     drawing.finished()["a.png"][1:4]
    b'PNG'
    """

    def __init__(self) -> None:
        self._orders: dict[str, tuple] = {}
        self._folder: tempfile.TemporaryDirectory | None = None
        self._process: subprocess.Popen | None = None

    def __enter__(self) -> "Drawing":
        if cores.count() > 1:  # on a single one it would only stand in the way
            try:
                self._folder = tempfile.TemporaryDirectory(prefix="jaxswarm-")
                self._process = _start(self._folder.name)
            except OSError:
                self._process = None
        return self

    def ask(self, name: str, picture: str, *arguments) -> None:
        """Order a picture.

        Args:
            name: Of its file.
            picture: Module of this package, and a function in it that gives a figure: ``plots.convergence``.
            arguments: Its arguments, plain arrays and words.
        """
        self._orders[name] = (picture, arguments)
        if self._process is None or self._folder is None or self._process.stdin is None:
            return
        place = Path(self._folder.name) / str(len(self._orders))
        try:
            place.with_suffix(".order").write_bytes(pickle.dumps(self._orders[name]))
            self._process.stdin.write(f"{place}\n".encode())
            self._process.stdin.flush()
        except OSError:  # it is gone, or the disk is full
            self._end()

    def finished(self) -> dict[str, bytes]:
        """All ordered pictures as PNG files' contents, by name."""
        done = {}
        if self._process is not None:
            try:
                self._process.communicate(timeout=_PATIENCE)
            except (OSError, subprocess.TimeoutExpired):
                self._end()
        for number, name in enumerate(self._orders, 1):
            picture, arguments = self._orders[name]
            done[name] = self._fetched(number) or draw(picture, arguments)
        return done

    def _fetched(self, number: int) -> bytes | None:
        if self._folder is None:
            return None
        try:
            return (Path(self._folder.name) / f"{number}.png").read_bytes()
        except OSError:
            return None

    def _end(self) -> None:
        if self._process is not None:
            if hasattr(os, "killpg"):  # with those that draw for it
                with suppress(ProcessLookupError, PermissionError):
                    os.killpg(self._process.pid, signal.SIGKILL)
            self._process.kill()
            self._process.wait()
            self._process = None

    def __exit__(self, *error) -> None:
        self._end()
        if self._folder is not None:
            self._folder.cleanup()


def draw(picture: str, arguments: Iterable) -> bytes:
    """A picture, by its module and function in this package, drawn here, as a PNG file's content."""
    module, _, name = picture.rpartition(".")
    figure = getattr(importlib.import_module(f"jaxswarm.{module}"), name)(*arguments)
    return importlib.import_module("jaxswarm.plots").png_bytes(figure)


def _start(folder: str) -> subprocess.Popen:
    """A process of the same Python with the same modules, which an interrupt of the terminal spares.

    Args:
        folder: Where orders and pictures are.
    """
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    return subprocess.Popen(
        [sys.executable, "-P", "-c", _CHILD, folder, str(os.getpid())],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=environment,
        start_new_session=True,
    )


def serve() -> None:
    """Draw what the lines of stdin name, until they end; what fails is left to who asked for it.

    Whoever was killed cannot remove the folder of the orders any more: then it is removed here. Taking down
    what Python has loaded would take a fifth of a second, for which the other process would wait.
    """
    folder, parent = sys.argv[1:]
    try:
        _serve()
    finally:
        if hasattr(os, "fork") and os.getppid() != int(parent):
            shutil.rmtree(folder, ignore_errors=True)
        os._exit(0)


def _serve() -> None:
    for picture in _PICTURES:
        importlib.import_module(f"jaxswarm.{picture}")
    at_work: list[int] = []
    for line in sys.stdin.buffer:
        place = Path(line.decode().rstrip("\n"))
        if not hasattr(os, "fork"):
            _fill(place)
            continue
        if len(at_work) == cores.count():
            os.waitpid(at_work.pop(0), 0)
        # A copy of this process has everything loaded; there are no threads whose locks it would inherit.
        child = os.fork()
        if child == 0:
            try:
                _fill(place)
            finally:
                os._exit(0)
        at_work.append(child)
    for child in at_work:
        os.waitpid(child, 0)


def _fill(place: Path) -> None:
    """Draw an order."""
    content = draw(*pickle.loads(place.with_suffix(".order").read_bytes()))
    part = place.with_suffix(".part")
    part.write_bytes(content)
    part.replace(place.with_suffix(".png"))
