"""The tables of a diagnosis as plain text, shared by the page and the terminal; joints are rows."""

from collections.abc import Sequence
from typing import NamedTuple

from jaxswarm.diagnose.decision.rules import NEAR
from jaxswarm.diagnose.report.flags import bound_reached
from jaxswarm.diagnose.report.numbers import estimate, measure, number, percent, unit_text
from jaxswarm.diagnose.report.stages import stages
from jaxswarm.diagnose.report.text import where
from jaxswarm.effects import REGISTRY
from jaxswarm.identify.report.summary import SOUND

# What rounding leaves of a center [m], or of an inertia as a share of its link's, is told as nothing.
_NOTHING = 1e-9

FAR = "far"


# Rows differ in their noise, and those that say nothing are not fitted: it is no quotient of its neighbors.
OVER_NOISE = (
    "x noise: what the final model leaves on the rows that were fitted, each over its own noise"
)


class Grid(NamedTuple):
    """A table of text.

    Attributes:
        head: Heads of the columns.
        rows: Cells.
        flagged: Indices of rows that deserve a second look.
    """

    head: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    flagged: frozenset[int] = frozenset()


def by_joint(result: dict) -> Grid:
    """Error before and after, noise, and how far the final model is from it: a row a joint."""
    error, changed = result["error"], bool(result["steps"])
    before, after = error["before"], error["after"]
    over = result["residual_over_noise"] or [None] * len(result["joints"])
    head = ("joint", *(("before", "share") if changed else ()))
    head += ("after" if changed else "error", "share", "noise", "x noise", "unit")
    rows, flagged = [], set()
    for j, joint in enumerate(result["joints"]):
        far = over[j] is not None and over[j] > NEAR
        if far:
            flagged.add(j)
        row = [joint]
        for errors in (before, after) if changed else (after,):
            row += [measure(errors["rms"][j]), percent(errors["relative"][j])]
        row += [
            measure(error["noise_floor"]["rms"][j]),
            measure(over[j]),
            result["torque_units"][j],
        ]
        rows.append((*row, FAR if far else ""))
    whole = ["whole arm"]
    for errors in (before, after) if changed else (after,):
        whole += ["", percent(errors["relative_global"])]
    rows.append((*whole, "", "", "", ""))
    if not flagged:
        return Grid(head, [row[:-1] for row in rows])
    return Grid((*head, ""), rows, frozenset(flagged))


def by_step(result: dict) -> Grid:
    """The error of the whole arm, and of the joint an effect acts on, after every added effect."""
    joints, units, rows = result["joints"], result["torque_units"], []
    for stage in stages(result):
        told = ""
        if stage.joint in joints and stage.before is not None:
            j = joints.index(stage.joint)
            one, two = stage.before["rms"][j], stage.after["rms"][j]
            told = f"{stage.joint}: {measure(one)} to {measure(two)}{unit_text(units[j])}"
        rows.append((stage.name, told, percent(stage.after["relative_global"])))
    described = result["error"].get("with_smooth_terms")
    if described:
        share = percent(described["relative_global"])
        rows.append(("+ smooth terms without a law", "", share))
    head = ("model", "error of its joint", "whole arm")
    if not any(told for _, told, _ in rows):
        return Grid((head[0], head[2]), [(name, share) for name, _, share in rows])
    return Grid(head, rows)


def all_steps(result: dict) -> Grid:
    """The error of every joint after every added effect: a row a model."""
    models = [(stage.name, stage.after) for stage in stages(result)]
    if "with_smooth_terms" in result["error"]:
        models.append(("+ smooth terms without a law", result["error"]["with_smooth_terms"]))
    rows = [
        (name, *(number(x, 4) for x in e["rms"]), percent(e["relative_global"], 3))
        for name, e in models
    ]
    rows.append(("noise", *(measure(x) for x in result["error"]["noise_floor"]["rms"]), ""))
    joints = zip(result["joints"], result["torque_units"], strict=True)
    return Grid(("model", *(f"{j} [{unit}]" for j, unit in joints), "whole arm"), rows)


def by_validation_log(result: dict) -> Grid | None:
    """Error before and after on every validation log; None with fewer than two."""
    logs = result["error"].get("validation") or []
    if len(logs) < 2:
        return None
    rows: list[tuple] = []
    flagged = set()
    floor = result["error"]["noise_floor"]["rms"]
    for entry in logs:
        pairs = zip(
            result["joints"],
            result["torque_units"],
            entry["before"]["rms"],
            entry["after"]["rms"],
            floor,
            strict=True,
        )
        for joint, unit, one, two, low in pairs:
            grew = two > one and two > low
            if grew:
                flagged.add(len(rows))
            told = "grew" if grew else ""
            rows.append((entry["on"], joint, measure(one), measure(two), unit, told))
        shares = (percent(entry[k]["relative_global"]) for k in ("before", "after"))
        rows.append((entry["on"], "whole arm", *shares, "", ""))
    return Grid(("log", "joint", "before", "after", "unit", ""), rows, frozenset(flagged))


