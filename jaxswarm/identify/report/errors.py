"""Errors and parameters of an identification as tables: the terminal and Python show the same."""

from collections.abc import Mapping, Sequence

import numpy as np

from jaxswarm.identify.report.summary import SOUND
from jaxswarm.tables import Table


def error_rows(report: dict) -> dict[str, dict]:
    """Errors by the name of their column: of every fitted log, of held-out time and of the validation log.

    Args:
        report: Content of ``identification.json``.
    """
    told = report["error"]
    train = told["train"] if isinstance(told["train"], list) else [told["train"]]
    rows: dict[str, dict] = {}
    for errors in train:
        name = f"fitted: {errors['log']}" if len(train) > 1 else "fitted log"
        number = sum(row == name or row.startswith(f"{name}, part ") for row in rows)
        rows[f"{name}, part {number + 1}" if number else name] = errors
    rows["held-out blocks"] = told["held_out_blocks"]
    if told["validation"] is not None:
        rows["validation log"] = told["validation"]
    return rows


def error_table(
    title: str, parts: Mapping[str, dict | None], joints, units: Sequence[str]
) -> Table:
    """Errors of :func:`jaxswarm.identify.forward.metrics.torque_errors`: a row a joint, a column each.

    Args:
        title: Title of the table.
        parts: Errors by the name of what they are of; None is left out.
        joints: Names, n of them.
        units: Torque unit of each joint.
    """
    told = {name: errors for name, errors in parts.items() if errors is not None}
    columns = [_cells(errors, units) for errors in told.values()]
    rows = zip((*joints, "whole arm"), *columns, strict=True)
    return Table(title, ("torque error", *told), tuple(rows))


def _cells(errors: dict, units: Sequence[str]) -> list[str]:
    """The errors of every joint in its unit and in percent, and of all joints together."""
    cells = [
        f"{rms:.4g} {unit} ({100 * share:.2f} %)"
        for rms, share, unit in zip(errors["rms"], errors["relative"], units, strict=True)
    ]
    return [*cells, f"{100 * errors['relative_global']:.3f} %"]


def base_table(rows: Sequence[dict]) -> Table:
    """The base parameters with their standard errors, and what each stands for."""
    head = ("parameter", "value", "std error", "unit", "verdict", "stands for")
    cells = [
        (
            row["name"],
            f"{row['value']:.5g}",
            f"{row['std_error']:.2g}" if np.isfinite(row["std_error"]) else "",
            row["unit"],
            row["verdict"],
            "" if row["expression"] == row["name"] else row["expression"],
        )
        for row in rows
    ]
    doubtful = frozenset(k for k, row in enumerate(rows) if row["verdict"] not in SOUND)
    return Table("base parameters", head, tuple(cells), doubtful)
