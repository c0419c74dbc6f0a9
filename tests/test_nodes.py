"""Nodes of JAX's trees: the class is part of the structure, and so of what a compiled program belongs to."""

import ast
import dataclasses
import itertools
from pathlib import Path

import jax
import jax.numpy as jnp
import pytest

from jaxswarm.nodes import node, node_of
from jaxswarm.robot.load import load_robot
from jaxswarm.swarm import pso
from jaxswarm.swarm.optimizers import boundaries, rules, topologies

PACKAGE = Path(__file__).resolve().parents[1] / "jaxswarm"
ALIKE = {
    "rule": (rules.canonical, rules.paired, rules.bare_bones, rules.spherical),
    "boundary": (boundaries.absorb, boundaries.reflect, boundaries.bounce, boundaries.periodic),
    "topology": (topologies.global_best, topologies.von_neumann),
}


@node
@dataclasses.dataclass(frozen=True)
class Pair:
    """Two leaves, and a static field between them."""

    first: jax.Array
    name: str = dataclasses.field(metadata={"static": True})
    second: jax.Array


def test_leaves_paths_and_structure_are_those_of_the_fields():
    leaves, structure = jax.tree.flatten(Pair(1.0, "a", 2.0))
    assert leaves == [1.0, 2.0] and jax.tree.unflatten(structure, [3.0, 4.0]) == Pair(3.0, "a", 4.0)
    paths = [
        jax.tree_util.keystr(p) for p, _ in jax.tree_util.tree_leaves_with_path(Pair(1, "a", 2))
    ]
    assert paths == [".first", ".second"]
    assert structure == jax.tree.structure(Pair(5, "a", 6)) != jax.tree.structure(Pair(5, "b", 6))
    assert hash(structure) == hash(jax.tree.structure(Pair(5, "a", 6)))


def test_it_is_mapped_differentiated_and_carried():
    def norm(pair):
        return pair.first @ pair.second

    pair = Pair(jnp.arange(3.0), "a", jnp.ones(3))
    assert jax.grad(norm)(pair).second.tolist() == [0.0, 1.0, 2.0]
    assert jax.vmap(lambda p: p.first * p.second)(pair).tolist() == [0.0, 1.0, 2.0]
    carried, _ = jax.lax.scan(lambda p, _: (p, None), pair, length=2)
    assert carried.name == "a"


@pytest.mark.parametrize("part", ALIKE)
def test_swarms_of_other_parts_are_of_other_structure(part):
    """Equal structures are one compiled program wherever their hashes meet in one slot."""
    trees = [jax.tree.structure(pso(**{part: make()})) for make in ALIKE[part]]
    assert all(a != b for a, b in itertools.combinations(trees, 2))


def test_of_many_classes_each_is_given_its_own_program():
    """With ``jax.tree_util.register_dataclass`` 60 of 400 were given that of another one."""

    @jax.jit
    def number(thing):
        return jnp.asarray(thing.NUMBER)

    kinds = []
    for index in range(400):
        kinds.append(
            node(dataclasses.make_dataclass(f"Kind{index}", [], namespace={"NUMBER": index}))
        )
    assert [int(number(kind())) for kind in kinds] == list(range(400))


def test_fields_may_be_named_by_hand():
    class Held:
        def __init__(self, value, kind):
            self.value, self.kind, self.seen = value, kind, 0

    node_of(Held, leaves=["value"], fixed=["kind"])
    doubled = jax.tree.map(lambda x: 2 * x, Held(3.0, "k"))
    assert (doubled.value, doubled.kind) == (6.0, "k")


def test_no_class_is_registered_past_it():
    """JAX's own registration of dataclasses leaves the class out of what is compared."""
    calls = [
        (path.name, attribute.attr)
        for path in PACKAGE.rglob("*.py")
        for attribute in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(attribute, ast.Attribute)
    ]
    assert ("nodes.py", "register_pytree_with_keys") in calls
    assert not [name for name, attribute in calls if attribute == "register_dataclass"]


def test_a_robot_is_one():
    robot = load_robot("ur10e")
    assert jax.tree.structure(robot) == jax.tree.structure(robot.replace(gravity=robot.gravity * 2))
