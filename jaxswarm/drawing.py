"""Pictures drawn by a process of their own while the command goes on computing.

Drawing asks for no more than arrays and the pictures of :mod:`jaxswarm.plots`; the library for it takes
half a second to load. Orders go through files of a temporary folder, so that neither process waits for the
other before the end. What the other process cannot do is drawn here.
"""

import importlib
import os
import pickle
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

from jaxswarm import cores

_CHILD = "from jaxswarm.drawing import serve; serve()"
# How long [s] to wait for pictures before they are drawn here; they take a second each.
_PATIENCE = 60.0


class Drawing:
    """Pictures on order: a context that starts the other process and ends it.

    >>> import numpy as np
    >>> with Drawing() as drawing:
    ...     drawing.ask("a.png", "convergence", {"one": np.array([[3.0, 2.0]])}, 1.0)
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
        """Order a picture: the name of its file, of a function of :mod:`jaxswarm.plots`, its arguments."""
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
            self._process.kill()
            self._process.wait()
            self._process = None

    def __exit__(self, *error) -> None:
        self._end()
        if self._folder is not None:
            self._folder.cleanup()


def draw(picture: str, arguments: Iterable) -> bytes:
    """A picture of :mod:`jaxswarm.plots`, drawn here, as a PNG file's content."""
    plots = importlib.import_module("jaxswarm.plots")
    return plots.png_bytes(getattr(plots, picture)(*arguments))


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

    Whoever was killed cannot remove the folder of the orders any more: then it is removed here.
    """
    try:
        _serve()
    finally:
        folder, parent = sys.argv[1:]
        if hasattr(os, "fork") and os.getppid() != int(parent):
            shutil.rmtree(folder, ignore_errors=True)


def _serve() -> None:
    importlib.import_module("jaxswarm.plots")
    for line in sys.stdin.buffer:
        place = Path(line.decode().rstrip("\n"))
        content = draw(*pickle.loads(place.with_suffix(".order").read_bytes()))
        part = place.with_suffix(".part")
        part.write_bytes(content)
        part.replace(place.with_suffix(".png"))
