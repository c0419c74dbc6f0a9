"""Two results side by side: what differs beyond its interval is marked, and nothing else."""

import json

import numpy as np
import pytest

from jaxswarm import compare, identify, log_from_arrays
from jaxswarm.errors import InputError
from jaxswarm.outputs import to_json


def slide(friction=30.0, seed=0, length=800):
    rng = np.random.default_rng(seed)
    t = np.arange(length) * 0.01
    w = 2 * np.pi * np.array([0.4, 1.1])[:, None]
    size = np.array([[0.2], [0.05]])
    q = (size * np.sin(w * t)).sum(axis=0)
    dq = (size * w * np.cos(w * t)).sum(axis=0)
    ddq = -(size * w**2 * np.sin(w * t)).sum(axis=0)
    tau = 20 * ddq + friction * dq + 5 * np.tanh(dq / 0.01) + 0.5 * rng.normal(size=length)
    return log_from_arrays(t, q, tau, joints=("slide",))


@pytest.fixture(scope="module")
def results():
    return [identify(slide(*given), "emps") for given in ((30.0, 0), (30.0, 1), (33.0, 2))]


def differing(found):
    return {row["name"] for row in found["parameters"] if row["differs"]}


def test_the_same_arm_twice_and_another_friction(results):
    same, other = compare(results[0], results[1]), compare(results[0], results[2])
    assert differing(same) <= {"m1"} and "b" not in differing(same)
    assert "b" in differing(other)
    row = next(r for r in other["parameters"] if r["name"] == "b")
    assert row["difference"] == pytest.approx(3.0, abs=0.5)
    assert "differs" in repr(other) and "yes" in repr(other)


def test_folders_are_read_and_intervals_stand_beside_the_values(results, tmp_path):
    for name, found in zip("ab", (results[0], results[2]), strict=True):
        (tmp_path / name).mkdir()
        (tmp_path / name / "identification.json").write_text(to_json(found.content))
    told = compare(tmp_path / "a", tmp_path / "b")
    assert told.content["parameters"] == compare(results[0], results[2]).content["parameters"]
    row = next(r for r in told["parameters"] if r["name"] == "b")
    half = 1.96 * row["a"]["std_error"]
    assert f"{row['a']['value']:.5g} ± {half:.2g}" in repr(told)
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="empty: this folder holds none of diagnosis.json"):
        compare(tmp_path / "empty", tmp_path / "b")


def test_of_folders_with_results_of_two_kinds_the_models_are_compared(results, tmp_path):
    other = results[2].content | {"verdict": "explained", "steps": []}
    for name, found, content in (
        ("identification", results[0], results[0].content),
        ("diagnosis", results[2], other),
    ):
        (tmp_path / name).mkdir()
        (tmp_path / name / f"{name}.json").write_text(to_json(content))
        found.save(tmp_path / name / "model.json")
    told = compare(tmp_path / "identification", tmp_path / "diagnosis")
    assert told["kind"] == "a model" and "b" in differing(told)
    (tmp_path / "diagnosis" / "model.json").unlink()
    with pytest.raises(InputError, match="an identification and the second a diagnosis"):
        compare(tmp_path / "identification", tmp_path / "diagnosis")


def test_models_compare_by_torque_whatever_their_basis(results, tmp_path):
    paths = [r.save(tmp_path / f"{k}.json") for k, r in enumerate(results)]
    found = compare(paths[0], paths[2])
    assert found["kind"] == "a model"
    # A slide's torque is m ddq: the difference at random states is that of the masses.
    masses = [float(r.model.robot.parameters[0, 0]) for r in results]
    moved = found["torque_difference"]
    assert moved["rms"][0] / moved["torque_rms"][0] == pytest.approx(
        abs(masses[2] / masses[0] - 1), rel=1e-6
    )
    assert not differing(compare(paths[0], paths[0]))
    report, file = compare(results[0], results[2]), found
    for name in ("b", "fc"):  # the file holds intervals too, less what widths add
        one, two = (next(r for r in x["parameters"] if r["name"] == name) for x in (report, file))
        assert one["a"]["std_error"] == pytest.approx(two["a"]["std_error"], rel=0.1)
        assert one["differs"] == two["differs"]


def test_effects_of_one_side_are_told(results):
    bare = identify(slide(), "emps", "viscous_friction")
    found = compare(bare, results[0])
    assert {row["place"] for row in found["only_b"]} == {"coulomb_friction@slide"}
    assert not found["only_a"]


def test_what_does_not_belong_together_is_refused(results, tmp_path):
    path = results[0].save(tmp_path / "model.json")
    with pytest.raises(InputError, match="two of the same kind"):
        compare(path, results[0])
    with pytest.raises(InputError, match="no such file"):
        compare(path, tmp_path / "none.json")
    (tmp_path / "odd.json").write_text(json.dumps({"a": 1}))
    with pytest.raises(InputError, match="odd.json: is no model.json"):
        compare(path, tmp_path / "odd.json")


def _changed(content, keys, value):
    """The content with one of its values exchanged, or taken away where the value is ``...``."""
    inside = content
    for key in keys[:-1]:
        inside = inside[key]
    if value is ...:
        del inside[keys[-1]]
    else:
        inside[keys[-1]] = value
    return content


DAMAGED = [
    (("base_parameters", 0, "effect"), ...),
    (("base_parameters", 0, "value"), ...),
    (("base_parameters", 0, "value"), "heavy"),
    (("base_parameters", 0, "value"), 1e308),
    (("base_parameters", 0, "expression"), [1]),
    (("base_parameters", 0), None),
    (("base_parameters",), 3),
    (("effects",), {"a": 1}),
    (("effects", 0, "parameters"), []),
    (("error", "before", "rms"), 0.5),
    (("error", "before", "relative"), ...),
    (("error",), []),
    (("joints",), "slide"),
    (("torque_units",), None),
]


@pytest.mark.parametrize(("keys", "value"), DAMAGED)
def test_a_damaged_result_is_refused_with_its_place(results, tmp_path, keys, value):
    content = json.loads(to_json(results[0].content))
    if keys[:2] == ("error", "before"):
        content["error"]["before"] = {"rms": [0.1], "relative": [0.1], "relative_global": 0.1}
    path, good = tmp_path / "damaged.json", tmp_path / "good.json"
    good.write_text(to_json(results[0].content))
    path.write_text(json.dumps(_changed(content, keys, value)))
    with pytest.raises(InputError, match=f"damaged.json: .*{keys[0]}.*damaged") as caught:
        compare(path, good)
    assert len(str(caught.value)) < 300


def test_a_value_that_is_none_is_no_difference(results, tmp_path):
    content = json.loads(to_json(results[0].content))
    content["base_parameters"][0]["value"] = None
    paths = tmp_path / "a.json", tmp_path / "b.json"
    for path in paths:
        path.write_text(json.dumps(content))
    assert not differing(compare(*paths))
