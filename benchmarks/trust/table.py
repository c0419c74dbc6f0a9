"""Everything that was tried so far, in one table."""

from collections import Counter

from benchmarks.trust.rows import read_rows
from benchmarks.trust.spoiled import AS_IT_IS, ELSE, HIDDEN, QUIET, SAID, UNSAID, WRONG


def table() -> str:
    """Rows of Markdown: what was tried, how often, and what fell."""
    rows = [
        "| campaign | tried | outcome |",
        "|---|---|---|",
        *_inputs(),
        *_commands(),
        *_faults(),
        *_spoiled(),
        *_null(),
        *_same(),
    ]
    return "\n".join(rows)


def _inputs() -> list[str]:
    chunks = [row for row in read_rows("fuzz") if row["kind"] == "inputs"]
    counts: Counter[str] = Counter()
    for row in chunks:
        counts.update({k.rsplit(" ", 1)[1]: n for k, n in _summed(row["counts"]).items()})
    if not chunks:
        return []
    fell = sum(n for kind, n in counts.items() if kind not in ("refused", "accepted"))
    slowest = max(row["slowest"] for row in chunks)
    return [
        f"| inputs spoiled by structure | {sum(counts.values())} | {counts['refused']} refused, "
        f"{counts['accepted']} read, {fell} findings; slowest {slowest:.1f} s |"
    ]


def _summed(counts: dict[str, int]) -> Counter[str]:
    found: Counter[str] = Counter()
    for name, number in counts.items():
        found[f"all {name.rsplit(' ', 1)[1]}"] += number
    return found


def _commands() -> list[str]:
    rows = [row for row in read_rows("fuzz") if row["kind"] == "command"]
    if not rows:
        return []
    codes = Counter(row["code"] for row in rows)
    fell = sum(bool(row["finding"]) for row in rows)
    return [
        f"| whole commands, odd options and files | {len(rows)} | {codes[2]} refused, {codes[0]} done, "
        f"{fell} findings |"
    ]


def _faults() -> list[str]:
    tried: Counter[str] = Counter()
    survived: Counter[str] = Counter()
    for row in read_rows("faults"):
        name = row["fault"].split(" ")[0] if " of " in row["fault"] else row["fault"].split(":")[0]
        name = "kill -9 at a random moment" if name in ("kill", "kills") else name
        tried[name] += row["tries"]
        survived[name] += row["tries"] * row["survived"]
    return [f"| {name} | {tried[name]} | {survived[name]} survived |" for name in tried]


def _spoiled() -> list[str]:
    every = read_rows("spoiled")
    clean = [row for row in every if row["spoiling"] == AS_IT_IS]
    rows = [row for row in every if row["spoiling"] != AS_IT_IS]
    if not rows:
        return []
    counts = Counter(row["outcome"] for row in rows)
    arms = len({row["arm"] for row in rows})
    lines = [
        f"| logs of {arms} arms spoiled in {len({r['spoiling'] for r in rows})} ways | {len(rows)} | "
        f"{counts[SAID]} said by name, {counts[UNSAID]} not before a fit, {counts[QUIET]} by none and no wrong "
        f"effect, {counts[WRONG]} with a wrong effect, {counts[ELSE]} refused for another reason, "
        f"{counts[HIDDEN]} that another robot explains as well |",
        f"| the same logs as they are | {len(clean)} | {sum(r['refused'] for r in clean)} refused |",
    ]
    fell = Counter(row["spoiling"] for row in rows if row["outcome"] not in (SAID, HIDDEN))
    if fell:
        told = ", ".join(f"{name} ({n} of {arms})" for name, n in fell.most_common())
        lines.append(f"| not said by name | {sum(fell.values())} | {told} |")
    return lines


def _null() -> list[str]:
    kinds: dict[str, list[bool]] = {}
    for row in read_rows("null"):
        kinds.setdefault(row["kind"], []).append(bool(row["added"]))
    return [
        f"| {kind} | {len(all_)} | {sum(all_)} with an addition |" for kind, all_ in kinds.items()
    ]


def _same() -> list[str]:
    rows = read_rows("determinism")
    if not rows:
        return []
    ways, fell = len({row["way"] for row in rows}), [row for row in rows if not row["same"]]
    told = ", ".join(f"{row['job']} with {row['way']}" for row in fell)
    jobs = len({row["job"] for row in rows})
    return [
        f"| {jobs} jobs in {ways} other surroundings | {len(rows)} | {len(rows) - len(fell)} the same bytes"
        f"{'; not ' * bool(fell)}{told} |"
    ]
