"""The diagnosis on a terminal."""

from pathlib import Path

from rich.console import Console
from rich.table import Table

from jaxswarm.diagnose.report.text import next_steps, value_text, verdict_sentence, where


def print_diagnosis(result: dict, out: Path | None) -> None:
    """Print verdict, ladder of errors, added effects and what to do next."""
    console = Console()
    console.print(f"[bold]{result['robot']}[/bold]: {verdict_sentence(result)}")
    if result["error"]["before"] is None:
        return
    units = result["torque_units"]
    table = Table("on unseen motion", *result["joints"], "global")

    def row(name: str, errors: dict) -> None:
        cells = [
            f"{rms:.4g} {unit} ({100 * share:.2f} %)"
            for rms, share, unit in zip(errors["rms"], errors["relative"], units, strict=True)
        ]
        table.add_row(name, *cells, f"{100 * errors['relative_global']:.3f} %")

    row("declared model", result["error"]["before"])
    for step in result["steps"]:
        row(f"+ {where(step['added'])}", step["after"])
    floor = result["error"]["noise_floor"]["rms"]
    table.add_row("noise", *(f"{x:.3g} {u}" for x, u in zip(floor, units, strict=True)), "")
    console.print(table)
    for effect in [*result["effects"], *result["changed"]]:
        values = ", ".join(f"{n} = {value_text(v)}" for n, v in effect["parameters"].items())
        console.print(f"{where(effect)}: {values}")
    for line in [*result.get("reasons", ()), *next_steps(result)]:
        console.print(f"- {line}")
    if out is not None:
        console.print(f"report: {out / 'report.html'}")
