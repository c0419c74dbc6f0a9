"""What comes with jaxswarm: every package that pip brings along, who wants it, its license, known weaknesses.

    python -m benchmarks.dependencies [--audit PROGRAM]

Told from what is installed beside the interpreter that runs this: the packages of pyproject.toml and, step by
step, all that they need. Wrong is a package that nobody has looked at (it is not in ``KNOWN``) or a license
that is not a permissive one. ``--audit`` hands names and versions to pip-audit, which asks PyPI's list of known
vulnerabilities: that needs a network. Exit code 1 if anything is wrong, or could not be asked.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

TAKES = "seconds; --audit a minute of network"

# Packages that were looked at: kept by the authors of JAX, NumPy, SciPy, Matplotlib, Rich, Typer, Pydantic
# and Clarabel (University of Oxford; CVXPY's own solver of cones), by those they build on, or by Python's own.
KNOWN = frozenset(
    "jax jaxlib ml-dtypes opt-einsum optax absl-py chex toolz typing-extensions numpy scipy clarabel cffi "
    "pycparser matplotlib contourpy cycler fonttools kiwisolver packaging pillow pyparsing "
    "python-dateutil six rich markdown-it-py mdurl pygments typer click shellingham annotated-doc setuptools "
    "pydantic pydantic-core annotated-types typing-inspection tzdata".split()
)
_PERMISSIVE = (
    "apache",
    "mit",
    "bsd",
    "psf",
    "python software foundation",
    "isc",
    "hpnd",
    "mit-cmu",
)
# Statements on several licenses are long; none is needed beyond its first line.
_SHOWN = 60


class Row(NamedTuple):
    """A package, its version, its license, who wants it, and what is wrong with it (empty: nothing)."""

    package: str
    version: str
    license: str
    wanted_by: str
    wrong: str


def closure(package: str = "jaxswarm") -> list[Row]:
    """Everything that an installation of a package without its extras brings along."""
    from packaging.requirements import Requirement
    from packaging.utils import canonicalize_name

    wanted: dict[str, str] = {}
    todo = [package]
    while todo:
        one = todo.pop()
        for text in metadata.requires(one) or ():
            need = Requirement(text)
            name = canonicalize_name(need.name)
            asked = [{"extra": extra} for extra in ("", *need.extras)]
            if need.marker is not None and not any(need.marker.evaluate(e) for e in asked):
                continue
            if name not in wanted:
                wanted[name] = one
                todo.append(name)
    return [_row(name, by) for name, by in sorted(wanted.items())]


def _row(name: str, by: str) -> Row:
    told = metadata.metadata(name)
    classes = [c.rpartition(" :: ")[2] for c in told.get_all("Classifier", []) if "License" in c]
    text = told.get("License-Expression") or told.get("License") or ", ".join(classes)
    text = (text.strip().splitlines() or ["none told"])[0][:_SHOWN]
    known = " ".join([text, *classes]).lower()
    wrong = [] if name in KNOWN else ["nobody has looked at it"]
    if not any(word in known for word in _PERMISSIVE):
        wrong.append("not known to be permissive")
    return Row(name, metadata.version(name), text, by, ", ".join(wrong))


def audited(rows: list[Row], program: str) -> str:
    """What pip-audit says of the versions; empty: all were asked for, with no known vulnerability.

    It ends well, too, where it knows nothing of a package, as without a way to PyPI: what it left out is told.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "installed.txt"
        path.write_text("".join(f"{row.package}=={row.version}\n" for row in rows))
        words = [program, "--no-deps", "--disable-pip", "--progress-spinner", "off"]
        done = subprocess.run([*words, "-f", "json", "-r", path], capture_output=True, text=True)
    try:
        found = json.loads(done.stdout)["dependencies"]
    except (ValueError, KeyError):
        return f"no answer of pip-audit: {done.stderr.strip()[-500:]}"
    return told_by(found, rows)


def told_by(found: list[dict], rows: list[Row]) -> str:
    """What is wrong by the answers of pip-audit on the packages of rows, in words.

    >>> told_by([{"name": "a", "vulns": [{"id": "CVE-1"}]}, {"name": "b", "skip_reason": "not found"}], [])
    'a: CVE-1; 1 of 2 packages could not be asked about (b: not found)'
    """
    words = [
        f"{one['name']}: {', '.join(v['id'] for v in one['vulns'])}"
        for one in found
        if one.get("vulns")
    ]
    asked = {one["name"] for one in found}
    unasked = [f"{one['name']}: {one['skip_reason']}" for one in found if "skip_reason" in one]
    unasked += [f"{row.package}: left out" for row in rows if row.package not in asked]
    if unasked:
        count = max(len(found), len(rows))
        words.append(f"{len(unasked)} of {count} packages could not be asked about ({unasked[0]})")
    return "; ".join(words)


def main() -> None:
    """Print the table, and what is wrong."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--audit", metavar="PROGRAM", help="pip-audit, which needs a network")
    options = parser.parse_args()
    rows = closure()
    print("| package | version | license | wanted by | wrong |\n|---|---|---|---|---|")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    wrong = [f"{row.package}: {row.wrong}" for row in rows if row.wrong]
    if options.audit is not None:
        told = audited(rows, options.audit)
        print(f"\npip-audit, {len(rows)} packages: {told or 'no known vulnerability'}")
        wrong += [told] if told else []
    if wrong:
        sys.exit("wrong: " + "; ".join(wrong))


if __name__ == "__main__":
    main()
