"""The diagnosis on a terminal: verdict first, joints as rows, nothing cut at 80 columns."""

from pathlib import Path

from rich.console import Console

from jaxswarm.diagnose.report import grids
from jaxswarm.diagnose.report.flags import flagged
from jaxswarm.diagnose.report.grids import Grid
from jaxswarm.diagnose.report.remains import remaining
from jaxswarm.diagnose.report.text import (
    evidence_sentence,
    grouped,
    law_facts,
    log_notes,
    next_steps,
    proof_sentence,
    reasons,
    taken_out,
    where,
)
from jaxswarm.tables import Table


def print_diagnosis(result: dict, out: Path | None) -> None:
    """Print verdict, proof, errors by joint, added effects, what is doubtful and what to do next."""
    console = Console()
    console.print(f"[bold]{result['robot']}: {result['verdict']}[/bold]")
    console.print(evidence_sentence(result))
    console.print(proof_sentence(result))
    if result["error"]["before"] is not None:
        _errors(console, result)
    for key in ("effects", "changed"):
        for name in dict.fromkeys(effect["effect"] for effect in result[key]):
            same = [effect for effect in result[key] if effect["effect"] == name]
            _effects(console, same, result["joints"])
    for entry in result.get("discovered", ()):
        console.print(f"\n[bold]a law of its own on {entry['joint']}[/bold]: {entry['formula']}")
        if entry.get("parameters"):
            _table(console, grids.parameters(entry), "")
        for line in law_facts(entry) if entry.get("form") else ():
            console.print(f"- {line}")
    _list(console, "left without a law:", [remaining(u) for u in result["unexplained"]])
    _list(console, "to be looked at:", flagged(result))
    _list(console, "no longer in the model:", taken_out(result))
    refused = [f"{where(s)} {s['because']}" for s in result.get("refused", ())]
    _list(console, "found and not kept:", refused)
    _list(console, "found in the logs:", log_notes(result))
    _list(console, "what to know and do next:", [*reasons(result), *next_steps(result)])
    if out is not None:
        console.print(f"\nreport: {out / 'report.html'}")


def _errors(console: Console, result: dict) -> None:
    on = result["error"]["after"]["on"]
    _table(console, grids.by_joint(result), f"RMS error of the torque on {on}")
    console.print(f"[dim]{grids.OVER_NOISE}[/dim]")
    if result["steps"] or "with_smooth_terms" in result["error"]:
        _table(console, grids.by_step(result), "by step")
    logs = grids.by_validation_log(result)
    if logs is not None:
        _table(console, logs, "every validation log")


def _effects(console: Console, same: list[dict], joints: list[str]) -> None:
    """One law with its parameters on all joints it was found on."""
    law = f": {same[0]['law']}" if same[0].get("law") else ""
    console.print(f"\n[bold]{grouped(same, joints)}[/bold]{law}")
    if same[0].get("meaning"):
        console.print(same[0]["meaning"])
    _table(console, grids.parameters_by_joint(same), "")
    for effect in same:
        others = ", ".join(f"{where(a)} ({a['relative_gain']:.2f})" for a in effect["alternatives"])
        if others:
            on = f" on {effect['joint']}" if same[1:] else ""
            console.print(f"runners-up{on} (gain, that of the effect being 1): {others}")


def _table(console: Console, grid: Grid, title: str) -> None:
    console.print("", Table(title, grid.head, tuple(grid.rows), grid.flagged), sep="\n")


def _list(console: Console, title: str, lines: list[str]) -> None:
    if lines:
        console.print(f"\n[bold]{title}[/bold]")
    for line in lines:
        console.print(f"- {line}")
