"""No file outside effects/ knows an effect by its name, and every kind of effect has every verb."""

import ast
import dataclasses
import re
from pathlib import Path

import pytest

from jaxswarm.diagnose.candidates.propose import propose
from jaxswarm.diagnose.selection.changed_model import apply_change
from jaxswarm.effects import REGISTRY, Effect
from jaxswarm.effects.contract import check_kind
from jaxswarm.identify.forward.own_columns import law_block
from jaxswarm.robot import Robot
from jaxswarm.simulate.plant import put_on

PACKAGE = Path(__file__).resolve().parents[1] / "jaxswarm"
# The robot has a field of this name, current to torque; the effect is a factor on the torque.
FIELDS = {field.name for field in dataclasses.fields(Robot)}
OLD_KINDS = {"elastic", "play", "gravity", "payload", "window", "gain", "delay"}
FILES = [
    path
    for path in sorted(PACKAGE.rglob("*.py"))
    if path.relative_to(PACKAGE).parts[0] != "effects"
]
KINDS = Effect.__subclasses__()
VERBS = (check_kind, law_block, propose, apply_change, put_on)


def strings(tree: ast.AST):
    """Every string of a program but the docstrings and the examples below a command's help."""
    told = set()
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and isinstance(body[0], ast.Expr):
            told.add(body[0].value)
        if isinstance(node, ast.keyword) and node.arg == "epilog":
            told.add(node.value)
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in told:
            yield node.value


def compared(tree: ast.AST):
    """Every string that a program compares something with or looks for something in."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            for side in (node.left, *node.comparators):
                yield from (c.value for c in ast.walk(side) if isinstance(c, ast.Constant))


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.relative_to(PACKAGE).as_posix())
def test_no_file_outside_effects_names_an_effect_or_a_kind(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    names = {*REGISTRY, *(kind.__name__ for kind in KINDS)} - FIELDS
    found = [text for text in strings(tree) if names & set(re.findall(r"\w+", text))]
    assert not found
    assert not OLD_KINDS & set(compared(tree))
    assert not [n for n in ast.walk(tree) if isinstance(n, ast.Attribute) and n.attr == "warp"]


def test_the_search_for_names_finds_them():
    tree = ast.parse('"""payload"""\nif x.effect == "payload" or y in ("gain",): ...')
    assert "payload" in set(strings(tree))
    assert len([text for text in strings(tree) if text == "payload"]) == 1
    assert {"payload", "gain"} <= set(compared(tree))


@pytest.mark.parametrize("verb", VERBS, ids=lambda v: v.__name__)
@pytest.mark.parametrize("kind", KINDS, ids=lambda k: k.__name__)
def test_every_kind_has_every_verb(kind, verb):
    assert verb.dispatch(kind) is not verb.dispatch(object)


def test_every_registered_effect_is_of_one_of_the_five_kinds():
    assert len(KINDS) == 5
    assert {type(effect) for effect in REGISTRY.values()} == set(KINDS)


def test_names_in_facts_are_registered():
    for effect in REGISTRY.values():
        told = {*effect.contains, *effect.exclusive_with, *effect.extends}
        assert told <= set(REGISTRY), effect.name
        known = {p.name for p in effect.parameters}
        assert set(effect.identity) <= known, effect.name
        assert {p.hidden_by for p in effect.parameters} - {""} <= known, effect.name
        shown_by = {name for p in effect.parameters for name in p.shown_by}
        assert shown_by <= {p.name for p in effect.linear}, effect.name


def test_every_effect_says_what_it_means_and_what_to_do():
    for effect in REGISTRY.values():
        assert len(effect.meaning) > 40 and effect.meaning.endswith("."), effect.name
