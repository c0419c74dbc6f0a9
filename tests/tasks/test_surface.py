"""From Python: functions under their names in every order of imports, logs from arrays, results that show."""

import subprocess
import sys

import numpy as np
import pytest

import jaxswarm
from jaxswarm.errors import InputError

ORDERS = (
    "import jaxswarm.diagnose.selection.stepwise, jaxswarm.identify.run, jaxswarm.simulate",
    "from jaxswarm import diagnose; import jaxswarm.diagnose.selection.stepwise",
    "import jaxswarm; jaxswarm.diagnose; from jaxswarm.diagnose import Rules",
)
CHECK = """
import types, sys
from jaxswarm import diagnose, identify, simulate
from jaxswarm.diagnose import Rules, Diagnosis
from jaxswarm.identify.run import Options
from jaxswarm.simulate import PD
for function in (diagnose, identify, simulate):
    assert isinstance(function, types.FunctionType), function
assert isinstance(sys.modules["jaxswarm.diagnose"], types.ModuleType)
"""


@pytest.mark.parametrize("order", ORDERS)
def test_tasks_are_functions_in_every_order_of_imports(order):
    done = subprocess.run(
        [sys.executable, "-W", "error::ImportWarning", "-c", f"{order}\n{CHECK}"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def slide_arrays(length=800, seed=0):
    """A slide of 20 kg with b = 30 N s/m and fc = 5 N, noise of 0.1 N."""
    rng = np.random.default_rng(seed)
    t = np.arange(length) * 0.01
    w = 2 * np.pi * np.array([0.4, 1.1])[:, None]
    size = np.array([[0.2], [0.05]])
    q = (size * np.sin(w * t)).sum(axis=0)
    dq = (size * w * np.cos(w * t)).sum(axis=0)
    ddq = -(size * w**2 * np.sin(w * t)).sum(axis=0)
    tau = 20 * ddq + 30 * dq + 5 * np.tanh(dq / 0.01) + 0.1 * rng.normal(size=length)
    return t, q, tau


def test_arrays_to_a_model_in_single_precision_sessions(tmp_path):
    import jax

    t, q, tau = slide_arrays()
    log = jaxswarm.log_from_arrays(t, q, tau, joints=("slide",))
    with jax.enable_x64(False):
        found = jaxswarm.identify(log, "emps")
        path = found.save(tmp_path / "model.json")
        again = jaxswarm.predict(path, log)
        assert found.plot().axes
    values = {row["name"]: row["value"] for row in found["base_parameters"]}
    assert values["m1"] == pytest.approx(20, rel=0.01)
    assert again.tau.shape == (800, 1)
    assert np.sqrt(np.mean((again.tau[50:-50, 0] - tau[50:-50]) ** 2)) < 0.5
    assert "viscous_friction@slide" in repr(found)
    assert "<table>" in found._repr_html_() and "fc" in found._repr_html_()


def test_arrays_to_a_verdict():
    t, q, tau = slide_arrays()
    log = jaxswarm.log_from_arrays(t, q, tau, joints=("slide",))
    found = jaxswarm.diagnose(log, "emps", "viscous_friction")
    assert [(e["effect"], e["joint"]) for e in found["effects"]] == [("coulomb_friction", "slide")]
    assert "coulomb_friction" in repr(found)
    assert found.model.terms[-1].effect == "coulomb_friction"


def test_what_is_added_has_to_survive_on_validation_logs_as_in_the_command():
    """They were scored on only, and the function said other things than the command of its name."""
    t, q, tau = slide_arrays()
    without = 5.0 * np.sign(np.gradient(q, t)) - tau
    other = jaxswarm.log_from_arrays(t, -q, without, joints=("slide",))
    log = jaxswarm.log_from_arrays(t, q, tau, joints=("slide",))
    found = jaxswarm.diagnose(log, "emps", "viscous_friction", validation=other)
    assert found["effects"] == []
    # And all that might stand in its place, asked without it.
    assert found["refused"][0]["effect"] == "coulomb_friction"
    assert all("the error of slide on arrays" in one["because"] for one in found["refused"])
    assert len(found["logs"]) == len(found["validation_logs"]) == 1


BAD = {
    "runs backwards": lambda t, q, tau: (t[::-1], q, tau),
    "Transpose": lambda t, q, tau: (t, np.stack([q, q]), np.stack([tau, tau])),
    "row 6, column tau": lambda t, q, tau: (t, q, np.where(np.arange(len(t)) == 5, np.nan, tau)),
    "is it in ms?": lambda t, q, tau: (1e3 * t, q, tau),
    "no torque": lambda t, q, tau: (t, q, None),
    "tau has shape": lambda t, q, tau: (t, q, tau[:-1]),
    "not real numbers": lambda t, q, tau: (t, q + 0j, tau),
    "is no array": lambda t, q, tau: (t, [[1.0], [1.0, 2.0]], tau),
}


@pytest.mark.parametrize("words", BAD)
def test_arrays_are_checked_as_files_are(words):
    t, q, tau = slide_arrays(100)
    with pytest.raises(InputError, match=words.replace("?", r"\?")):
        joints = ("a", "b") if words == "Transpose" else None
        jaxswarm.log_from_arrays(*BAD[words](t, q, tau), joints=joints)


def test_a_log_of_another_robot_is_refused():
    log = jaxswarm.log_from_arrays(*slide_arrays(100))
    with pytest.raises(InputError, match="joint1, the robot EMPS|joint1, the robot emps"):
        jaxswarm.identify(log, "emps")
