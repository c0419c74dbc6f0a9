"""Damaged robot files end in one message that names file and place, or in a finite robot."""

import copy
import json
import re
import tomllib
import warnings
from xml.etree import ElementTree

import numpy as np
import pytest
from robot_files import BLOCKS, TABLE, TREE, gripper_arm, joint, link

from jaxswarm.errors import InputError
from jaxswarm.robot import Joint, build_robot, load_robot, parse_options, robot_from_urdf

WORDS = (
    *("nan", "inf", "-inf", "1e308", "-1", "0", "", " ", "0 0 0", "1 2", "nan 0 0", "a", "1_0"),
    *("9" * 70, "0x10", "\u0663", "j1", "l1", "finger2", "fixed", "floating", "${x}", "--", "<>&"),
)
VALUES = (
    *(1, -1, 0, 10**70, 10**400, 1e308, float("nan"), float("inf"), True, "", "x", "nan", "a\nb"),
    *(
        [],
        [[]],
        [1],
        ["1", "2"],
        [None],
        [[0, 0], [0, 0]],
        {},
        {"a": 1},
        [float("nan")] * 3,
        [0] * 3,
    ),
    *([1, [2]], ["revolute", 3], [-1.0] * 10),
)


def check(load):
    """Only an InputError, or a robot of finite numbers and usable names; no warning, either."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            robot = load()
        except InputError as error:
            return str(error)
    for array in (robot.rotation, robot.translation, robot.axis, robot.gravity, robot.parameters):
        assert np.isfinite(array).all()
    np.testing.assert_allclose(np.linalg.norm(robot.axis, axis=1), 1.0)
    assert all(isinstance(name, str) and name.strip() for name in robot.joints)
    return None


def mutated_xml(rng, text):
    """The document with one to three of its parts changed, by structure."""
    root = ElementTree.fromstring(text)
    for _ in range(rng.integers(1, 4)):
        elements = list(root.iter())
        parent = elements[rng.integers(len(elements))]
        action = rng.integers(6)
        if action == 0 and len(parent):
            parent.remove(parent[rng.integers(len(parent))])
        elif action == 1 and len(parent):
            parent.append(copy.deepcopy(parent[rng.integers(len(parent))]))
        elif action == 2:
            parent.tag = str(rng.choice(["joint", "link", "robot", "mass", "origin", "mimic"]))
        elif parent.attrib:
            key = str(rng.choice(list(parent.attrib)))
            if action == 3:
                del parent.attrib[key]
            else:
                parent.set(key, WORDS[rng.integers(len(WORDS))])
    return ElementTree.tostring(root, encoding="unicode")


@pytest.mark.parametrize("seed", range(4))
def test_mutated_urdf(seed):
    rng = np.random.default_rng(seed)
    texts = [mutated_xml(rng, source) for source in (gripper_arm(), TREE) for _ in range(60)]
    outcomes = [check(lambda text=text: robot_from_urdf(text, source="arm.urdf")) for text in texts]
    refused = [message for message in outcomes if message]
    assert all("arm.urdf" in message and len(message) < 400 for message in refused)
    assert 20 < len(refused) < 120


def toml(value):
    """A value as TOML text; what the format cannot hold is left as it is for the parser to refuse."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(k)} = {toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, bool | str):
        return json.dumps(value)
    return repr(value)


def mutated_toml(rng, text):
    """The document with one to three entries changed, at any depth."""
    document = tomllib.loads(text)
    for _ in range(rng.integers(1, 4)):
        place, key = document, str(rng.choice(list(document)))
        while isinstance(place[key], dict | list) and len(place[key]) and rng.random() < 0.8:
            place = place[key]
            inner = list(place) if isinstance(place, dict) else list(range(len(place)))
            key = inner[rng.integers(len(inner))]
        if rng.random() < 0.2:
            del place[key]
        else:
            place[key] = copy.deepcopy(VALUES[rng.integers(len(VALUES))])
        if not document:
            break
    return "\n".join(f"{json.dumps(k)} = {toml(v)}" for k, v in document.items())


@pytest.mark.parametrize("seed", range(4))
def test_mutated_toml(seed, tmp_path):
    rng = np.random.default_rng(seed)
    path = tmp_path / "arm.toml"
    refused = 0
    for source in (TABLE, BLOCKS):
        for _ in range(60):
            path.write_text(mutated_toml(rng, source))
            message = check(lambda: load_robot(path))
            refused += message is not None
            assert message is None or (str(path) in message and len(message) < 500)
    assert 20 < refused < 120


URDF = f'<robot name="r">{link("a")}{link("b")}{link("c")}{joint("j", "a", "b")}{{}}</robot>'
SECOND = joint("k", "b", "c")


