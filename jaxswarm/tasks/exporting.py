"""An identified model in other tools' formats, with rigid bodies for links where the format needs them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from jaxswarm import outputs
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.errors import InputError, nearest
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.physical.consistency import are_bodies
from jaxswarm.identify.physical.export import export_mjcf, export_sdf, export_urdf
from jaxswarm.identify.physical.export_c import c_text
from jaxswarm.identify.physical.export_parts import split_effects
from jaxswarm.identify.physical.export_yaml import yaml_text
from jaxswarm.identify.physical.physical_model import PULL, PhysicalModel, physical_model
from jaxswarm.identify.report.summary import units
from jaxswarm.logs import Log
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.robot import Robot
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.tables import Result, Table
from jaxswarm.tasks.inputs import as_logs, as_model, as_robot, in_double
from jaxswarm.tasks.words import number


def _write_yaml(model: Model, path: Path) -> None:
    path.write_text(yaml_text(model.robot, model.terms, model.width), encoding="utf-8")


def _write_c(model: Model, path: Path) -> None:
    path.write_text(c_text(model.robot, model.terms, model.width), encoding="utf-8")


@dataclass(frozen=True)
class Format:
    """A format of files.

    Attributes:
        write: Writes a model to a path.
        holds: Attributes of joints that the format holds of effects, and the effects it does not hold.
        bodies: Whether it wants rigid bodies.
        unread: What usual readers make of an attribute of the file.
    """

    write: Callable[[Model, Path], object]
    holds: Callable[[Sequence[Term]], tuple[dict[int, dict[str, float]], list[Term]]]
    bodies: bool = True
    unread: Mapping[str, str] = field(default_factory=dict)


def _torques_only(terms: Sequence[Term]) -> tuple[dict[int, dict[str, float]], list[Term]]:
    return {}, [term for term in terms if term not in of_kind(terms, TorqueLaw)]


_ALONE = "inverse dynamics of Pinocchio are those of the bodies alone, without the file's damping and friction"
FORMATS = {
    "urdf": Format(
        lambda model, path: export_urdf(model.robot, path, model.terms),
        partial(split_effects, form="urdf"),
        unread=dict.fromkeys(("damping", "friction"), _ALONE),
    ),
    "mjcf": Format(
        lambda model, path: export_mjcf(model.robot, path, model.terms),
        partial(split_effects, form="mjcf"),
    ),
    "sdf": Format(
        lambda model, path: export_sdf(model.robot, path, model.terms),
        partial(split_effects, form="mjcf"),
        unread={
            "frictionloss": "Drake passes the file's dry friction over",
            "armature": "Gazebo passes the file's rotor inertia over",
        },
    ),
    "yaml": Format(_write_yaml, lambda terms: ({}, [])),
    "c": Format(_write_c, _torques_only, bodies=False),
}
_ENDINGS = {
    **{f".{name}": name for name in ("urdf", "mjcf", "sdf", "yaml", "c")},
    **{".xml": "mjcf", ".yml": "yaml"},
}


@in_double
def export(
    model: Model | str | Path,
    path: str | Path,
    format: str | None = None,
    *,
    log: Log | str | Path | None = None,
    prior: Robot | str | Path | None = None,
    prior_weight: float = PULL,
    progress: Callable[[str], None] = lambda text: None,
) -> Result:
    """Write a model as URDF, MJCF, SDF, YAML or as a C function of its effects.

    Base parameters with zeros for what merges are no bodies: the nearest set of rigid bodies is
    written, and the result says how far that moves the torque.

    Args:
        model: A model, a result with one, or its ``model.json``.
        path: File to write.
        format: One of ``urdf``, ``mjcf``, ``sdf``, ``yaml``, ``c``; None: by the ending of the path.
        log: Motion on which the torque has to stay; None: random states of an arm at work.
        prior: Robot (with bodies) to stay near where the model leaves freedom; None: equal balls.
        prior_weight: What the prior costs, in residual standard deviations of one sample for a change
            of a log-Cholesky coordinate by 1 (a mass by the factor e^2).
        progress: Called with one line per stage.

    Raises:
        InputError: If something cannot be used or written.
    """
    model, path = as_model(model), Path(path)
    form = _format(path, format)
    if path.is_dir():
        raise InputError(f"--out {path}: is a folder; name a file such as {path / 'arm.urdf'}")
    if not 0.0 < prior_weight < np.inf:
        raise InputError(f"prior weight {prior_weight}: give a number above zero")
    outputs.check_file(path)
    found = None
    if form.bodies and (prior is not None or not are_bodies(model.robot)):
        progress("finding the nearest rigid bodies")
        columns, where = _columns(model, log)
        start = None if prior is None else as_robot(prior)
        found = physical_model(model, columns, where, prior=start, pull=prior_weight)
        model = found.model
    progress("writing")
    with TemporaryDirectory() as place:
        form.write(model, Path(place) / path.name)
        files: dict[str, outputs.Content] = {
            part.name: part.read_bytes() for part in sorted(Path(place).iterdir())
        }
    outputs.write_told(path.parent, files)
    return _result(model, path, found, form, len(files) > 1)


def _format(path: Path, name: str | None) -> Format:
    name = name or _ENDINGS.get(path.suffix.lower())
    if name is None:
        raise InputError(f"{path}: the ending names no format; say which: {', '.join(FORMATS)}")
    if name not in FORMATS:
        raise InputError(f"unknown format {name!r}. {nearest(name, FORMATS)}")
    return FORMATS[name]


def _columns(model: Model, log) -> tuple[np.ndarray | None, str]:
    if log is None:
        return None, "random states of an arm at work"
    (read,) = as_logs(log, model.robot, require_torque=False)
    parts = []
    for motion in prepare_segments(read, model.filtering)[1]:
        kept = motion.decimator.kept(len(motion.t))
        parts.append([x[kept] for x in (motion.q, motion.dq, motion.ddq)])
    q, dq, ddq = (np.concatenate(x) for x in zip(*parts, strict=True))
    return np.asarray(rigid_columns(model.robot, q, dq, ddq)), read.source


def _notes(model: Model, form: Format) -> tuple[list[str], list[str]]:
    """Effects that the file does not hold, and what a reader of it has to know."""
    held, left = form.holds(model.terms)
    labels = [term.label(model.robot.joints) for term in left]
    named = {name for attributes in held.values() for name in attributes}
    notes = list(dict.fromkeys(told for name, told in form.unread.items() if name in named))
    if left:
        notes.insert(0, f"not in the file: {_by_effect(left, model.robot.joints)}")
    if model.smooth:
        notes.append("smooth terms without a law belong to predict alone and are not exported")
    return labels, notes


def _by_effect(terms: Sequence[Term], joints: tuple[str, ...]) -> str:
    """Effects, each once with its joints."""
    places: dict[str, list[str]] = {}
    for term in terms:
        places.setdefault(term.effect, []).append(term.label(joints).partition("@")[2])
    told = (
        (name, "every joint" if joints[1:] and own == list(joints) else ", ".join(own))
        for name, own in places.items()
    )
    return "; ".join(f"{name} on {on}" if on else name for name, on in told)


def _result(
    model: Model, path: Path, found: PhysicalModel | None, form: Format, has_side: bool
) -> Result:
    robot = model.robot
    side = path.with_name(path.name + ".json")
    content: dict[str, Any] = {"robot": robot.name, "out": str(path), "moved": None}
    if has_side:
        content["side_file"] = str(side)
    lines = [f"written to {path}" + (f", what it cannot hold to {side.name}" * has_side)]
    content["not_in_file"], notes = _notes(model, form)
    content["notes"] = notes
    if found is None:
        return Result(content, (*lines, *notes))
    content["moved"] = {
        "on": found.where,
        "rms": list(found.moved),
        "torque_rms": list(found.torque),
    }
    rows = [
        (
            joint,
            f"{number(a, 3)} {unit}",
            f"{number(b, 4)} {unit}",
            f"{100 * a / max(b, 1e-12):.3g} %",
        )
        for joint, a, b, unit in zip(
            robot.joints, found.moved, found.torque, units(robot), strict=True
        )
    ]
    lines.append(
        "The identified base parameters stand for sums of link parameters: the nearest rigid bodies "
        f"were written. On {found.where} the torque moves by"
    )
    head = ("joint", "moved, RMS", "torque, RMS", "share")
    return Result(content, (*lines, *notes), (Table("", head, tuple(rows)),))
