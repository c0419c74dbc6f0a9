"""identify with other estimators and with rigid bodies for links, from logs whose truth is known."""

import json
from pathlib import Path

import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.identify.physical.consistency import are_bodies
from jaxswarm.identify.report.console import consistency_lines, estimator_lines
from jaxswarm.identify.run import Options, identify_files

TRUTH = {"m1": 20.0, "b_slide": 30.0, "fc_slide": 5.0}
FRICTION = "viscous_friction,coulomb_friction"


def write_slide(path: Path, noise=0.0, reference=True, length=1500):
    """A slide that follows its command exactly; its encoder adds noise, its motor torque some too."""
    rng = np.random.default_rng(1)
    t = np.arange(length) * 0.01
    w = 2 * np.pi * np.array([0.3, 0.9, 1.7])[:, None]
    size = np.array([[0.2], [0.06], [0.02]])
    q, dq = (size * np.sin(w * t)).sum(axis=0), (size * w * np.cos(w * t)).sum(axis=0)
    ddq = -(size * w**2 * np.sin(w * t)).sum(axis=0)
    tau = 20 * ddq + 30 * dq + 5 * np.tanh(dq / 0.01) + 0.2 * rng.normal(size=length)
    columns, names = [t, q + noise * rng.normal(size=length), tau], "t,q_slide,tau_slide"
    if reference:
        columns, names = [*columns, q], names + ",q_ref_slide"
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=names, comments="")
    return path


def values(report):
    return {row["name"]: row["value"] for row in report["base_parameters"]}


@pytest.mark.parametrize("estimator", ["instrumental", "output_error"])
def test_other_estimators_find_the_truth(tmp_path, estimator):
    log = write_slide(tmp_path / "log.csv", noise=1e-5)
    options = Options(estimator=estimator)
    report = identify_files([log], "emps", FRICTION, tmp_path / "out", None, options)
    for name, truth in TRUTH.items():
        assert values(report)[name] == pytest.approx(truth, rel=0.02), name
    assert report["estimator"]["name"] == estimator
    assert estimator_lines(report)
    kept = json.loads((tmp_path / "out" / "identification.json").read_text())
    assert kept["estimator"]["name"] == estimator
    effects = {e["effect"]: e["parameters"] for e in report["effects"]}
    assert effects["viscous_friction"]["b"]["value"] == pytest.approx(30.0, rel=0.02)
    assert effects["viscous_friction"]["b"]["std_error"] > 0.0


def test_instruments_remove_the_bias_of_a_noisy_encoder(tmp_path):
    log = write_slide(tmp_path / "log.csv", noise=2e-3)
    masses = {}
    for estimator in ("least_squares", "instrumental"):
        # A cutoff far too high lets the noise into the acceleration, where it attenuates the mass.
        options = Options(estimator=estimator, motion_cutoff=12.0, torque_cutoff=10.0)
        out = tmp_path / estimator
        report = identify_files([log], "emps", FRICTION, out, None, options)
        masses[estimator] = values(report)["m1"]
    assert abs(masses["least_squares"] - 20.0) > 4.0
    assert masses["instrumental"] == pytest.approx(20.0, abs=1.0)
    assert report["estimator"]["least_squares_biased"]


def test_what_an_estimator_needs_is_told(tmp_path):
    log = write_slide(tmp_path / "log.csv", reference=False)

    def refused(words, effects=FRICTION, **options):
        with pytest.raises(InputError, match=words):
            identify_files([log], "emps", effects, tmp_path / "out", None, Options(**options))
        assert not (tmp_path / "out").exists()

    refused("commanded positions", estimator="instrumental")
    refused("Did you mean output_error", estimator="outputerror")
    refused("leave out one", estimator="output_error", optimizer="gpso")
    refused("changes the motion", effects="time_delay", estimator="output_error")
    refused("has joints", physical=True, prior="rx60")


def test_bodies_are_told_by_default_and_enforced_on_demand(data_root, tmp_path):
    log = data_root / "cases" / "p01" / "train.npz"
    report = identify_files([log], "rx60", FRICTION, tmp_path / "out", None, Options(physical=True))
    told = report["physical_consistency"]
    # MuJoCo made this log with rigid bodies: to have some costs nothing.
    assert all(link["possible"] for link in told["links"]) and told["enforced"]
    assert max(told["torque_moved_over_residual"]) < 0.05
    assert "rigid bodies" in consistency_lines(report)[-1]
    from jaxswarm.identify import load_model

    assert are_bodies(load_model(tmp_path / "out" / "model.json").robot)


def test_a_reversed_torque_is_no_body(tmp_path):
    log = write_slide(tmp_path / "log.csv")
    table = np.loadtxt(log, delimiter=",", skiprows=1)
    table[:, 2] *= -1.0
    np.savetxt(log, table, delimiter=",", header="t,q_slide,tau_slide,q_ref_slide", comments="")
    accepted = Options(accept=("torque_sign",))
    report = identify_files([log], "emps", FRICTION, tmp_path / "out", options=accepted)
    (link,) = report["physical_consistency"]["links"]
    assert not link["possible"] and "m1" in link["reasons"][0]
    assert any("no rigid body has" in line for line in consistency_lines(report))
