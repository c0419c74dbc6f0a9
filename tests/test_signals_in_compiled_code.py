"""A signal ends a command while compiled code computes, and does not wait for it."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import jax
import pytest

from jaxswarm.waiting import wait_for

ROOT = Path(__file__).resolve().parents[1]
# A command whose threads go on, as those of compiled code do.
COMMAND = """
import os, signal, threading, time
from jaxswarm import cli
def work():
    threading.Thread(target=time.sleep, args=(120.0,)).start()
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(5.0)
cli._command = work
cli.command_line()
"""

# Nothing of Python runs in the main thread while it reads what a program has yet to compute, for minutes.
WAITS = """
import os, signal, threading
import jax, numpy
from pathlib import Path
from jaxswarm import cli, work
@jax.jit
def slow(x):
    return jax.lax.fori_loop(0, 10_000_000, lambda _, y: jax.numpy.sin(y) + 0.1, x)
def waits():
    with work.work(Path("out"), (), resumable=True):
        found = slow(jax.numpy.ones(20_000))
        threading.Timer(0.5, os.kill, (os.getpid(), SIGNAL)).start()
        numpy.asarray(found)
cli._command = waits
cli.command_line()
"""


class Ended(Exception):
    """What a signal raises."""


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timer that signals")
def test_a_signal_is_heard_while_a_program_runs():
    @jax.jit
    def slow(x, count):
        return jax.lax.fori_loop(0, count, lambda _, y: jax.numpy.sin(y) + 0.1, x)

    def end(number, frame):
        raise Ended

    many = jax.numpy.ones(20_000)  # what takes no time at all is computed at once, in the call
    wait_for(slow(many, 10))
    before = signal.signal(signal.SIGALRM, end)
    found = slow(many, 50_000)  # seconds, on any machine
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(Ended):
            wait_for({"found": found, "other": 1.0})
        assert not found.is_ready()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def test_a_command_that_is_ended_leaves_its_threads():
    begun = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-c", COMMAND],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        timeout=100.0,
        check=False,
    )
    assert (done.returncode, done.stderr.decode()) == (143, "terminated\n")
    assert time.monotonic() - begun < 60.0


@pytest.mark.parametrize(
    ("number", "code", "word"),
    [(signal.SIGTERM, 143, "terminated"), (signal.SIGINT, 130, "interrupted")],
)
def test_a_command_ends_though_its_main_thread_does_not_hear_the_signal(
    number, code, word, tmp_path
):
    """It waited for the end of the program, however long."""
    begun = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-c", WAITS.replace("SIGNAL", str(int(number)))],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        cwd=tmp_path,
        capture_output=True,
        timeout=200.0,
        check=False,
    )
    kept = "the same command goes on from what is kept in out"
    assert (done.returncode, done.stderr.decode().splitlines()) == (code, [kept, word])
    assert time.monotonic() - begun < 100.0
