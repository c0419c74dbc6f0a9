"""The RX60 study: its formulas by hand, its targets, and that reconstructions are named."""

import json

import jax
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.robot import inverse_dynamics, rx60
from jaxswarm.studies import run_rx60
from jaxswarm.studies.rx60 import figures as rx60_figures
from jaxswarm.studies.rx60 import loop as rx60_loop
from jaxswarm.studies.rx60 import paper
from jaxswarm.studies.rx60.cause import stable_acceleration
from jaxswarm.studies.rx60.data import (
    READINGS,
    Experiment,
    averaged,
    compress,
    experiment,
    motion,
    relative_error,
)
from jaxswarm.studies.rx60.search import COORDINATES, base_of, scheme, search, view


@pytest.fixture(scope="module")
def small():
    return experiment(samples=141)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rx60")
    return run_rx60(folder, fast=True), folder


@pytest.mark.parametrize("reading", READINGS)
def test_motions_are_consistent(reading):
    t = np.linspace(0.0, 7.0, 7001)
    q, dq, ddq = motion(reading, 0.6, -1.1, t)
    np.testing.assert_allclose(np.gradient(q, t, axis=0)[1:-1], dq[1:-1], atol=2e-6)
    np.testing.assert_allclose(np.gradient(dq, t, axis=0)[1:-1], ddq[1:-1], atol=2e-6)


def test_unknown_reading_is_refused():
    with pytest.raises(InputError, match="Did you mean c t"):
        motion("c tau", 1.0, 1.0, np.zeros(1))


def test_columns_are_the_robot(small):
    at = 37
    tau = inverse_dynamics(rx60(), small.q[at], small.dq[at], small.ddq[at])
    np.testing.assert_allclose(small.columns[at] @ paper.TRUE, tau, atol=1e-12)


def test_fitness_by_hand(small):
    """The compressed fitness is the paper's formula over all samples."""
    rng = np.random.default_rng(0)
    noisy = Experiment(small.t, small.q, small.dq, small.ddq, small.tau + rng.normal(size=(141, 3)))
    theta = paper.TRUE + rng.normal(size=13)
    error = noisy.tau - noisy.columns @ theta
    by_hand = np.sqrt(sum(np.mean(error[:, j] ** 2) for j in range(3)))
    np.testing.assert_allclose(compress(noisy).fitness(theta), by_hand, rtol=1e-12)


def test_relative_error_by_hand():
    data = experiment(samples=141)
    half = Experiment(data.t, data.q, data.dq, data.ddq, 2.0 * data.tau)
    expected = np.abs(data.tau).sum(0) / np.abs(2.0 * (data.tau - data.tau.mean(0))).sum(0)
    np.testing.assert_allclose(relative_error(half, paper.TRUE), expected)
    assert relative_error(data, paper.TRUE).max() < 1e-12


def test_averaging_keeps_means():
    data = averaged(experiment(samples=141), 50)
    assert data.tau.shape == (2, 3)
    np.testing.assert_allclose(data.t, [24.5 * 0.05, 74.5 * 0.05])


def test_eleven_of_thirteen(small):
    problem = compress(small)
    base = base_of(problem)
    assert base.expressions()[0] == "Czz1 + Byy2 + Byy3" and base.size == 11
    np.testing.assert_allclose(base.reduce(paper.TRUE)[0], 8.7345, atol=1e-9)
    moved = paper.TRUE + 0.3 * (np.eye(13)[0] - np.eye(13)[2] - np.eye(13)[1])
    assert problem.fitness(moved) < 1e-12


@pytest.mark.parametrize("coordinates", COORDINATES)
def test_coordinates_describe_the_same_problem(small, coordinates):
    problem = compress(small)
    at, raw = view(problem, coordinates), view(problem)
    rng = np.random.default_rng(1)
    theta = rng.uniform(raw.lower, raw.upper)
    x = np.linalg.lstsq(at.to_base, raw.to_base @ theta, rcond=None)[0]
    value = np.sqrt(((at.factor @ x - at.target) ** 2).sum() + at.rest)
    np.testing.assert_allclose(value, problem.fitness(theta), rtol=1e-9)
    if coordinates != "raw":
        assert (x >= at.lower - 1e-9).all() and (x <= at.upper + 1e-9).all()


