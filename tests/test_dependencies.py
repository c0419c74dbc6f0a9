"""What the package brings along is told, and an audit that could not ask is no good news."""

import importlib.util
import json
import os
import stat
from pathlib import Path

import pytest

from benchmarks.dependencies import KNOWN, Row, audited, closure

ROOT = Path(__file__).resolve().parents[1]
ROWS = [Row("one", "1.0", "MIT", "jaxswarm", ""), Row("two", "2.0", "MIT", "one", "")]
needs_metadata = pytest.mark.skipif(
    importlib.util.find_spec("packaging") is None, reason="no packaging"
)


@needs_metadata
def test_what_comes_along_is_told_with_who_wants_it():
    rows = {row.package: row for row in closure()}
    assert {"jax", "numpy", "scipy", "rich"} <= rows.keys() & KNOWN
    # What is new among them is for the daily step to tell, not for every change.
    assert all(
        row.version and (row.wanted_by == "jaxswarm" or row.wanted_by in rows)
        for row in rows.values()
    )


@pytest.mark.parametrize(
    ("answers", "told"),
    [
        ([{"name": "one", "vulns": []}, {"name": "two", "vulns": []}], ""),
        ([{"name": "one", "vulns": [{"id": "CVE-7"}]}, {"name": "two", "vulns": []}], "one: CVE-7"),
        ([{"name": "one", "vulns": []}, {"name": "two", "skip_reason": "not found"}], "1 of 2"),
        ([{"name": "one", "vulns": []}], "two: left out"),
        (None, "no answer"),
    ],
)
def test_an_audit_that_could_not_ask_says_so(answers, told, tmp_path):
    said = "nothing" if answers is None else json.dumps({"dependencies": answers})
    program = tmp_path / "audit"
    program.write_text(f"#!/bin/sh\necho '{said}'\n")
    program.chmod(0o755)
    found = audited(ROWS, str(program))
    assert found == "" if not told else told in found


def test_the_daily_step_calls_what_it_promises():
    script = ROOT / ".ci" / "daily"
    assert os.stat(script).st_mode & stat.S_IXUSR
    text = script.read_text()
    assert "benchmarks.installed" in text and "benchmarks.dependencies" in text
