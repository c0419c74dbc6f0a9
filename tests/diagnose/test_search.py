"""The swarms' search of nonlinear parameters, on columns without noise."""

import time
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from planted import log_with, small_arm

from jaxswarm.diagnose.candidates import search
from jaxswarm.diagnose.candidates.search import searching
from jaxswarm.diagnose.folds.fold_data import FoldData, decimate, explained
from jaxswarm.effects import REGISTRY, get_law
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.lattice import lattice_of, ordered, points_of, seen_of
from jaxswarm.effects.sample import Sample
from jaxswarm.effects.series import law_columns
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.columns import rigid_of, term_columns
from jaxswarm.logs.filtering import Decimator, design_decimator
from jaxswarm.logs.motion import Filtering, prepare

WIDTHS = (0.01, 0.01)
PLANTED = [
    ("stribeck_friction", {"vs": 0.11, "delta": 1.6}, [3.0]),
    ("torque_ripple", {"n": 23.37}, [0.6, -0.4]),
    ("hysteresis", {"x0": 0.043}, [2.0]),
    ("thermal_drift", {"tc": 7.3}, [4.0]),
    ("nonlinear_viscous_friction", {"alpha": 0.47}, [2.0]),
    ("load_dependent_friction", {"inertial": 0.35}, [0.1]),
]


@pytest.fixture(scope="module")
def motion():
    return prepare(log_with(), Filtering(20.0, 10.0))


@pytest.fixture(scope="module")
def load(motion):
    rigid = rigid_of(small_arm(), motion)
    pi = np.asarray(small_arm().parameters).ravel()
    return rigid.load(pi)


def fall(columns, fold, positive):
    """What columns (T', k) explain of one fold's residual."""
    folds = jax.tree.map(lambda x: jnp.asarray(x)[None], fold)
    return float(explained(jnp.asarray(columns)[None], folds, positive)[0, 0])


