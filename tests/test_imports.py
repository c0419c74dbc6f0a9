"""Imports run one way: the wings do not see each other, nothing points back, nothing goes round."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "jaxswarm"

# What each part may import besides itself and jaxswarm.errors.
PHYSICS = {"robot", "effects", "simulate", "logs"}
ALLOWED = {
    "errors": set(),
    "decomposition": set(),
    "unfinished": set(),
    "manifest": set(),
    "outputs": {"unfinished", "manifest"},
    "provenance": set(),
    "claim": set(),
    "terminal": set(),
    "unheard": {"terminal"},
    "console": {"outputs"},
    "catalog": set(),
    "memory": set(),
    "nodes": set(),
    "documents": set(),
    "waiting": set(),
    "work": {"claim", "console", "terminal"},
    "plots": set(),
    "loop_plots": {"plots"},
    "program_files": set(),
    "room": set(),
    "program_names": set(),
    "programs": {"program_files", "program_names", "room"},
    "cores": set(),
    "drawing": {"plots", "cores"},
    "swarm": {"memory", "nodes", "room"},
    "robot": {"nodes"},
    "effects": {"robot", "nodes", "programs"},
    "simulate": {"robot", "effects", "nodes"},
    "logs": {"documents"},
    "identify": {
        *(*PHYSICS, "swarm", "memory", "waiting", "documents"),
        *("outputs", "plots", "programs", "drawing", "tables", "cores", "decomposition"),
    },
    "diagnose": {
        *(*PHYSICS, "swarm", "identify"),
        *("memory", "outputs", "plots", "loop_plots", "programs", "drawing", "tables"),
        *("provenance", "cores", "decomposition"),
    },
    "studies": {*PHYSICS, "swarm", "identify", "diagnose", "outputs", "plots"},
    "tables": set(),
    "tasks": {
        *(*PHYSICS, "swarm", "identify", "diagnose"),
        *("memory", "outputs", "plots", "tables", "room", "documents", "decomposition"),
    },
    "fleet": {
        *(*PHYSICS, "identify", "diagnose", "tasks"),
        *("memory", "outputs", "plots", "tables", "runtime"),
    },
    "commands": {
        *(*PHYSICS, "swarm", "identify", "diagnose", "studies", "tasks", "fleet"),
        *("outputs", "plots", "tables", "catalog", "console", "work", "runtime"),
    },
    "testing": {"effects", "swarm"},
    "howto": set(),
    "runtime": {"terminal"},
    "cli": {"commands", "console", "terminal", "unheard", "work"},
    "__main__": {"cli"},
    "reference": {"effects", "swarm", "cli", "work"},
}  # fmt: skip
SWARM_ORDER = ("leaves", "optimizers", "minimize", "tools")
SWARM_LEVEL = {
    **dict.fromkeys(("space", "bounds", "scales", "forward"), "leaves"),
    **dict.fromkeys(
        ("schedules", "random", "quantile", "pytree", "fingerprint", "lanes", "calling"), "leaves"
    ),
    "optimizers": "optimizers",
    **dict.fromkeys(("minimize", "search", "in_turn", "repeating", "loop", "batches"), "minimize"),
    **dict.fromkeys(("start", "standing", "stopping", "result", "needed", "telling"), "minimize"),
    **dict.fromkeys(("polish", "checkpoint", "resume", "sharding"), "tools"),
    **dict.fromkeys(("contract", "endurance"), "tools"),
    **dict.fromkeys(("driver", "workers", "noise", "handling", "constraints"), "tools"),
    **dict.fromkeys(("pareto", "objectives", "nsga2", "mopso", "plots", "own"), "tools"),
}

# Rooms of a wing and their floors: a room sees those below it; commands at the top of a wing see all.
ROOMS = {
    "identify": {
        "forward": 0,
        "estimation": 1,
        "checks": 2,
        "simulation_error": 2,
        "physical": 2,
        "excitation": 2,
        "report": 2,
    },
    "diagnose": {
        "folds": 0,
        "candidates": 1,
        "decision": 2,
        "selection": 3,
        "discovery": 4,
        "report": 5,
    },
    "studies": {"rx60": 0, "sepso": 1},
}


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_name(path): path for path in sorted(PACKAGE.rglob("*.py"))}


def imported(name: str, path: Path) -> set[str]:
    """Modules of ours that a file imports anywhere, in functions too."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                package = name.split(".") if path.stem == "__init__" else name.split(".")[:-1]
                base = ".".join([*package[: len(package) - node.level + 1], *base.split(".")])
            names = {f"{base}.{alias.name}" for alias in node.names}
            # ``from package import module`` needs the module; any other name needs the package.
            found |= names & set(MODULES) if names <= set(MODULES) else names | {base}
    return {target for target in found if target in MODULES and target != name}


EDGES = {name: imported(name, path) for name, path in MODULES.items()}


def part(name: str) -> str:
    pieces = name.split(".")
    return pieces[1] if len(pieces) > 1 else ""


def test_the_walk_sees_imports_inside_functions():
    assert "jaxswarm.identify.run" in EDGES["jaxswarm.commands.identification"]
    assert "jaxswarm.errors" in EDGES["jaxswarm.effects.base"]


def test_every_part_of_the_package_is_known():
    parts = {part(name) for name in MODULES} - {""}
    assert parts <= set(ALLOWED), f"say in ALLOWED what {parts - set(ALLOWED)} may import"


@pytest.mark.parametrize("name", sorted(MODULES))
def test_imports_point_down(name):
    own = part(name)
    if not own:
        return
    for target in EDGES[name]:
        other = part(target)
        if other and other not in (own, "errors"):
            assert other in ALLOWED[own], f"{name} imports {target}"


@pytest.mark.parametrize("name", sorted(n for n in MODULES if n.startswith("jaxswarm.swarm.")))
def test_layers_of_the_swarm_engine(name):
    own = SWARM_LEVEL[name.split(".")[2]]
    for target in EDGES[name]:
        if not target.startswith("jaxswarm.swarm."):
            continue
        other = SWARM_LEVEL[target.split(".")[2]]
        assert SWARM_ORDER.index(other) <= SWARM_ORDER.index(own), f"{name} imports {target}"


@pytest.mark.parametrize("wing", sorted(ROOMS))
def test_rooms_of_a_wing(wing):
    def room(name: str) -> str | None:
        pieces = name.split(".")
        return pieces[2] if pieces[1:2] == [wing] and len(pieces) > 3 else None

    inside = [name for name in MODULES if room(name)]
    assert {room(name) for name in inside} == set(ROOMS[wing])
    for name in inside:
        for target in EDGES[name]:
            other = room(target)
            if other == room(name):
                continue
            if other:
                assert ROOMS[wing][other] < ROOMS[wing][room(name)], f"{name} imports {target}"
            elif wing != "studies":
                top = target.split(".")[1:2] == [wing]
                assert not top, f"{name} imports {target}, a command above its room"


def test_no_cycles():
    # A module that imports a name from its own package's __init__ would show up as one.
    state: dict[str, int] = {}

    def visit(name: str, trail: tuple[str, ...]) -> None:
        if state.get(name) == 2:
            return
        assert state.get(name) != 1, " -> ".join([*trail[trail.index(name) :], name])
        state[name] = 1
        for target in EDGES[name]:
            visit(target, (*trail, name))
        state[name] = 2

    for name in MODULES:
        visit(name, ())


def test_the_root_package_pulls_in_nothing_of_the_tests():
    for name, path in MODULES.items():
        text = path.read_text(encoding="utf-8")
        assert "import pytest" not in text, name
        assert "import benchmarks" not in text and "from benchmarks" not in text, name