def parameters(effect: dict) -> Grid:
    """Value, 95 % interval and unit of an effect's parameters; of a change, what it was."""
    changed = any(row.get("change") for row in effect["parameters"].values())
    law = REGISTRY.get(effect.get("effect", ""))
    known = {p.name: p for p in law.parameters} if law else {}
    rows = []
    for name, row in effect["parameters"].items():
        value, between = estimate(row)
        side = bound_reached(row["value"], known[name]) if name in known else ""
        cells = [name, value, f"at {side} bound" if side else between]
        if changed:
            change = row.get("change")
            cells += [number(row.get("before"), 5), *(estimate(change) if change else ("-", "-"))]
        rows.append((*cells, "" if row["unit"] == "1" else row["unit"]))
    head = ("parameter", "value", "95 % interval")
    more = ("before", "change", "its 95 %") if changed else ()
    return Grid((*head, *more, "unit"), rows)


def parameters_by_joint(effects: list[dict]) -> Grid:
    """The parameters of one law on several joints, with the joint in front; on one alone as they are."""
    tables = [parameters(effect) for effect in effects]
    if len(tables) == 1:
        return tables[0]
    widest = max(tables, key=lambda grid: len(grid.head))
    rows = []
    for effect, grid in zip(effects, tables, strict=True):
        gap = ("-",) * (len(widest.head) - len(grid.head))
        rows += [(effect["joint"] or "", *row[:-1], *gap, row[-1]) for row in grid.rows]
    return Grid(("joint", *widest.head), rows)


def base_parameters(result: dict) -> Grid:
    """Every base parameter of the rigid body and of the effects with its interval and verdict."""
    rows, flagged = [], set()
    for k, row in enumerate(result.get("base_parameters", ())):
        if row["verdict"] not in SOUND:
            flagged.add(k)
        stands = "" if row["expression"] == row["name"] else row["expression"]
        unit = "" if row["unit"] == "1" else row["unit"]
        rows.append((row["name"], *estimate(row), unit, row["verdict"], stands, row["effect"]))
    head = ("parameter", "value", "95 % interval", "unit", "verdict", "stands for", "part of")
    return Grid(head, rows, frozenset(flagged))


def standard_parameters(result: dict) -> Grid:
    """Mass, center and inertia of every link: the rigid bodies nearest to the base parameters."""
    axes = ("xx", "yy", "zz", "xy", "xz", "yz")
    rows, flagged = [], set()
    for k, link in enumerate(result.get("physical_consistency", {}).get("links", ())):
        if not link["possible"]:
            flagged.add(k)
        six = [link["inertia"]["xyz".index(a[0])]["xyz".index(a[1])] for a in axes]
        size = _NOTHING * sum(map(abs, six[:3]))
        inertia = (0.0 if abs(x) < size else x for x in six)
        center = (0.0 if abs(x) < _NOTHING else x for x in link["center"])
        cells = (number(x, 3) for x in (link["mass"], *center, *inertia))
        rows.append((link["joint"], *cells, "" if link["possible"] else "no body has these"))
    head = ("link of", "mass [kg]", "x [m]", "y [m]", "z [m]", *(f"I{a} [kg m^2]" for a in axes))
    if not flagged:
        return Grid(head, [row[:-1] for row in rows])
    return Grid((*head, ""), rows, frozenset(flagged))


def not_added(result: dict) -> Grid:
    """Candidates that came nearest without being added, and why they were not."""
    rows = [
        (where(s), percent(s["share_of_error"], 1), "; ".join(s["rejected_because"]))
        for s in result["not_added"]
    ]
    return Grid(("candidate", "share of the error", "not added because"), rows)


def refused(result: dict) -> Grid:
    """Candidates that explained the fitted log and were not kept, and why."""
    rows = [(where(s), s["because"]) for s in result.get("refused", ())]
    return Grid(("candidate", "was found and not kept because it"), rows)


def rivals(effect: dict) -> Grid:
    """What else would have explained what an effect explains, and how well."""
    rows = [(where(a), f"{a['relative_gain']:.2f}") for a in effect["alternatives"]]
    return Grid(("runner-up", "gain, that of the effect being 1"), rows)


def formulas(entry: dict) -> Grid:
    """The shortest formulas that reach each error on other motion, and those that fit alike."""
    rows = [
        (p["formula"], number(p["bits"], 3), percent(p["error_on_other_motion"], 1))
        for p in entry["front"]
    ]
    rows += [
        (a["formula"], "", percent(a["error_on_other_motion"], 1)) for a in entry["alternatives"]
    ]
    return Grid(("formula", "bits", "of the error left in regions not fitted"), rows)
