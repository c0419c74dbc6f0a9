"""The SEPSO study: plants against scipy and by hand, statistics, and that reconstructions are named."""

import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from jaxswarm.studies import run_sepso
from jaxswarm.studies.sepso import ours as sepso_ours
from jaxswarm.studies.sepso.claims import claims, sentences
from jaxswarm.studies.sepso.plants import DT, PLANTS, make_data, outputs, torque_problem
from jaxswarm.studies.sepso.search import comparisons, contest
from jaxswarm.studies.statistics import compare, effect_size, holm
from jaxswarm.swarm import sepso


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sepso")
    return run_sepso(folder, fast=True), folder


def _flexible(t, x):
    twist = 1200.0 * (x[0] - x[1])
    return [x[2], x[3], -5.0 * np.sin(x[0]) - twist, np.sin(2 * np.pi * t) + twist]


def _two_links(t, x):
    alpha, beta, eps, eta, e2 = 6.7333, 3.4, 3.0, 0.0, 9.8
    c2, s2, c12, s12 = np.cos(x[1]), np.sin(x[1]), np.cos(x[0] + x[1]), np.sin(x[0] + x[1])
    h12 = beta + eps * c2 + eta * s2
    h = np.array([[alpha + 2 * eps * c2 + 2 * eta * s2, h12], [h12, beta]])
    c = np.array(
        [
            [(-2 * eps * s2 + 2 * eta * c2) * x[3], (-eps * s2 + eta * c2) * x[3]],
            [(eps * s2 - eta * c2) * x[2], 0.0],
        ]
    )
    g2 = eps * e2 * c12 + eta * e2 * s12
    g = np.array([g2 + (alpha - beta) * e2 * np.cos(x[0]), g2])
    u = np.array([20.0 * np.sin(2 * np.pi * t), 10.0 * np.sin(4 * np.pi * t)])
    return [*x[2:], *np.linalg.solve(h, u - c @ x[2:] - g)]


@pytest.mark.parametrize(
    ("name", "slope"), [("flexible joint", _flexible), ("two links", _two_links)]
)
def test_plants_are_the_printed_equations(name, slope):
    plant = PLANTS[name]
    _, states = outputs(plant, plant.true)
    end = DT * len(states)
    exact = solve_ivp(slope, (0.0, end), plant.start, rtol=1e-10, atol=1e-12).y[:, -1]
    np.testing.assert_allclose(states[-1], exact, atol=2e-4 * np.abs(states).max())


@pytest.mark.parametrize("name", PLANTS)
def test_cost_is_zero_at_the_truth_only(name):
    plant = PLANTS[name]
    data = make_data(plant)
    population = np.stack([plant.true, 0.99 * plant.true])
    cost = np.asarray(plant.cost(jnp.asarray(population), data))
    assert cost[0] < 1e-20 < cost[1]
    residual = np.asarray(plant.residual(jnp.asarray(population[1]), data))
    np.testing.assert_allclose((residual**2).sum(), cost[1], rtol=1e-9)


@pytest.mark.parametrize("name", PLANTS)
def test_torque_error_is_linear_and_exact(name):
    factor, target, rest = torque_problem(PLANTS[name])
    solution = np.linalg.lstsq(factor, target, rcond=None)[0]
    np.testing.assert_allclose(solution, PLANTS[name].true, atol=1e-8)
    assert rest < 1e-20


def test_a_mass_matrix_of_no_arm_costs_infinitely():
    plant = PLANTS["two links"]
    assert np.isinf(plant.cost(jnp.array([[1.0, 3.0, 5.0, 0.0]]), make_data(plant)))[0]


def test_statistics_by_hand():
    assert effect_size([1.0, 3.0], [2.0, 3.0]) == (1 + 1 + 0 + 0.5) / 4
    assert compare(np.zeros(5), np.zeros(5)) == {"p": 1.0, "effect": 0.5}
    # Eight against eight, fully separated: 2 / C(16, 8).
    assert compare(np.arange(8), np.arange(8) + 100)["p"] == pytest.approx(2 / 12870, rel=1e-6)
    np.testing.assert_allclose(holm([0.02, 0.01]), [0.02, 0.02])


def test_equal_evaluations():
    plant = PLANTS["flexible joint"]
    keys = jax.random.split(jax.random.key(0), 2)
    data = make_data(plant)
    everyone = contest(plant, plant.cost, data, keys, (2, 3), ("SPSO",))
    # Without a schedule the short search is the beginning of the long one.
    assert everyone[3]["SPSO"].history.shape == (2, 3)
    assert (everyone[2]["SPSO"].history == everyone[3]["SPSO"].history[:, :2]).all()
    found = everyone[2] | contest(plant, plant.cost, data, keys, (2,), ("SEPSO R1",))[2]
    assert {r.history.shape for r in found.values()} == {(2, 2)}
    np.testing.assert_allclose(
        plant.cost(jnp.asarray(found["SEPSO R1"].parameters), data),
        found["SEPSO R1"].values,
        rtol=1e-9,
    )
    rows = comparisons(found)
    assert [r["on"] for r in rows] == ["cost", "accuracy"] and rows[0][
        "sepso_is"
    ] == "not told apart"


def test_a_setting_of_ours_is_sepso():
    """With the coefficients of R1 the searched family is R1 itself."""
    setting = {"inertia_start": 0.9, "inertia_end": 0.4, "cognitive": 2.0, "social": 2.0}
    setting |= {"repulsion": 0.1, "decay": 0.05, "velocity_limit": 0.2}
    assert set(sepso_ours.draw(3, 0)) == set(setting)
    mine, reference = sepso_ours.build("one swarm", setting, 70), sepso(40, 70)
    assert jax.tree.structure(mine) == jax.tree.structure(reference)
    assert jax.tree.leaves(mine) == jax.tree.leaves(reference)
    parts = sepso_ours.build(sepso_ours.STRUCTURES[1], setting, 70)
    assert parts.num * parts.inner.num_particles == 40


def test_claim_needs_both_rivals():
    def section(**words):
        rows = [
            {"sepso": "SEPSO R1", "rival": r, "on": "accuracy", "effect": 0.5, "sepso_is": w}
            for r, w in words.items()
        ]
        made = {"plant": "arm", "case": "clean", "budget": "tight", "comparisons": rows}
        return made | {"claims": claims(made)}

    one = section(SPSO="better", GA="not told apart")
    assert one["claims"][0]["holds_against"] == []
    assert "none of these settings" in sentences([one])[-1]
    both = section(SPSO="better", GA="better")
    assert both["claims"][0]["holds_against"] == [["SPSO", "GA"]]
    assert "arm, clean, tight budget (every reading" in sentences([one, both])[0]


def test_report_names_reconstructions(study):
    result, folder = study
    page = (folder / "report.html").read_text()
    written = json.loads((folder / "sepso.json").read_text())
    assert page.count("Reconstruction: ") >= len(written["reconstructions"]) > 0
    rows = [r for s in written["sections"] for r in s["rows"]]
    assert all(r["reconstruction"] == (r["optimizer"][:4] in ("SEPS", "SPSO")) for r in rows)
    assert "[reconstruction]" in page and "://" not in page
    assert any("claim" in text for text in result["findings"])


def test_polish_improves(study):
    for section in study[0]["sections"]:
        assert section["polish"]["cost_median"] <= section["polish"]["cost_before_median"]
