"""Values as cells of a table."""

from collections.abc import Sequence

from jaxswarm.tables import Table


def number(value: float | None, digits: int = 5) -> str:
    """A number for a cell; empty where there is none.

    >>> number(0.1234567), number(None)
    ('0.12346', '')
    """
    return "" if value is None or value != value else f"{value:.{digits}g}"


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
