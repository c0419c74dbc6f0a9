"""Errors and values as cells of a table."""

from collections.abc import Mapping, Sequence

from jaxswarm.identify.report.errors import error_cells
from jaxswarm.tables import Table


def number(value: float | None, digits: int = 5) -> str:
    """A number for a cell; empty where there is none.

    >>> number(0.1234567), number(None)
    ('0.12346', '')
    """
    return "" if value is None or value != value else f"{value:.{digits}g}"


def error_table(title: str, rows: Mapping[str, dict | None], joints, units: Sequence[str]) -> Table:
    """Errors of :func:`jaxswarm.identify.forward.metrics.torque_errors` by joint, one row each.

    Args:
        title: Title of the table.
        rows: Errors by name of the row; None is left out.
        joints: Names, n of them.
        units: Torque unit of each joint.
    """
    lines = []
    for name, errors in rows.items():
        if errors is None:
            continue
        lines.append((name, *error_cells(errors, units)))
    return Table(title, ("torque error", *joints, "global"), tuple(lines))


def effect_table(effects: Sequence[dict], title: str = "effects") -> Table:
    """Effects of a ``model.json``'s report with values, standard errors and units."""
    rows = []
    for effect in effects:
        other = f":{effect['other']}" if effect.get("other") else ""
        place = "" if effect["joint"] is None else f"@{effect['joint']}{other}"
        for name, row in effect["parameters"].items():
            cells = number(row["value"]), number(row.get("std_error"), 2), row["unit"]
            rows.append((effect["effect"] + place, name, *cells))
    return Table(title, ("effect", "parameter", "value", "std error", "unit"), tuple(rows))
