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
