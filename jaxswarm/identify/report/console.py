"""The result of ``identify`` as tables on a terminal."""

from pathlib import Path

from rich.console import Console
from rich.table import Table


def print_identification(report: dict, out: Path) -> None:
    """Print errors and parameters of an ``identification.json``."""
    console = Console()
    errors = Table("torque error", *report["joints"], "global", title=f"{report['robot']}")
    rows = {
        "fitted logs": report["error"]["train"],
        "held-out blocks": report["error"]["held_out_blocks"],
        "validation log": report["error"]["validation"],
    }
    for name, part in rows.items():
        if part is None:
            continue
        part = part[0] if isinstance(part, list) else part
        cells = [
            f"{rms:.4g} {unit} ({100 * share:.2f} %)"
            for rms, share, unit in zip(
                part["rms"], part["relative"], report["torque_units"], strict=True
            )
        ]
        errors.add_row(name, *cells, f"{100 * part['relative_global']:.3f} %")
    console.print(errors)
    table = Table("parameter", "value", "std error", "unit", "verdict", "stands for")
    for row in report["base_parameters"]:
        table.add_row(
            row["name"],
            f"{row['value']:.5g}",
            f"{row['std_error']:.2g}",
            row["unit"],
            row["verdict"],
            "" if row["expression"] == row["name"] else row["expression"],
        )
    console.print(table)
    search = report["optimizer"]
    if search["name"] != "least_squares":
        excess = search["excess_over_least_squares"]
        console.print(
            f"{search['name']}: {search['runs']} runs, {search['evaluations']} evaluations, cost above "
            f"the least-squares optimum by {100 * excess['best']:.3g} % (best), "
            f"{100 * excess['median']:.3g} % (median)"
        )
    console.print(f"written to {out}")
