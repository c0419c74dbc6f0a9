"""The table of the worlds: names, false additions, harm, coverage, edits, verdicts."""

import numpy as np

from benchmarks.worlds.laws import LAWS


def wilson(hits: int, total: int) -> str:
    """A rate with its 95 % Wilson interval."""
    if not total:
        return "-"
    z = 1.959964
    p = hits / total
    center = (p + z**2 / (2 * total)) / (1 + z**2 / total)
    half = z * np.sqrt(p * (1 - p) / total + z**2 / (4 * total**2)) / (1 + z**2 / total)
    low, high = 100 * max(center - half, 0.0), 100 * min(center + half, 1.0)
    return f"{hits}/{total} = {100 * p:.1f} % [{low:.1f}, {high:.1f}]"


def outcome(row: dict) -> str:
    """``right``, ``undecided``, ``missed``, ``false`` or ``crashed``.

    Right: all visible effects are named and nothing that is not there; an invisible one may be named. False
    outweighs missed. Undecided: what is wrong or absent among the names is told as a rival of a named one.
    """
    if "error" in row:
        return "crashed"
    truth = list(row["effects"])
    truth += [e for e in row["outside"] if e["kind"] in row["known"]]
    unnamable = [e for e in row["outside"] if e["kind"] not in row["known"]]
    there = {e["label"] for e in truth} | {e["label"] for e in row["inseparable"]}
    missing = {e["label"] for e in truth if e["visible"]} - set(row["added"])
    false = set(row["added"]) - there
    for e in unnamable:
        if e["visible"] and not any(u["joint"] == joint(e) for u in row["unexplained"]):
            missing.add(e["label"])
    if not missing and not false:
        return "right"
    if missing and all(rival_told(row, m) for m in missing) and len(false) <= len(missing):
        return "undecided"
    return "false" if false else "missed"


def joint(entry: dict) -> str | None:
    """Name of the joint an effect acts on first."""
    where = entry["label"].partition("@")[2]
    return where.partition(":")[0] or None


def rival_told(row: dict, label: str) -> bool:
    """Whether an effect is among those told as undecided."""
    kind, _, where = label.partition("@")
    return any(
        label in u["effects"]
        or (kind in u["effects"] and (not where or u["joint"] == where.partition(":")[0]))
        for u in row["undecided"]
    )


def category(row: dict) -> str:
    """What kind of world it is, by what can be seen of it."""
    truth = [*row["effects"], *row["outside"]]
    if row["outside"]:
        return "outside law, visible" if row["outside"][0]["visible"] else "outside law, faint"
    if not truth:
        return "inseparable effects only" if row["inseparable"] else "clean"
    if row["common"]:
        return "friction of all joints undeclared"
    visible = sum(e["visible"] for e in truth)
    return "faint effects only" if not visible else f"{len(truth)} effects, {visible} visible"


_OUTCOMES = ("right", "undecided", "missed", "false", "crashed")


def block(rows: list[dict], title: str, key) -> list[str]:
    """Outcomes by a property of the world."""
    lines = ["", f"| {title} | worlds | " + " | ".join(_OUTCOMES) + " | exactly right |"]
    lines.append("|---" * (len(_OUTCOMES) + 3) + "|")
    groups: dict = {}
    for row in rows:
        for name in key(row):
            groups.setdefault(name, []).append(outcome(row))
    for name in sorted(groups, key=str):
        own = groups[name]
        counts = [own.count(o) for o in _OUTCOMES]
        cells = " | ".join(str(c) for c in counts)
        lines.append(f"| {name} | {len(own)} | {cells} | {wilson(counts[0], len(own))} |")
    return lines


def summary(rows: list[dict]) -> list[str]:
    """The rates that are asked of the whole."""
    good = [r for r in rows if "error" not in r]
    clean = [r for r in good if category(r) == "clean"]
    few = [r for r in rows if category(r) in _FEW]
    outside = [r for r in good if category(r) == "outside law, visible"]
    hits = [i["hit"] for r in good if outcome(r) == "right" for i in r["intervals"]]
    edits = [r["edit"] for r in good if r.get("edit")]
    told = sum(outcome(r) == "right" for r in outside)
    facts = [
        ("crashes", len(rows) - len(good), len(rows)),
        ("clean: something added", sum(bool(r["added"]) for r in clean), len(clean)),
        ("harm on unseen motion", sum(bool(r["harm"]) for r in good), len(good)),
        ("the same, above the floor", sum(bool(r["harm_above_floor"]) for r in good), len(good)),
        ("harm, clean", sum(bool(r["harm"]) for r in clean), len(clean)),
        ("one or two effects, all visible: exactly right", _count(few, "right"), len(few)),
        ("the same: undecided with the right one", _count(few, "undecided"), len(few)),
        ("outside law told on its joint, no false name", told, len(outside)),
        ("parameters within their 95 % interval", sum(hits), len(hits)),
        ("verdict agrees with the noise floor", sum(r["consistent"] for r in good), len(good)),
        ("edit test passed", sum(e["passed"] for e in edits), len(edits)),
        ("the same, all that the term holds deleted, no oracle", _strict(edits), len(edits)),
    ]
    lines = ["| quantity | rate, 95 % interval |", "|---|---|"]
    lines += [f"| {name} | {wilson(hit, total)} |" for name, hit, total in facts]
    return lines + _unseen(good)


def _strict(edits: list[dict]) -> int:
    return sum(e.get("strict", e["passed"]) for e in edits)


_FEW = ("1 effects, 1 visible", "2 effects, 2 visible")


def _count(rows, wanted):
    return sum(outcome(r) == wanted for r in rows)


def _unseen(rows: list[dict]) -> list[str]:
    """Worst joint's unseen error over the floor: quartiles and 95th percentile, per model."""
    lines = ["", "| unseen error over the floor, worst joint | 25 % | 50 % | 75 % | 95 % |"]
    lines.append("|---|---|---|---|---|")
    for which in ("declared", "final"):
        for test in ("test_ptp", "test_fourier"):
            worst = [
                max(np.array(r["errors"][which][test]) / np.array(r["errors"]["floor"][test]))
                for r in rows
            ]
            if worst:
                cells = " | ".join(f"{x:.2f}" for x in np.percentile(worst, [25, 50, 75, 95]))
                lines.append(f"| {which}, {test} | {cells} |")
    return lines


def kinds_of(row: dict) -> list[str]:
    """The visible kinds of a world."""
    if row["common"]:
        return ["(common friction)"]
    truth = [*row["effects"], *row["outside"]]
    seen = [e["kind"] + " (outside)" * LAWS[e["kind"]].outside for e in truth if e["visible"]]
    return seen or (["(faint)"] if truth else ["(clean)"])


def worlds_table(rows: list[dict]) -> str:
    """All of it as markdown."""
    lines = summary(rows)
    lines += block(rows, "category", lambda r: [category(r)])
    lines += block(rows, "kind", kinds_of)
    lines += block(rows, "joints", lambda r: [r["size"]])
    lines += block(rows, "controller", lambda r: [r["controller"]])
    lines += block(rows, "motion", lambda r: [r["motion"]])
    lines += block(rows, "declared", lambda r: [r["declares"]])
    lines += block(rows, "second log", lambda r: ["yes" if r["checked"] else "no"])
    return "\n".join(lines) + "\n"
