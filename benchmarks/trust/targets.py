"""What reads a spoiled input: every way into the library, by name."""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.trust import good, targets_more
from benchmarks.trust.mutate_bytes import spoil_bytes
from benchmarks.trust.mutate_numbers import INTEGERS, number, word
from benchmarks.trust.mutate_tree import spoil_json, spoil_toml, spoil_xml
from benchmarks.trust.write_logs import LOGS
from jaxswarm.logs.motion import Filtering

Target = Callable[[np.random.Generator, Path], Callable[[], object]]
# Share of documents whose bytes are spoiled, too; of models that are used after they were read.
_BYTES, _USED = 0.2, 0.02


def _log_target(write: Callable[[np.random.Generator, Path], Path]) -> Target:
    def target(rng, folder):
        from jaxswarm.identify.checks.check_log import CHECKS, checked
        from jaxswarm.logs import read_log

        path = write(rng, folder)
        accept = tuple(CHECKS) if rng.random() < 0.5 else ()

        def call():
            log = read_log(path, good.JOINTS)
            if not all(np.isfinite(x).all() for x in (log.t, log.q, log.tau)):
                raise ValueError("accepted what is no number")
            checked(log, good.arm(), Filtering(), accept)

        return call

    return target


def _written(rng: np.random.Generator, path: Path, text: str) -> Path:
    data = text.encode("utf-8", "replace")
    path.write_bytes(spoil_bytes(rng, data) if rng.random() < _BYTES else data)
    return path


def _robot_target(name: str, texts: tuple[str, ...], spoil) -> Target:
    def target(rng, folder):
        from jaxswarm.robot import load_robot

        path = _written(rng, folder / name, spoil(rng, texts[rng.integers(len(texts))]))

        def call():
            robot = load_robot(path)
            for array in (robot.rotation, robot.translation, robot.axis, robot.parameters):
                if not np.isfinite(array).all():
                    raise ValueError("accepted what is no number")

        return call

    return target


def _limits(rng, folder):
    from jaxswarm.identify.excitation.limits import read_limits

    path = _written(rng, folder / "limits.toml", spoil_toml(rng, good.LIMITS))
    return lambda: read_limits(path, good.JOINTS)


def _model(rng, folder):
    from jaxswarm.identify import load_model
    from jaxswarm.identify.predict import predict_file

    path = _written(rng, folder / "model.json", spoil_json(rng, good.model_json()))
    if rng.random() > _USED:
        return lambda: load_model(path)
    log = good.write_csv(folder / "log.csv", good.columns())
    return lambda: predict_file(path, log, folder / "prediction.csv")


def _result(rng, folder):
    from jaxswarm import tasks

    text = good.result_json()
    one = _written(rng, folder / "one.json", spoil_json(rng, text))
    other = folder / "other.json"
    other.write_text(text)
    return lambda: tasks.compare(one, other)


def _options(rng, folder):
    """Texts of options, each as the command line has it."""
    from jaxswarm.commands.options import numbers
    from jaxswarm.effects.term import parse_terms
    from jaxswarm.robot import load_robot, parse_options
    from jaxswarm.swarm import find_optimizer

    names = [*good.JOINTS, "slide", "flange", "joint9", word(rng)]

    def text(parts: int) -> str:
        odd = [str(number(rng)), str(INTEGERS[rng.integers(len(INTEGERS))]), word(rng)]
        odd = [*odd, *names, "1", "0", "0.5", "2"]
        return str(rng.choice([",", "=", "@", ";", ",,"])).join(
            odd[rng.integers(len(odd))] for _ in range(rng.integers(1, parts + 1))
        )

    choices = [
        lambda: load_robot(path, parse_options(**{option: text(11)})),
        lambda: parse_terms(effects, good.JOINTS),
        lambda: find_optimizer(text(1)),
        lambda: numbers(text(4), "--kp"),
        lambda: load_robot(text(1)),
    ]
    path = folder / "arm.urdf"
    path.write_text(good.URDF)
    option = str(rng.choice(["joints", "lock", "tool", "gravity"]))
    laws = [
        "viscous_friction",
        "payload",
        "contact",
        "time_delay",
        "transmission_coupling",
        "none",
        word(rng),
    ]
    effects = ",".join(
        laws[rng.integers(len(laws))] + str(rng.choice(["", "@", ":"])) + text(1)
        for _ in range(rng.integers(1, 5))
    )
    return choices[rng.integers(len(choices))]


TARGETS: dict[str, Target] = {
    **{name: _log_target(write) for name, write in LOGS.items()},
    "URDF": _robot_target("arm.urdf", (good.URDF,), spoil_xml),
    "HDF5": _log_target(targets_more.spoiled_hdf5),
    "rosbag": _log_target(targets_more.spoiled_bag),
    "episodes": _log_target(targets_more.spoiled_episodes),
    "SDF": _robot_target("arm.sdf", (good.SDF,), spoil_xml),
    "MJCF": _robot_target("arm.xml", (good.MJCF,), spoil_xml),
    "TOML": _robot_target("arm.toml", (good.TOML, good.TREE), spoil_toml),
    "limits": _limits,
    "model.json": _model,
    "compare": _result,
    "options": _options,
    "columns": targets_more.columns,
    "interrupted diagnosis": targets_more.kept,
    "checkpoint": targets_more.checkpoint,
}
ORDER = tuple(TARGETS)


def make(number: int, folder: Path, name: str = "") -> tuple[str, Callable[[], object]]:
    """The input of a number, the same at any time: its files in a folder, and what reads them.

    ``name`` is the way in that an input of that number takes; empty: the ways take turns.
    """
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    name = name or ORDER[number % len(ORDER)]
    rng = np.random.default_rng([number, 18])
    return name, TARGETS[name](rng, folder)
