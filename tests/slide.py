"""A slide with friction as a log, and commands run on it in this process."""

import contextlib
import io
import sys

import numpy as np
import pytest

from jaxswarm.cli import main

EFFECTS = "viscous_friction,coulomb_friction"


def slide_log(length=600, seed=0):
    """Time, position and force of a slide of 20 kg with friction, as columns of text."""
    rng = np.random.default_rng(seed)
    t = np.arange(length) * 0.01
    w = 2 * np.pi * np.array([0.4, 1.1])[:, None]
    q = (np.array([[0.2], [0.05]]) * np.sin(w * t)).sum(axis=0)
    dq = (np.array([[0.2], [0.05]]) * w * np.cos(w * t)).sum(axis=0)
    ddq = -(np.array([[0.2], [0.05]]) * w**2 * np.sin(w * t)).sum(axis=0)
    tau = 20 * ddq + 30 * dq + 5 * np.tanh(dq / 0.01) + 0.1 * rng.normal(size=length)
    return [
        "t,q_slide,tau_slide",
        *(f"{a:.6f},{b:.8f},{c:.6f}" for a, b, c in zip(t, q, tau, strict=True)),
    ]


def run(*arguments):
    """Exit code, stdout and stderr of a command, in this process."""
    out, err = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["jaxswarm", *map(str, arguments)])
        patch.setenv("COLUMNS", "200")
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                main()
                code = 0
            except SystemExit as end:
                code = end.code or 0
    return code, out.getvalue(), err.getvalue()


def assert_refused(result, *words):
    """Exit code 2, nothing on stdout, one line of error that holds the words, no traceback."""
    code, out, err = result
    assert code == 2, (code, out, err)
    assert out == ""
    assert "Traceback" not in err
    lines = [line for line in err.splitlines() if line.strip()]
    assert len(lines) == 1, err
    assert lines[0].startswith("error: ")
    for word in words:
        assert word in err, f"{word!r} is not in {err}"


def identify(log, out, *more, robot="emps", effects=EFFECTS):
    return run("identify", log, "--robot", robot, "--effects", effects, "--out", out, *more)
