"""The page of a fleet: who needs a look first, what differs, what drifts, which logs could not be used."""

from collections import Counter
from collections.abc import Callable, Sequence
from html import escape
from typing import Any

from jaxswarm.diagnose.report.grids import Grid
from jaxswarm.diagnose.report.markup import bullets, folded, image, table, text
from jaxswarm.diagnose.report.numbers import measure, number, unit_text
from jaxswarm.diagnose.report.style import STYLE
from jaxswarm.fleet.collect import Fleet
from jaxswarm.fleet.drift import Drift
from jaxswarm.fleet.mixed_model import FALSE_DISCOVERIES, LEAST_ARMS, Deviation
from jaxswarm.fleet.one_log import FAILED, REFUSED
from jaxswarm.fleet.ranking import Arm

# Lines of a table on the page; the rest stands in the Parquet file.
_MOST = 200
# Names that a cell holds.
_NAMES = 4


def render(
    robot: str,
    fleet: Fleet,
    arms: Sequence[Arm],
    deviations: Sequence[Deviation] | None,
    drifts: Sequence[Drift],
    images: dict[str, bytes],
) -> str:
    """The page as text.

    Args:
        robot: Kind of the arms.
        fleet: All logs.
        arms: In order of rank.
        deviations: What the comparison of the arms says; None: it was not asked for.
        drifts: What changed on each arm.
        images: Pictures as PNG bytes by file name.
    """
    sections = [
        _verdict(robot, fleet, arms),
        "<h2>Arms, worst first</h2>",
        _soft(
            "First those on which something was found, then by how far the newest log is from the noise."
        ),
        _cut(arms, _ranked, "arms by rank"),
        _against(fleet, deviations),
        _drifts(fleet, drifts, images),
        _unused(fleet),
    ]
    title = escape(f"{robot}: {len(arms)} arms - jaxswarm")
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        f'<link rel="icon" href="data:,"><title>{title}</title><style>{STYLE}</style></head>'
        f"<body><main>{''.join(sections)}</main></body></html>\n"
    )


def headline(arms: Sequence[Arm]) -> str:
    """One sentence on the whole fleet."""
    told = {
        ("lacks or changed an effect", "lack or changed an effect"): sum(
            bool(a.found) for a in arms
        ),
        ("differs from its sisters", "differ from their sisters"): sum(
            bool(a.differs) for a in arms
        ),
        ("drifts", "drift"): sum(bool(a.drifts) for a in arms),
    }
    parts = [f"{count} {words[count > 1]}" for words, count in told.items() if count]
    return f"Of {len(arms)} arms {', '.join(parts) or 'none stands out'}."


def verdicts(fleet: Fleet) -> dict[str, int]:
    """Number of logs by verdict, most frequent first."""
    return dict(Counter(entry.verdict for entry in fleet.entries).most_common())


def _verdict(robot: str, fleet: Fleet, arms: Sequence[Arm]) -> str:
    counts = ", ".join(f"{count} {word}" for word, count in verdicts(fleet).items())
    return (
        f'<h1>{escape(robot)}: a fleet</h1><div class="verdict">'
        f"{text('strong', headline(arms))}{text('p', f'{len(fleet.entries)} logs: {counts}.')}</div>"
    )


def _soft(sentence: str) -> str:
    return text("p", sentence, "soft")


def _cut(rows: Sequence[Any], grid: Callable[[Sequence[Any]], Grid], label: str) -> str:
    """A table of the first rows, and where the others are."""
    more = len(rows) - _MOST
    rest = _soft(f"{more} more stand in fleet.parquet.") if more > 0 else ""
    return table(grid(rows[:_MOST]), label) + rest


