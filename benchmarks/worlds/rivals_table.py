"""The rivals beside this project's own diagnosis of the same worlds."""

import numpy as np

from benchmarks.worlds.table import category, outcome, wilson

_TESTS = ("test_ptp", "test_fourier")


def rivals_table(rows: list[dict], own: list[dict]) -> str:
    """Markdown: names right, false terms, additions to clean worlds, harm, unseen error over the floor."""
    lines = [
        "| method | exactly right (visible effects) | false terms a world | clean: something added "
        "| harm | unseen error over the floor: 50 %, 95 % |",
        "|---|---|---|---|---|---|",
    ]
    if not rows:
        return "\n".join(lines) + "\n"
    ours = {r["world"]: r for r in own if "error" not in r}
    shared = [ours[r["world"]] for r in rows if r["world"] in ours]
    if shared:
        lines.append(_own(shared))
    for name in rows[0]["rivals"]:
        lines.append(_rival(name, rows))
    worst = [_over(r["declared_error"], r["floor"]) for r in rows]
    lines.append(f"| (declared model, plain) | | | | | {_two(worst)} |")
    return "\n".join(lines) + "\n"


def _own(rows: list[dict]) -> str:
    seen = [r for r in rows if _visible(r)]
    clean = [r for r in rows if category(r) == "clean"]
    false = [len(set(r["added"]) - _there(r)) for r in rows]
    worst = [_over(r["errors"]["final"], r["errors"]["floor"]) for r in rows]
    return (
        f"| jaxswarm | {wilson(sum(outcome(r) == 'right' for r in seen), len(seen))} "
        f"| {np.mean(false):.2f} | {wilson(sum(bool(r['added']) for r in clean), len(clean))} "
        f"| {wilson(sum(bool(r['harm']) for r in rows), len(rows))} | {_two(worst)} |"
    )


def _rival(name: str, rows: list[dict]) -> str:
    seen = [r for r in rows if _visible(r)]
    clean = [r for r in rows if category(r) == "clean"]
    named = {r["world"]: set(r["rivals"][name]["named"]) for r in rows}
    right = sum(_visible(r) <= named[r["world"]] <= _there(r) for r in seen)
    false = np.mean([len(named[r["world"]] - _there(r)) for r in rows])
    worst = [_over(r["rivals"][name]["error"], r["floor"]) for r in rows]
    return (
        f"| {name} | {wilson(right, len(seen))} | {false:.2f} "
        f"| {wilson(sum(bool(named[r['world']]) for r in clean), len(clean))} "
        f"| {wilson(sum(r['rivals'][name]['harm'] for r in rows), len(rows))} | {_two(worst)} |"
    )


def _visible(row: dict) -> set[str]:
    return {e["label"] for e in (*row["effects"], *row["outside"]) if e["visible"]}


def _there(row: dict) -> set[str]:
    return {e["label"] for part in ("effects", "outside", "inseparable") for e in row[part]}


def _over(error: dict, floor: dict) -> float:
    """Error over the floor of the worst joint on the worst test."""
    return max(float((np.array(error[t]) / np.array(floor[t])).max()) for t in _TESTS)


def _two(values: list[float]) -> str:
    return ", ".join(f"{x:.2f}" for x in np.percentile(values, [50, 95]))
