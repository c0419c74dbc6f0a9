"""Two models, identifications or diagnoses side by side; what differs beyond its intervals is marked."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from jaxswarm.documents import read_document
from jaxswarm.errors import InputError
from jaxswarm.identify.forward.model import Model, load_model
from jaxswarm.identify.physical.physical_model import random_columns
from jaxswarm.identify.report.errors import error_table
from jaxswarm.identify.report.summary import units
from jaxswarm.tables import Result, Table
from jaxswarm.tasks.inputs import in_double
from jaxswarm.tasks.report_check import check_report
from jaxswarm.tasks.values import Value, values_of_model, values_of_report
from jaxswarm.tasks.words import number

# Two values differ if they are further apart than 95 % of draws of their difference.
_INTERVAL = 1.96
# Without intervals values of two files differ if they are not the same to rounding.
_ROUNDING = 1e-6
# What a folder is asked for, the first that is there.
_WRITTEN = ("diagnosis.json", "identification.json", "model.json")
# What every report holds.
_PARTS = {"joints", "effects", "error"}


@in_double
def compare(a: Any, b: Any) -> Result:
    """Put two results of the same kind side by side.

    Args:
        a, b: Two models, or two results of ``identify``, or two of ``diagnose``; as objects or as
            ``model.json``, ``identification.json`` or ``diagnosis.json``, or the folder of one. Of folders
            with results of two kinds the models are compared.

    Returns:
        ``parameters`` (value, standard error and unit on both sides, difference, whether it ``differs``
        beyond the 95 % interval of the difference), ``only_a`` and ``only_b``, and errors.

    Raises:
        InputError: If a file cannot be used, the kinds differ, or the robots have other joints.
    """
    (kind, one), (other_kind, two) = _read(a, "first"), _read(b, "second")
    if kind != other_kind:
        left, right = _model_in(a), _model_in(b)
        if left is not None and right is not None:
            return compare(left, right)
        raise InputError(
            f"the first is {kind} and the second {other_kind}: compare two of the same kind, such as the "
            "model.json that both commands write"
        )
    joints, other_joints = _joints(one), _joints(two)
    if joints != other_joints:
        raise InputError(
            f"the first is of joints {', '.join(joints)}, the second of {', '.join(other_joints)}: "
            "compare results of the same robot"
        )
    if kind == "a model":
        values, others, errors = values_of_model(one), values_of_model(two), {}
        moved = _torque_difference(one, two)
    else:
        values, others = values_of_report(one), values_of_report(two)
        errors, moved = {"a": one["error"], "b": two["error"]}, None
    rows, only_a, only_b = _pairs(values, others)
    content: dict[str, Any] = {
        "kind": kind,
        "joints": list(joints),
        "parameters": rows,
        "only_a": only_a,
    }
    content |= {"only_b": only_b, "error": errors, "torque_difference": moved}
    if kind == "a diagnosis":
        content["verdict"] = {"a": one["verdict"], "b": two["verdict"]}
    return Result(content, *_show(content, one))


def _read(item: Any, which: str) -> tuple[str, Any]:
    """The kind of a result and what it holds."""
    if isinstance(item, Model):
        return "a model", item
    if isinstance(item, str | Path):
        path = Path(item)
        path = next((path / name for name in _WRITTEN if (path / name).is_file()), path)
        if path.is_dir():
            raise InputError(f"{path}: this folder holds none of {', '.join(_WRITTEN)}")
        try:
            item = json.loads(read_document(path))
        except FileNotFoundError:
            raise InputError(f"{path}: no such file; pass a .json that a command wrote") from None
        except InputError:
            raise
        except (OSError, ValueError, RecursionError) as error:
            raise InputError(f"{path}: cannot be read as JSON ({error})") from None
        if isinstance(item, dict) and "format" in item and "terms" in item:
            return "a model", load_model(path)
        which = str(path)
        if isinstance(item, dict) and _PARTS <= set(item):
            check_report(item, which)
    if isinstance(item, Mapping) and _PARTS <= set(item):
        if "verdict" in item:
            return "a diagnosis", item
        if "base_parameters" in item:
            return "an identification", item
    raise InputError(
        f"{which}: is no model.json, identification.json or diagnosis.json of this library"
    )


def _model_in(item: Any) -> Model | None:
    """The model beside a result where a folder is named: every command writes one."""
    path = Path(item) / "model.json" if isinstance(item, str | Path) else None
    return load_model(path) if path is not None and path.is_file() else None


def _joints(item: Any) -> tuple[str, ...]:
    return item.robot.joints if isinstance(item, Model) else tuple(item["joints"])


def _torque_difference(a: Model, b: Model) -> dict:
    """RMS of the difference of the rigid torques at random states, by joint [N m or N]."""
    columns = random_columns(a.robot)
    one, two = (np.asarray(m.robot.parameters).ravel() for m in (a, b))
    moved, size = columns @ (one - two), columns @ one
    return {
        "rms": list(np.sqrt(np.mean(moved**2, axis=0))),
        "torque_rms": list(np.sqrt(np.mean(size**2, axis=0))),
        "units": list(units(a.robot)),
    }


def _pairs(left: list[Value], right: list[Value]) -> tuple[list[dict], list[dict], list[dict]]:
    """Rows of what both hold, and what only one of them holds."""
    other = {(v.place, v.name): v for v in right}
    rows, only_a = [], []
    for v in left:
        w = other.pop((v.place, v.name), None)
        if w is None:
            only_a.append(vars(v))
            continue
        difference = w.value - v.value
        known = [e for e in (v.std_error, w.std_error) if e is not None and np.isfinite(e)]
        if len(known) == 2:
            limit = _INTERVAL * float(np.hypot(known[0], known[1]))
        else:
            limit = _ROUNDING * max(abs(v.value), abs(w.value))
        rows.append(
            {
                "place": v.place, "name": v.name, "unit": v.unit,
                "a": {"value": v.value, "std_error": v.std_error},
                "b": {"value": w.value, "std_error": w.std_error},
                "difference": difference,
                "interval_known": len(known) == 2,
                "differs": bool(abs(difference) > limit),
            }
        )  # fmt: skip
    return rows, only_a, [vars(v) for v in other.values()]


def _show(content: dict, one: Any) -> tuple[tuple[str, ...], tuple[Table, ...]]:
    def cell(side: dict) -> str:
        error = side["std_error"]
        known = error is not None and np.isfinite(error)
        return number(side["value"]) + (f" ± {number(_INTERVAL * error, 2)}" if known else "")

    rows = [
        (row["place"], row["name"], cell(row["a"]), cell(row["b"]), number(row["difference"], 3),
         _unit(row), ("yes" if row["interval_known"] else "yes (no interval)") * row["differs"])
        for row in content["parameters"]
    ]  # fmt: skip
    for side, column in (("only_a", 2), ("only_b", 3)):
        for row in content[side]:
            cells = ["", ""]
            cells[column - 2] = cell(row)
            rows.append((row["place"], row["name"], *cells, "", _unit(row), f"only {side[-1]}"))
    head = ("of", "parameter", "a", "b", "b - a", "unit", "differs")
    tables = [Table("parameters (± half the 95 % interval)", head, tuple(rows))]
    beyond = sum(row["differs"] for row in content["parameters"])
    alone = len(content["only_a"]) + len(content["only_b"])
    lines = [f"{beyond} of {len(rows) - alone} parameters differ, {alone} are only on one side."]
    if "verdict" in content:
        verdicts = content["verdict"]
        lines.insert(0, f"verdict of a: {verdicts['a']}; of b: {verdicts['b']}")
    if content["torque_difference"]:
        moved = content["torque_difference"]
        parts = zip(
            content["joints"], moved["rms"], moved["torque_rms"], moved["units"], strict=True
        )
        apart = tuple((j, f"{number(a, 3)} {u}", f"{number(b, 4)} {u}") for j, a, b, u in parts)
        if not all(row["interval_known"] for row in content["parameters"]):
            lines.append("Where no interval is known every difference beyond rounding is marked.")
        tables.append(
            Table("rigid body at random states", ("joint", "torque of b - a, RMS", "a, RMS"), apart)
        )
    if content["error"]:
        tables.append(error_table("errors", _error_rows(content["error"]), content["joints"],
                                  one["torque_units"]))  # fmt: skip
    return tuple(lines), tuple(tables)


def _unit(row: dict) -> str:
    """A unit as a cell: a pure number has none."""
    return "" if row["unit"] == "1" else row["unit"]


def _error_rows(errors: dict) -> dict:
    rows = {}
    for side in ("a", "b"):
        for name, part in errors[side].items():
            part = part[0] if isinstance(part, list) and part else part
            if isinstance(part, dict) and "relative_global" in part:
                rows[f"{side}: {name.replace('_', ' ')}"] = part
    return rows