def _ranked(arms: Sequence[Arm]) -> Grid:
    head = ("arm", "logs", "newest", "verdict", "found", "x noise", "differs in", "drifts in")
    rows = [
        (
            arm.name,
            f"{arm.logs}" + (f" ({arm.unused} unused)" if arm.unused else ""),
            "-" if arm.last is None else f"{arm.last:%Y-%m-%d}",
            arm.verdict,
            _few(arm.found),
            measure(arm.worst),
            _few(arm.differs),
            _few(arm.drifts),
        )
        for arm in arms
    ]
    flagged = frozenset(k for k, a in enumerate(arms) if a.found or a.differs or a.drifts)
    return Grid(head, rows, flagged)


def _few(names: Sequence[str]) -> str:
    more = len(names) - _NAMES
    return ", ".join(names[:_NAMES]) + (f" and {more} more" if more > 0 else "")


def _against(fleet: Fleet, deviations: Sequence[Deviation] | None) -> str:
    if deviations is None:
        return ""
    told = sorted((d for d in deviations if d.differs), key=lambda d: d.q_value)
    how = (
        f"Every parameter of every arm beside those of the other arms: {len(deviations)} comparisons; of "
        f"those told at most {FALSE_DISCOVERIES:.0%} are expected to be chance."
    )
    if not deviations:
        how = f"No parameter was found on {LEAST_ARMS} arms or more: nothing can be compared."
    elif not told:
        how += " No arm differs."
    return f"<h2>Arms that differ from their sisters</h2>{_soft(how)}" + _cut(
        told, lambda rows: _differing(fleet, rows), "arms that differ from their sisters"
    )


def _differing(fleet: Fleet, rows: Sequence[Deviation]) -> Grid:
    head = (
        "arm",
        "joint",
        "parameter",
        "value",
        "others",
        "spread of others",
        "false discovery rate",
    )
    cells = []
    for one in rows:
        unit, joint = fleet.parameters[one.parameter]
        value = f"{number(one.value)}{unit_text(unit)}"
        others = f"{number(one.center)}{unit_text(unit)}"
        cells.append(
            (one.arm, joint or "-", one.parameter, value, others, number(one.spread, 2),
             number(one.q_value, 2))
        )  # fmt: skip
    return Grid(head, cells)


def _drifts(fleet: Fleet, drifts: Sequence[Drift], images: dict[str, bytes]) -> str:
    told = sorted((d for d in drifts if d.drifts), key=lambda d: d.q_value)
    if not told and not images:
        return ""
    how = (
        f"Slope of every parameter over the dates of an arm's logs: {len(drifts)} were asked, false "
        f"discoveries held to {FALSE_DISCOVERIES:.0%}."
        if drifts
        else "Too few arms have logs of several days to tell a change from the scatter of single logs."
    )
    return "".join(
        (
            f"<h2>Drift over time</h2>{_soft(how)}",
            _cut(told, lambda rows: _changes(fleet, rows), "parameters that drift"),
            image(
                images, "drift.png", "Residual over noise of every joint over time; 1 is the noise."
            ),
            image(
                images, "changed.png", "Parameters that changed, with 95 % bars; gray: other arms."
            ),
        )
    )


def _changes(fleet: Fleet, rows: Sequence[Drift]) -> Grid:
    head = ("arm", "joint", "parameter", "from", "to", "change (95 %)", "days", "logs")
    cells = []
    for one in rows:
        unit, joint = fleet.parameters[one.parameter]
        change = f"{number(one.change, 3)} +- {number(1.96 * one.std_error, 2)}{unit_text(unit)}"
        cells.append(
            (one.arm, joint or "-", one.parameter, number(one.begin), number(one.end), change,
             number(one.days, 3), str(one.logs))
        )  # fmt: skip
    return Grid(head, cells)


def _unused(fleet: Fleet) -> str:
    refused = [entry for entry in fleet.entries if entry.verdict in (REFUSED, FAILED)]
    content = bullets(f"{one.source.path}: {one.verdict}: {one.reason}" for one in refused[:_MOST])
    more = len(refused) - _MOST
    rest = _soft(f"{more} more stand in fleet.parquet.") if more > 0 else ""
    return (
        folded(
            f"{len(refused)} log{'s' * (len(refused) > 1)} that could not be used", content + rest
        )
        if refused
        else ""
    )
