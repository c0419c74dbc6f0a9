"""Rows of a campaign: JSON lines that an interrupted run goes on from."""

import json
from pathlib import Path

from benchmarks.timing import RESULTS

FINDINGS = RESULTS / "trust_findings"


def path_of(part: str) -> Path:
    """Where the rows of a part stand."""
    RESULTS.mkdir(exist_ok=True)
    return RESULTS / f"trust_{part}.jsonl"


def read_rows(part: str) -> list[dict]:
    """All whole rows; a line cut short by an interruption is left out."""
    path, rows = path_of(part), []
    for line in path.read_text().splitlines() if path.exists() else ():
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError:
            continue
    return rows


def add_row(part: str, row: dict) -> None:
    """Write a row and say it."""
    text = json.dumps(row)
    with path_of(part).open("a") as file:
        file.write(text + "\n")
    print(text, flush=True)
