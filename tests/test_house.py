"""The house stays in order: short functions and files, thresholds in one place, few arrows between rooms."""

import ast
import re
from pathlib import Path

import pytest
from test_imports import EDGES, MODULES

ROOT = Path(__file__).resolve().parents[1]
FUNCTION, FILE = 60, 250
# A page is one long list of what stands on it.
PAGES = {"jaxswarm/studies/rx60/page.py"}
# Distinct arrows between the rooms of a wing, and the floors they are on.
ARROWS, FLOORS = {"diagnose": 13, "identify": 11}, {"diagnose": 6, "identify": 4}
FILES = [p for part in ("jaxswarm", "benchmarks") for p in sorted((ROOT / part).rglob("*.py"))]
DECIDING = [
    p
    for room in ("decision", "selection")
    for p in sorted((ROOT / "jaxswarm/diagnose" / room).glob("*.py"))
]


def name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def size(node: ast.AST) -> int:
    return node.end_lineno - node.lineno + 1


def functions_in(node: ast.AST) -> list:
    """Functions directly within a node, not those within them."""
    found = []
    for child in ast.iter_child_nodes(node):
        is_function = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef)
        found += [child] if is_function else functions_in(child)
    return found


def own_size(function: ast.FunctionDef) -> int:
    """Lines of a function, docstring and all, without those of the functions within it."""
    return size(function) - sum(size(inner) for inner in functions_in(function))


@pytest.mark.parametrize("path", FILES, ids=name)
def test_functions_and_files_are_short(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) <= FILE
    every = [n for n in ast.walk(parsed(path)) if isinstance(n, ast.FunctionDef)]
    long = {f.name: own_size(f) for f in every if own_size(f) > FUNCTION}
    assert not long or name(path) in PAGES


def test_the_size_of_a_function_leaves_out_what_is_within():
    outer = parsed(Path(__file__)).body
    assert own_size(next(n for n in outer if getattr(n, "name", "") == "size")) == 2
    nested = ast.parse("def a():\n    def b():\n        pass\n    return b\n").body[0]
    assert own_size(nested) == 2


def thresholds(tree: ast.AST) -> list[float]:
    """Numbers that something is compared with, but for zero, one and guards against rounding."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            numbers = (n for side in node.comparators for n in ast.walk(side))
            found += [
                n.value
                for n in numbers
                if isinstance(n, ast.Constant)
                and isinstance(n.value, float)
                and n.value not in (0.0, 1.0)
                and n.value > 1e-6
            ]
    return found


@pytest.mark.parametrize("path", DECIDING, ids=name)
def test_no_threshold_stands_between_the_lines(path):
    assert not thresholds(parsed(path))


def test_the_search_for_thresholds_finds_them():
    assert thresholds(ast.parse("x > 0.97 * y and z < 0.0 and w > 1e-9")) == [0.97]


# Words of former times, for what has a name in the field; and words of a court.
WORDS = re.compile(
    r"\b(suspects?|guilty|judges?|culprits?|accused?|blamed?|innocent|touch(es|ed)?|strikes?|struck|knobs?)\b",
    re.IGNORECASE,
)


@pytest.mark.parametrize("path", FILES, ids=name)
def test_one_word_for_one_thing(path):
    text = path.read_text(encoding="utf-8").replace("touch-action", "")  # a property of CSS
    assert not WORDS.findall(text)


@pytest.mark.parametrize("wing", sorted(ARROWS))
def test_arrows_between_the_rooms_of_a_wing_are_few(wing):
    def room(module: str) -> str | None:
        pieces = module.split(".")
        return pieces[2] if pieces[1:2] == [wing] and len(pieces) > 3 else None

    arrows = {
        (room(module), room(target))
        for module in MODULES
        for target in EDGES[module]
        if room(module) and room(target) and room(module) != room(target)
    }
    assert len(arrows) <= ARROWS[wing]

    def floor(one: str) -> int:
        return 1 + max((floor(below) for above, below in arrows if above == one), default=0)

    assert max(floor(one) for one, _ in arrows) <= FLOORS[wing]


@pytest.mark.parametrize("path", FILES, ids=name)
def test_no_module_gives_a_constant_twice(path):
    """Rules that asked for a limit of 0.25 went by another of its name, 0.5, further down in the file."""
    targets = [t for n in parsed(path).body if isinstance(n, ast.Assign) for t in n.targets]
    names = [n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name)]
    constants = [n for n in names if n.isupper()]
    assert sorted(constants) == sorted(set(constants))