def stages_of(motion, residual, basis=None, weight=None):
    """One joint's residual for both joints and two folds: all rows, and every second one."""
    length = len(residual)
    basis = np.zeros((length, 1)) if basis is None else basis
    weight = np.ones(length) if weight is None else weight
    folds = []
    for train in (np.ones(length), (np.arange(length) // 20 % 2).astype(float)):
        own = basis * train[:, None], residual * train, train, weight
        folds.append(FoldData(*map(jnp.asarray, own)))
    joint = jax.tree.map(lambda *x: jnp.stack(x), *folds)
    return jax.tree.map(lambda *x: jnp.stack(x), joint, joint)


@pytest.mark.parametrize(("effect", "values", "linear"), PLANTED)
def test_planted_parameters_are_recovered(motion, load, key, effect, values, linear):
    term = Term(effect, 1, values=values)
    columns = motion.decimator.apply(term_columns(term, motion, WIDTHS, load))
    residual = columns @ np.array(linear)
    stages = stages_of(motion, residual)
    task = (get_law(effect), 1, None)
    with searching([task], [motion], WIDTHS, [load], [stages], key) as finish:
        found = [*finish()]
    for fold, weight in zip(found[0], np.asarray(stages.train[0]), strict=True):
        placed = Term(effect, 1, values=fold)
        again = motion.decimator.apply(term_columns(placed, motion, WIDTHS, load))
        a, y = again * weight[:, None], residual * weight
        left = y - a @ np.linalg.lstsq(a, y, rcond=None)[0]
        # Close to the floor of the valley, which is long for two parameters: the refit ends there.
        missed = 0.01 if len(values) == 1 else 0.03
        assert np.linalg.norm(left) < missed * np.linalg.norm(y)
        for name, value in values.items():
            assert fold[name] == pytest.approx(value, rel=0.1 if len(values) == 1 else 0.15)


def test_a_search_weighs_a_law_as_the_residual_is_weighed(motion, load, key):
    """The jump of a friction that fell within four of 45 s was looked for at the start: what was far from most
    counted less in what was left, and not in the law."""
    term = Term("torque_ripple", 1, values={"n": 17.0})
    columns = motion.decimator.apply(term_columns(term, motion, WIDTHS, load))
    torque = columns @ np.array([0.5, -0.4])
    weight = np.where(np.arange(len(torque)) % 3 == 0, 1.0, 0.02)
    other = 2.0 * np.sin(9.0 * motion.decimator.apply(motion.q)[:, 1])
    stages = stages_of(motion, weight * np.where(weight < 1.0, other, torque), weight=weight)
    law = (get_law("torque_ripple"), 1, None)
    with searching([law], [motion], WIDTHS, [load], [stages], key) as finish:
        assert next(finish())[0]["n"] == pytest.approx(17.0, rel=0.02)


@pytest.mark.parametrize("effect", ["hysteresis", "thermal_drift"])
def test_logs_are_searched_together(motion, load, key, effect):
    values = {"hysteresis": {"x0": 0.043}, "thermal_drift": {"tc": 7.3}}[effect]
    short = prepare(log_with(seed=2, motion_seed=8, duration=7.0), Filtering(20.0, 10.0))
    rigid = rigid_of(small_arm(), short)
    pi = np.asarray(small_arm().parameters).ravel()
    motions, loads = [short, motion], [rigid.load(pi), load]
    term = Term(effect, 1, values=values)
    columns = [
        m.decimator.apply(term_columns(term, m, WIDTHS, x))[:, 0]
        for m, x in zip(motions, loads, strict=True)
    ]
    law = (get_law(effect), 1, None)

    def found(size):
        parts = [size * columns[0], 2.0 * columns[1]]
        stages = [stages_of(m, part) for m, part in zip(motions, parts, strict=True)]
        with searching([law], motions, WIDTHS, loads, stages, key) as finish:
            return next(finish())[0]

    ((name, value),) = values.items()
    alike = found(2.0)[name]
    assert alike == pytest.approx(value, rel=0.02)
    # The same law with another sign in the first log is no law: both are looked at.
    assert abs(found(-2.0)[name] - value) > 2.0 * abs(alike - value)


@pytest.mark.parametrize("length", [301, 1500])
@pytest.mark.parametrize(("rate", "cutoff"), [(125.0, 10.0), (250.0, 31.7), (100.0, 45.0)])
def test_decimate_equals_the_decimator_of_the_logs(length, rate, cutoff):
    low = design_decimator(rate, cutoff)
    x = np.random.default_rng(0).normal(size=(length, 3))
    ours = decimate(jnp.asarray(x), jnp.asarray(low.taps), low.factor)
    np.testing.assert_allclose(ours, low.apply(x), atol=1e-12)


def test_decimate_with_a_single_tap_keeps_every_sample():
    x = np.arange(12.0).reshape(6, 2)
    ours = decimate(jnp.asarray(x), jnp.ones(1), 1)
    np.testing.assert_array_equal(ours, Decimator(np.ones(1), 1).apply(x))


def test_explained_is_the_fall_of_the_squared_error_by_a_refit():
    rng = np.random.default_rng(3)
    model, columns, y = rng.normal(size=(80, 4)), rng.normal(size=(80, 2)), rng.normal(size=80)
    basis = np.linalg.qr(model)[0]
    residual = y - basis @ (basis.T @ y)
    stage = FoldData(*map(jnp.asarray, (basis, residual, *np.ones((2, 80)))))

    def cost(a):
        return ((y - a @ np.linalg.lstsq(a, y, rcond=None)[0]) ** 2).sum()

    fell = cost(model) - cost(np.column_stack([model, columns]))
    assert fall(columns, stage, False) == pytest.approx(fell, rel=1e-6)


def test_a_coefficient_of_the_wrong_sign_explains_nothing():
    column = np.sin(np.arange(50.0))[:, None]
    own = np.zeros((50, 1)), -2.0 * column[:, 0], *np.ones((2, 50))
    stage = FoldData(*map(jnp.asarray, own))
    assert fall(column, stage, True) == 0.0
    assert fall(column, stage, False) > 1.0


@pytest.mark.parametrize(("size", "refined"), [(-1.0, False), (1.0, True)])
def test_only_what_explains_something_is_refined(motion, load, key, size, refined):
    term = Term("hysteresis", 1, values={"x0": 0.043})
    law = motion.decimator.apply(term_columns(term, motion, WIDTHS, load))[:, 0]
    # Hysteresis takes energy: with the other sign the law explains nothing.
    stages = stages_of(motion, size * law)
    task = (get_law("hysteresis"), 1, None)
    with searching([task], [motion], WIDTHS, [load], [stages], key) as finish:
        found = next(finish())
    (parameter,) = ordered(get_law("hysteresis"))
    points = points_of(get_law("hysteresis"))
    lattice, _ = lattice_of(1, points, (points, 1))
    tried = np.array([float(parameter.decode(u)) for u in lattice[:, 0]])
    for fold in found:
        beside = np.abs(tried / fold["x0"] - 1.0).min()
        assert (beside > 1e-6) == refined


def test_a_search_that_is_left_does_not_go_on(motion, load, key, monkeypatch):
    begun = []
    plain = search.best_of

    def slow(*args):
        begun.append(1)
        time.sleep(0.2)
        return plain(*args)

    monkeypatch.setattr(search, "best_of", slow)
    stages = stages_of(motion, motion.decimator.apply(motion.tau)[:, 1])
    tasks = [(get_law(effect), 1, None) for effect, _, _ in PLANTED] * 3
    with pytest.raises(KeyboardInterrupt):
        with searching(tasks, [motion], WIDTHS, [load], [stages], key):
            raise KeyboardInterrupt
    time.sleep(1.0)
    assert len(begun) < len(tasks) / 2


@pytest.mark.parametrize("free", [1e-1, 1e-2, 1e-3])
def test_what_is_nearly_absorbed_is_explained_by_its_rest(free):
    """A column of which the model takes up all but a small part: what that part explains is not lost."""
    rng = np.random.default_rng(0)
    basis = np.linalg.qr(rng.normal(size=(300, 6)))[0]
    inside, rest = basis @ rng.normal(size=6), rng.normal(size=300)
    rest -= basis @ (basis.T @ rest)
    residual = rest + rng.normal(size=300)
    residual -= basis @ (basis.T @ residual)
    column = inside / np.linalg.norm(inside) + free * rest / np.linalg.norm(rest)
    fold = FoldData(*map(jnp.asarray, (basis, residual, *np.ones((2, 300)))))
    exact = (rest @ residual) ** 2 / (rest @ rest)
    assert fall(column[:, None], fold, False) == pytest.approx(exact, rel=2e-3)


def test_places_and_widths_are_looked_for_among_the_positions_seen():
    law = get_law("dead_zone_spring")
    low, span = seen_of(law, [np.array([-0.1, 0.3]), np.array([0.0, 0.2])], 3)
    gap, middle = ordered(law)
    assert (gap.name, middle.name) == ("gap", "q0")
    ends = [(p.decode(low[k]), p.decode(low[k] + span[k])) for k, p in enumerate((gap, middle))]
    np.testing.assert_allclose(ends, [(0.0, 0.4), (-0.1, 0.3)], atol=1e-12)
    np.testing.assert_array_equal((low[2], span[2]), (0.0, 1.0))


def test_what_is_no_place_is_looked_for_between_its_bounds():
    low, span = seen_of(get_law("stribeck_friction"), [np.array([-0.1, 0.3])], 2)
    np.testing.assert_array_equal(low, 0.0)
    np.testing.assert_array_equal(span, 1.0)


def test_no_searched_law_asks_for_a_sine_of_the_library():
    """XLA calls it for one sample after the other: half of the search of a ripple."""
    laws = [law for law in REGISTRY.values() if isinstance(law, TorqueLaw) and law.searched]
    assert "torque_ripple" in {law.name for law in laws}
    series = Sample(*np.ones((len(Sample._fields), 8)))
    for law in laws:
        values = {p.name: np.float64(p.nominal) for p in law.nonlinear}
        asked = jax.make_jaxpr(partial(law_columns, law))(values, series)
        assert not {"sin", "cos"} & set(str(asked).replace("[", " ").split()), law.name
