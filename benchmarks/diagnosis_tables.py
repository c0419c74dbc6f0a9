"""Tables and the confusion matrix of the suite."""

import json
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from benchmarks.diagnosis_cases import CLEAN, RATIOS, UNLISTED


def summarize(rows: list[dict], stem: Path) -> str:
    """Rates and limits as markdown; written with the confusion matrix beside ``stem``."""
    hidden = [r for r in rows if r["truth"]]
    clean = [r for r in rows if r["effect"] in CLEAN]
    visible = [r for r in hidden if r["visible"]]
    lines = ["| quantity | value |", "|---|---|"]
    if visible:
        named = sum(r["found"] for r in visible)
        exact = sum(r["found"] and not r["false"] for r in visible)
        rival = sum(not r["found"] and is_rival(r) for r in visible)
        lines += [
            f"| visible cases: right effect on the right joint | {_rate(named, len(visible))} |",
            f"| the same and nothing else added | {_rate(exact, len(visible))} |",
            f"| another law added, the right one told as undecided from it | {_rate(rival, len(visible))} |",
        ]
    for kind in CLEAN:
        own = [r for r in clean if r["effect"] == kind]
        if own:
            lines.append(
                f"| false additions, {kind} noise | {_rate(sum(bool(r['added']) for r in own), len(own))} |"
            )
    for law in UNLISTED:
        own = [r for r in rows if r["effect"] == law and r["ratio"] > 0.999]
        if own:
            lines.append(
                f"| {law}: flagged, right variables | {_rate(sum(flagged(r) for r in own), len(own))} |"
            )
    z = [abs(i["z"]) for r in visible if r["found"] and not r["false"] for i in r["intervals"]]
    if z:
        lines.append(
            f"| coverage of 95 % intervals | {_rate(int((np.array(z) < 1.96).sum()), len(z))} |"
        )
    lines += ["", "| effect | " + " | ".join(f"ratio {r:g}" for r in RATIOS) + " | limit (90 %) |"]
    lines.append("|---" * (len(RATIOS) + 2) + "|")
    for effect in dict.fromkeys(r["effect"] for r in hidden):
        own = [r for r in hidden if r["effect"] == effect]
        cells, limit = [], None
        for level in range(len(RATIOS)):
            at = [r for r in own if r["level"] == level]
            found = sum(r["found"] for r in at)
            size = np.median([r["ratio"] for r in at]) if at else np.nan
            cells.append(f"{found}/{len(at)} ({size:.2g})" if at else "")
            good = bool(at) and found >= 0.9 * len(at)
            limit = (size if limit is None else limit) if good else (limit if not at else None)
        lines.append(
            f"| {effect} | " + " | ".join(cells) + f" | {'' if limit is None else f'{limit:.2g}'} |"
        )
    text = "\n".join(lines) + "\n"
    stem.with_suffix(".md").write_text(text)
    counts = confusion(visible + clean)
    stem.with_suffix(".json").write_text(json.dumps(counts, indent=1))
    draw(counts, stem.with_suffix(".png"))
    return text


def is_rival(row: dict) -> bool:
    """Whether the hidden effect was reported as a rival the data do not tell from what was added."""
    return any(label in row["truth"] for rivals in row["tied"] for label in rivals)


def flagged(row: dict) -> bool:
    """Whether an unlisted law was called unexplained on its joint, by the variables it depends on."""
    j = row["joint"] + 1
    other = (row["joint"] + 1) % 3 + 1
    q = f"q_joint{other}" if row["effect"] == "crossed_velocity" else f"q_joint{j}"
    wanted = {q, f"dq_joint{j}"}
    return any(
        u["joint"] == row["joint"] and set(u["depends_on"]) == wanted for u in row["unexplained"]
    )


def confusion(rows: list[dict]) -> dict[str, dict[str, int]]:
    """Counts: hidden effect, then first effect that was added (``@elsewhere`` on another joint)."""
    counts: dict[str, dict[str, int]] = {}
    for row in rows:
        label = row["added"][0] if row["added"] else "nothing"
        told = label.split("@")[0]
        if row["truth"] and told == row["effect"] and label not in row["truth"]:
            told += "@elsewhere"
        truth = row["effect"] if row["truth"] else "nothing"
        inner = counts.setdefault(truth, {})
        inner[told] = inner.get(told, 0) + 1
    return counts


def draw(counts: dict, path: Path) -> None:
    """The confusion matrix as a picture."""
    truths = list(counts)
    told = sorted(
        {t for inner in counts.values() for t in inner}, key=lambda t: (t not in truths, t)
    )
    matrix = np.array([[counts[a].get(b, 0) for b in told] for a in truths])
    figure = Figure(figsize=(2 + 0.5 * len(told), 1.5 + 0.35 * len(truths)), layout="constrained")
    axes = figure.add_subplot()
    axes.imshow(
        matrix / np.maximum(matrix.sum(axis=1, keepdims=True), 1), cmap="Blues", vmin=0, vmax=1
    )
    axes.set_xticks(range(len(told)), told, rotation=60, ha="right")
    axes.set_yticks(range(len(truths)), truths)
    axes.set_xlabel("first effect added")
    axes.set_ylabel("hidden effect (visible)")
    for (i, k), count in np.ndenumerate(matrix):
        if count:
            axes.text(k, i, count, ha="center", va="center")
    figure.savefig(path, dpi=120)


def _rate(hits: int, total: int) -> str:
    return f"{hits}/{total} ({100 * hits / total:.1f} %)"
