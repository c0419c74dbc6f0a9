"""Two things that changed at once: the first choice is made while both are left, and is made again."""

import numpy as np

import jaxswarm
from jaxswarm.diagnose.report.text import verdict_sentence


def slide(mass, friction, seed, phase):
    """Twelve seconds of a slide with viscous friction of 30 N s/m and noise of 0.1 N."""
    t = np.arange(0.0, 12.0, 0.005)
    waves = ((0.2, 2.5, phase), (0.05, 7.0, 0.3))
    q = sum(a * np.sin(w * t + p) for a, w, p in waves)
    dq = sum(a * w * np.cos(w * t + p) for a, w, p in waves)
    ddq = -sum(a * w * w * np.sin(w * t + p) for a, w, p in waves)
    noise = 0.1 * np.random.default_rng(seed).normal(size=t.size)
    force = mass * ddq + 30.0 * dq + friction * np.tanh(dq / 0.01) + noise
    return jaxswarm.log_from_arrays(t, q, force, joints=("slide",))


def test_a_load_and_friction_are_told_as_such_and_no_gain_takes_a_little_of_both():
    model = jaxswarm.identify(slide(20.0, 5.0, 0, 0.0), "emps", "viscous_friction,coulomb_friction")
    found = jaxswarm.diagnose(slide(24.0, 9.0, 1, 0.7), "emps", model=model.model)
    assert found["verdict"] == "explained"
    told = {e["effect"]: e for e in (*found["effects"], *found["changed"])}
    assert len(told) == 2 and "coulomb_friction" in told
    friction = told.pop("coulomb_friction")["parameters"]["fc"]
    assert abs(friction["value"] - 9.0) < 3.0 * friction["std_error"]
    # On a single slide a body and the inertia of a rotor are one and the same: the other is a rival.
    (load,) = told.values()
    kinds = {load["effect"], *(other["effect"] for other in load["alternatives"])}
    assert {"payload", "rotor_inertia"} <= kinds
    (mass,) = (row["value"] for row in load["parameters"].values())
    assert abs(mass - 4.0) < 0.02


def test_a_load_that_was_put_down_is_told_with_its_sign():
    """No inertia that can only grow explains it, and no gain takes friction with it."""
    model = jaxswarm.identify(slide(20.0, 5.0, 0, 0.0), "emps", "viscous_friction,coulomb_friction")
    found = jaxswarm.diagnose(slide(16.0, 3.0, 1, 0.7), "emps", model=model.model)
    assert found["verdict"] == "explained"
    (load,), (friction,) = found["effects"], found["changed"]
    mass, slid = load["parameters"]["m"], friction["parameters"]["fc"]
    assert load["effect"] == "payload" and load["way"] == "taken off"
    assert abs(mass["value"] + 4.0) < 0.02 and mass["std_error"] < 0.01
    assert "payload (taken off)" in verdict_sentence(found)
    assert "changed effects" in repr(found) and "added effects" in repr(found)
    assert abs(slid["change"]["value"] + 2.0) < 0.03
    weighed = found.model.robot.parameters[-1, 0] - model.model.robot.parameters[-1, 0]
    assert abs(weighed + 4.0) < 0.02
