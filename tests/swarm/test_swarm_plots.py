"""Pictures show what was given: lines, bands, marks, and what is refused."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.swarm import Bound, Front, Space
from jaxswarm.swarm.plots import convergence_bands, ecdf, front_plot, swarm_over_time, sweep_map


def line(figure, number=0):
    return figure.axes[0].lines[number].get_xydata()


def test_bands_are_quartiles_and_a_run_that_arrived_counts_as_lowest():
    history = np.array([[8.0, 4.0, 0.0], [8.0, 2.0, 0.0], [8.0, 6.0, 5.0]]) + 3.0
    figure = convergence_bands({"swarm": history}, per_step=20, floor=3.0)
    np.testing.assert_allclose(line(figure)[:2], [[20.0, 8.0], [40.0, 4.0]])
    assert np.isnan(line(figure)[2, 1])
    band = figure.axes[0].collections[0].get_paths()[0].vertices
    for bound in (3.0, 5.0):  # the quartiles of 2, 4, 6
        assert any(np.allclose(vertex, [40.0, bound]) for vertex in band)


def test_reached_targets_by_hand():
    history = np.array([[5.0, 0.5, 2.0], [0.05, 0.05, 0.005]])
    figure = ecdf({"swarm": history}, [1.0, 0.1, 0.01], per_step=10, dims=2)
    np.testing.assert_allclose(line(figure), [[5.0, 2 / 6], [10.0, 3 / 6], [15.0, 4 / 6]])


def test_the_best_pair_is_marked():
    values = np.array([[3.0, 2.0, 4.0], [5.0, 1.0, 6.0]])
    figure = sweep_map(values[..., None] * [0.5, 1.0, 9.0], [0.4, 0.6], [1.0, 1.5, 2.0])
    assert line(figure).tolist() == [[1.0, 1.0]]
    np.testing.assert_allclose(figure.axes[0].images[0].get_array(), values)
    assert "first=0.6, second=1.5" in figure.axes[0].get_title()


def test_steps_of_a_swarm_in_the_units_of_its_space():
    positions = np.random.default_rng(0).uniform(size=(30, 5, 2))
    space = Space(a=Bound(0.1, 10.0, "log"), b=(-2.0, 4.0))
    figure = swarm_over_time(
        positions, lambda p, _: jnp.log(p["a"]) ** 2 + p["b"] ** 2, space=space
    )
    shown = [axis for axis in figure.axes if axis.get_visible()]
    assert [axis.get_title() for axis in shown][:1] == ["step 0"]
    assert shown[-1].get_title() == "step 29"
    np.testing.assert_array_equal(shown[-1].lines[0].get_xydata(), positions[29])
    assert [text.get_text() for text in shown[0].get_xticklabels()] == ["0.1", "1", "10"]
    assert [text.get_text() for text in shown[0].get_yticklabels()] == ["-2", "1", "4"]


def test_every_pair_of_objectives():
    figure = front_plot({"swarm": np.eye(3)}, names=("mass", "cost", "noise"))
    pairs = [(axis.get_xlabel(), axis.get_ylabel()) for axis in figure.axes]
    assert pairs == [("mass", "cost"), ("mass", "noise"), ("cost", "noise")]


@pytest.mark.parametrize(
    "draw, message",
    [
        (lambda: convergence_bands({}), "nothing to draw"),
        (lambda: swarm_over_time(np.zeros((3, 4, 3))), r"give \(steps, n, 2\)"),
        (lambda: swarm_over_time(np.zeros((3, 4, 2)), lambda x, _: 0.0), "without the space"),
        (lambda: sweep_map(np.ones((2, 3)), [1.0], [1.0]), "for 1 and 1 coefficients"),
        (lambda: front_plot({"a": np.ones((2, 2)), "b": np.ones((2, 3))}), "same number"),
    ],
)
def test_what_cannot_be_drawn_is_named(draw, message):
    with pytest.raises(InputError, match=message):
        draw()


def test_values_below_zero_are_drawn_on_a_straight_axis():
    history = -np.arange(1.0, 5.0)
    figure = convergence_bands({"swarm": np.stack([history, history - 1.0])})
    np.testing.assert_allclose(line(figure), [[k, -k - 0.5] for k in (1, 2, 3, 4)])
    assert figure.axes[0].get_yscale() == "linear"


@pytest.mark.parametrize("draw", [convergence_bands, lambda given: ecdf(given, [1.0])])
def test_runs_of_different_length_are_refused(draw):
    with pytest.raises(InputError, match="different length"):
        draw({"swarm": [[2.0, 1.0], [3.0]]})


def test_a_front_is_drawn_as_it_is_found():
    found = Front({}, np.array([[0.0, 1.0], [1.0, 0.0]]), np.zeros((2, 1)))
    assert line(front_plot({"swarm": found})).tolist() == [[0.0, 1.0], [1.0, 0.0]]