def spoil(old, new):
    return URDF.format(SECOND).replace(old, new, 1)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (spoil('xyz="0 0 0.3"', 'xyz="0 nan 0.3"'), "joint 'j': origin xyz = '0 nan 0.3'"),
        (spoil('rpy="0 0 0"', 'rpy="0 inf 0"'), "joint 'j': origin rpy = '0 inf 0'"),
        (spoil('axis xyz="0 0 1"', 'axis xyz="0 0 nan"'), "joint 'j': axis xyz = '0 0 nan'"),
        (spoil('axis xyz="0 0 1"', 'axis xyz="0 0 0"'), "is no direction"),
        (spoil('ixx="0.1"', 'ixx="nan"'), "link 'a': inertia ixx = 'nan'"),
        (
            spoil('mass value="1.0"', 'mass value="-2"'),
            "link 'a': mass value = -2 kg is below zero",
        ),
        (spoil('mass value="1.0"', "mass"), "link 'a': mass value is missing"),
        (spoil('joint name="j"', "joint"), "joint number 1: <joint> has no name"),
        (spoil('joint name="j"', 'joint name=" "'), "joint number 1: <joint> has no name"),
        (spoil('joint name="k"', 'joint name="j"'), "joint name 'j' occurs twice"),
        (spoil('link name="b"', 'link name="a"'), "link name 'a' occurs twice"),
        (spoil('joint name="k"', 'joint name="k&#10;l"'), "cannot be printed"),
        (URDF.format(""), "the links 'a', 'c' hang on no joint"),
        (URDF.format(joint("k", "c", "c")), "form a loop"),
        (spoil('<parent link="a"/>', ""), "joint 'j' has no <parent>"),
        (spoil("revolute", "rotary"), "of type 'rotary'"),
        (spoil("<robot", "<robots").replace("</robot>", "</robots>"), "its root is <robots>"),
        ('<!DOCTYPE r [<!ENTITY a "b">]>' + URDF.format(SECOND), "document type"),
        ("<robot>" + "<a>" * 5000 + "</a>" * 5000 + "</robot>", "elements inside each other"),
    ],
)
def test_bad_urdf_names_place_value_and_remedy(text, message):
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        robot_from_urdf(text, source="arm.urdf")
    assert "arm.urdf" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("joint = 1", "joint = 1: a list of [[joint]] blocks"),
        ("joint = [1]", "number 1 has no name"),
        ("dh = 3", "dh = 3: a table"),
        (TABLE.replace("[0.1, 0]", f"[{'9' * 70}, 0]"), "[dh]: d = [9999"),
        (TABLE.replace("[0.1, 0]", "[[0.1], [0]]"), "[dh]: d = [[0.1], [0]]"),
        (TABLE.replace("[0.1, 0]", "[nan, 0]"), "[dh]: d = [nan, 0]"),
        (TABLE.replace("[0.1, 0]", '["0.1", "0"]'), "[dh]: d = ['0.1', '0']"),
        (TABLE.replace('"modified"', "[1]"), "convention = [1] is no text"),
        (TABLE.replace('["a", "b"]', "[1, 2]"), "joints = [1, 2]: a list of texts"),
        (TABLE.replace('["a", "b"]', '["a", ""]'), "has no name"),
        (TABLE.replace("[[1, 0", "[[-1, 0"), "mass -1 kg is below zero"),
        (TABLE.replace('"two"', "2"), "name = 2 is no text"),
        (BLOCKS.replace('"turn"', "5"), "[[joint]] number 2: its name 5 is no text"),
        (BLOCKS.replace('"prismatic"', "[]"), "joint 'lift': kind = [] is no text"),
        (BLOCKS.replace('parent = "lift"', "parent = 1"), "joint 'turn': parent = 1 is no text"),
        ("a = " + "[" * 5000 + "]" * 5000, "nested too deep"),
        (f"a = {'9' * 5000}", "not valid TOML"),
    ],
)
def test_bad_toml_names_place_value_and_remedy(text, message, tmp_path):
    path = tmp_path / "arm.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        load_robot(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("name", ["arm.urdf", "arm.xml", "arm.toml"])
def test_bytes_that_are_no_text_are_refused(name, tmp_path):
    path = tmp_path / name
    path.write_bytes(bytes(range(256)))
    with pytest.raises(InputError, match=re.escape(str(path))):
        load_robot(path)


@pytest.mark.parametrize("spec", ["x" * 5000 + ".urdf", "a\0b.urdf", "folder.urdf"])
def test_paths_that_cannot_be_files_are_refused(spec, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.urdf").mkdir()
    with pytest.raises(InputError, match="does not exist"):
        load_robot(spec)


@pytest.mark.parametrize(
    "spoiled",
    [
        {"translation": [0, np.nan, 0]},
        {"rotation": np.full((3, 3), np.inf)},
        {"parameters": [np.nan] * 10},
        {"parameters": [0.0] * 9},
        {"axis": [0, np.inf, 0]},
        {"name": 3},
    ],
)
def test_joints_made_in_python_are_checked_as_well(spoiled):
    with pytest.raises(InputError):
        build_robot("arm", [Joint(**{"name": "a", **spoiled})])


def test_ten_thousand_joints_are_refused_unless_a_chain_is_chosen(tmp_path):
    """Reading takes time proportional to the joints; what cannot be computed is refused."""
    count = 10_000
    parts = [f'<link name="l{k}"/>' for k in range(count + 1)]
    ends = '<parent link="l{}"/><child link="l{}"/></joint>'
    parts += [
        f'<joint name="j{k}" type="revolute">' + ends.format(k, k + 1)
        for k in reversed(range(count))
    ]
    path = tmp_path / "long.urdf"
    path.write_text(f"<robot>{''.join(parts)}</robot>")
    with pytest.raises(InputError, match="10000 moving joints, at most 300.*--joints"):
        load_robot(path)
    assert load_robot(path, parse_options("j5,j9000")).joints == ("j5", "j9000")
