"""model.json: the round trip gives the same torque, and whatever is damaged is refused by name."""

import copy
import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from small_problems import make_motion, planar_arm

from jaxswarm.errors import InputError
from jaxswarm.identify import Model, load_model, model_torque, parse_terms, save_model
from jaxswarm.identify.forward.uncertainty import Uncertainty
from jaxswarm.logs.motion import Filtering

EFFECTS = "viscous_friction,stribeck_friction@joint1,hysteresis@joint2,transmission_coupling@joint1"


@pytest.fixture(scope="module")
def model():
    arm = planar_arm()
    terms = parse_terms(EFFECTS, arm.joints)
    for term in terms:
        term.values.update(term.law.nominal())
    known = Uncertainty(("Izz1", "b_joint1:viscous_friction"), np.array([[2.0, 0.1], [0.1, 3.0]]))
    return Model(
        arm, terms, (0.02, 0.02), Filtering(12.0, 6.0, True), (0.1, 0.2), uncertainty=known
    )


@pytest.fixture(scope="module")
def content(model, tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "model.json"
    save_model(model, path)
    return json.loads(path.read_text())


def write(path, content):
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def test_round_trip_gives_the_same_torque(model, content, tmp_path):
    again = load_model(write(tmp_path / "model.json", content))
    motion = make_motion(model.robot, length=50)
    np.testing.assert_array_equal(model_torque(again, motion), model_torque(model, motion))
    assert again.filtering == model.filtering
    assert again.sigma == model.sigma
    assert again.terms == model.terms
    assert [t.values for t in again.terms] == [t.values for t in model.terms]
    save_model(again, tmp_path / "again.json")
    assert json.loads((tmp_path / "again.json").read_text()) == content


def test_a_file_from_before_a_law_had_a_shape_has_the_usual_one(content, tmp_path):
    older, law = copy.deepcopy(content), "torque_constant_saturation"
    bent = {"effect": law, "joint": "joint1", "other": None, "values": {"c": 0.02}}
    older["terms"].append(bent)
    again = load_model(write(tmp_path / "model.json", older))
    assert again.terms[-1].values == {"c": 0.02, "n": 1.0, "at": 1.0}
    motion = make_motion(again.robot, length=50)
    plain = load_model(write(tmp_path / "plain.json", content))
    torque = np.asarray(model_torque(plain, motion))
    torque[:, 0] *= 1.0 - 0.02 * np.abs(torque[:, 0])
    np.testing.assert_allclose(model_torque(again, motion), torque, atol=1e-9)


def test_a_file_from_before_axes_could_point_apart_says_the_same(model, content, tmp_path):
    older = copy.deepcopy(content)
    coupling = next(t for t in older["terms"] if t["effect"] == "transmission_coupling")
    coupling["values"]["fc"] = 2.0
    values = {**coupling["values"], "fd": 0.0}
    whole = write(tmp_path / "whole.json", {**older, "terms": [{**coupling, "values": values}]})
    del coupling["values"]["fd"]
    part = write(tmp_path / "part.json", {**older, "terms": [coupling]})
    motion = make_motion(model.robot, length=50)
    np.testing.assert_array_equal(*(model_torque(load_model(x), motion) for x in (whole, part)))


def test_missing_and_unreadable_files(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        load_model(tmp_path / "model.json")
    with pytest.raises(InputError, match="cannot be read"):
        load_model(tmp_path)
    for text in ("", "{", "not json", "[1, 2", '{"format": 1'):
        with pytest.raises(InputError, match="JSON"):
            load_model(write(tmp_path / "model.json", text))
    for text in ("[]", "3", "null", '"text"', "{}"):
        with pytest.raises(InputError, match="no jaxswarm model"):
            load_model(write(tmp_path / "model.json", text))
    (tmp_path / "model.json").write_bytes(b"\xff\xfe\x00binary")
    with pytest.raises(InputError, match="cannot be read"):
        load_model(tmp_path / "model.json")


@pytest.mark.parametrize("version", [0, 2, "1", None])
def test_other_formats_are_refused(content, tmp_path, version):
    with pytest.raises(InputError, match="format"):
        load_model(write(tmp_path / "model.json", {**content, "format": version}))


def places(tree, path=()):
    """Every place in a nested JSON value, as a tuple of keys."""
    yield path
    items = (
        tree.items()
        if isinstance(tree, dict)
        else enumerate(tree)
        if isinstance(tree, list)
        else ()
    )
    for key, value in items:
        yield from places(value, (*path, key))


def change(tree, path, value):
    tree = copy.deepcopy(tree)
    at = tree
    for key in path[:-1]:
        at = at[key]
    if value is DELETE:
        del at[path[-1]]
    else:
        at[path[-1]] = value
    return tree


DELETE = object()
REQUIRED = [
    ("robot",), ("robot", "joints"), ("robot", "kinds"), ("robot", "parents"),
    ("robot", "rotation"), ("robot", "axis"), ("robot", "gravity"), ("robot", "parameters"),
    ("robot", "drive_gain"), ("terms",), ("terms", 0, "effect"), ("terms", 0, "joint"),
    ("terms", 0, "values"), ("terms", 0, "values", "b"), ("width",), ("filtering",), ("sigma",),
]  # fmt: skip


@pytest.mark.parametrize("path", REQUIRED, ids=lambda p: ".".join(map(str, p)))
@pytest.mark.parametrize(
    "value", [DELETE, "text", {}, 7.5e300], ids=["gone", "text", "object", "huge"]
)
def test_damage_is_refused_or_harmless(content, tmp_path, path, value):
    if value == 7.5e300 and path[-1] == "width":
        pytest.skip("a sign that wide is none")
    with pytest.raises(InputError, match="model.json"):
        load_model(write(tmp_path / "model.json", change(content, path, value)))


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("terms", 0, "effect"), "viscos_friction"),
        (("terms", 0, "joint"), "joint9"),
        (("terms", 0, "joint"), None),
        (("terms", 0, "values", "b"), None),
        (("terms", 0, "values", "b"), "large"),
        (("terms", 0, "values", "b"), float("nan")),
        (("robot", "gravity", 0), "1.0"),
        (("robot", "rotation", 0, 0, 0), "1.0"),
        (("robot", "kinds", 0), "spherical"),
        (("robot", "parents", 0), 5),
        (("robot", "parents", 1), 1),
        (("robot", "parameters", 0, 0), None),
        (("robot", "joints"), ["joint1"]),
        (("robot", "joints"), ["joint1", "joint1"]),
        (("width",), 0.0),
        (("width",), -1.0),
        (("filtering", "motion_cutoff"), "fast"),
        (("filtering", "motion_cutoff"), -3.0),
        (("sigma",), ["a", "b"]),
        (("sigma",), [0.1]),
    ],
    ids=str,
)  # fmt: skip
def test_values_without_a_meaning_are_refused(content, tmp_path, path, value):
    with pytest.raises(InputError, match="model.json"):
        load_model(write(tmp_path / "model.json", change(content, path, value)))