def test_evaluations_to_a_level(small):
    at = view(compress(small))
    found = search(at, scheme("aelspso", 5), jax.random.key(0), runs=2, num_steps=5)
    assert found.per_step == 25  # the learning trial is counted
    assert found.evaluations_to(np.inf) == 25.0 and found.evaluations_to(-1.0) is None


def test_stability_edge():
    """c1 + c2 = 4 is stable exactly for w between 1/3 and 1/2."""
    assert stable_acceleration(1 / 3) == pytest.approx(4.0)
    assert stable_acceleration(0.4) > 4.0 > stable_acceleration(0.55)


def test_targets(study):
    result, _ = study
    met = {t["target"]: t["met"] for t in result["targets"]}
    for name in ("GPSO clean: fbest, worst run", "AELSPSO clean: fbest, worst run"):
        assert met[name]
    assert met["GPSO clean: RAE, worst run and joint"]
    assert met["GPSO noisy: fbest over least squares, worst run"]
    for j in (1, 2, 3):
        assert met[f"noisy RAE joint {j}, averaged signals, mean of ten noise draws"]


def test_least_squares_is_the_floor(study):
    result, _ = study
    floor = {row["case"]: row["fbest"] for row in result["least_squares"]}
    for case in result["cases"]:
        assert case["fbest_mean"] >= floor[case["case"]] - 1e-12


def test_cause(study):
    rows = {(r["coordinates"], r["c"]): r for r in study[0]["cause"]["coordinates"]}
    assert rows["raw", 2.0]["aelspso_is"] == "better"
    assert rows["raw", 1.3]["aelspso_is"] == "worse"
    # The blind directions are not the cause: in base coordinates it loses all the same.
    assert rows["base", 1.3]["aelspso_is"] == "worse"


def test_no_rigid_body(study):
    physics = study[0]["physics"]
    assert "1.073" in physics["violations"]["link 3"][0]
    found = physics["constrained"]["parameters"]
    assert abs(found["Axx3"] - found["Byy3"]) <= found["Czz3"] + 1e-6
    assert physics["constrained"]["fbest"] > 0.01


def test_report_names_reconstructions(study):
    result, folder = study
    page = (folder / "report.html").read_text()
    written = json.loads((folder / "rx60.json").read_text())
    assert written["reconstructions"] and page.count("Reconstruction: ") >= len(
        written["reconstructions"]
    )
    assert "://" not in page and page.count("data:image/png") == len(list(folder.glob("*.png")))
    assert len(list(folder.glob("torque_*.png"))) == 4


def test_loop_section():
    """The errors before and after stand on the page with the effect that was found; no loop, no section."""
    assert rx60_loop.section({}, {}) == []
    swarm = {"rms": [0.5, 0.25, 0.125], "base_mean": [8.0]}
    row = {"hidden": "friction", "torque_noise": 0.2, "base": ["Czz1"], "base_true": [9.0]}
    row |= {"gpso": swarm, "aelspso": swarm}
    effects = [{"effect": "coulomb_friction", "joint": "joint1", "values": {"fc": 3.0}}]
    row["loop"] = {
        "effects": effects,
        "before": [0.5] * 3,
        "after": [0.0625] * 3,
        "verdict": "explained",
    }
    figure = rx60_figures.loop([row])
    assert len(figure.axes) == 1 and len(figure.axes[0].patches) == 4 * 3
    text = "".join(rx60_loop.section({"loop": [row]}, {"loop.png": b""}))
    assert "coulomb_friction on joint1 (fc = 3)" in text and "0.0625" in text and "0.125" in text