@settings(max_examples=80, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_random_damage_never_breaks_the_reader(content, tmp_path, data):
    path = data.draw(st.sampled_from([p for p in places(content) if p]))
    value = data.draw(
        st.one_of(
            st.just(DELETE), st.none(), st.booleans(), st.integers(-3, 3), st.floats(),
            st.text(max_size=3), st.lists(st.integers(-1, 2), max_size=3), st.just({}),
        )
    )  # fmt: skip
    try:
        found = load_model(write(tmp_path / "model.json", change(content, path, value)))
    except InputError as error:
        assert "model.json" in str(error)
    else:
        assert isinstance(found, Model)
        motion = make_motion(planar_arm(), length=20)
        if path[0] != "robot":  # another robot would be another compiled program
            assert model_torque(found, motion).shape == (20, 2)


def test_the_covariance_of_the_parameters_survives_and_old_files_go_without(
    model, content, tmp_path
):
    found = load_model(write(tmp_path / "model.json", content)).uncertainty
    size = len(found.columns)
    assert found.covariance.shape == (size, size) and "b_joint1:viscous_friction" in found.columns
    np.testing.assert_array_equal(found.covariance, model.uncertainty.covariance)
    old = {k: v for k, v in content.items() if k != "uncertainty"}
    assert load_model(write(tmp_path / "model.json", old)).uncertainty is None
    for damaged in ([], {"columns": ["a"], "covariance": [[1.0, 2.0]]}, {"columns": ["a"]}):
        with pytest.raises(InputError, match="model.json"):
            load_model(write(tmp_path / "model.json", {**content, "uncertainty": damaged}))
    negative = {"columns": ["a"], "covariance": [[-1.0]]}
    with pytest.raises(InputError, match="no covariance can be"):
        load_model(write(tmp_path / "model.json", {**content, "uncertainty": negative}))
