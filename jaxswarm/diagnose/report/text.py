"""The diagnosis in sentences, shared by the report and the terminal."""

import math
from collections import Counter

from jaxswarm.diagnose.decision.rules import NEAR
from jaxswarm.diagnose.report.error_change import error_change
from jaxswarm.diagnose.report.numbers import percent, unit_text
from jaxswarm.diagnose.report.numbers import value_text as value_text
from jaxswarm.diagnose.report.refusal import worth_a_longer_log
from jaxswarm.diagnose.report.remains import (
    fit_beyond,
    left_beyond,
    left_in_doubt,
    left_of,
    left_open,
    left_undecided,
    look_at,
    near_noise,
)
from jaxswarm.diagnose.report.rivals import either_of, not_told_apart, to_tell_apart
from jaxswarm.effects import REGISTRY
from jaxswarm.identify.report.console import clock_lines, event_lines, rest_lines, unscored_lines


def where(entry: dict) -> str:
    """``stribeck_friction on joint2``, ``time_delay``."""
    if entry.get("joint") is None:
        return entry["effect"]
    other = f" (driven by {entry['other']})" if entry.get("other") else ""
    return f"{entry['effect']} on {entry['joint']}{other}"


def grouped(entries: list[dict], joints: list[str], between: str = ", ") -> str:
    """Effects with their joints, each effect once: ``coulomb_friction on every joint``."""
    places: dict[str, list[str]] = {}
    for entry in entries:
        other = f" (driven by {entry['other']})" if entry.get("other") else ""
        way = f" ({entry['way']})" if entry.get("way") else ""
        places.setdefault(entry["effect"] + way, []).append(f"{entry['joint'] or ''}{other}")
    told = []
    for effect, names in places.items():
        whole = len(joints) > 1 and sorted(names) == sorted(joints)
        times = Counter(filter(None, names))  # of what acts in one log, one for each
        each = [f"{name} in {n} logs" if n > 1 else name for name, n in times.items()]
        on = "every joint" if whole else " and ".join(each)
        told.append(f"{effect} on {on}" if on else effect)
    return between.join(told)


def taken_out(result: dict) -> list[str]:
    """What is no longer in the model, and why: declared or added, it is part of another effect, or idle."""

    def key(entry: dict) -> tuple:
        return entry["effect"], entry.get("joint"), entry.get("other")

    within = {
        key(entry): where(step["added"])
        for step in result["steps"]
        for entry in step.get("removed", ())
    }
    declared = {key(entry) for entry in result["declared"]}
    told = []
    for entry in result["removed"]:
        was = "declared" if key(entry) in declared else "added"
        now = within.get(key(entry))
        told.append(
            f"{where(entry)} ({was}; {f'now part of {now}' if now else 'without it nothing is worse'})"
        )
    return told


def verdict_sentence(result: dict) -> str:
    """The verdict in one sentence, with the error before and after, and how far it is proven."""
    return f"{evidence_sentence(result)} {_PROOF[result['proof']]}".strip()


def evidence_sentence(result: dict) -> str:
    """The verdict in one sentence, with the error before and after."""
    if result["error"]["before"] is None or result["verdict"] == "cannot be judged":
        # Where a fit was made, the first one says why; the others are about what it found.
        why = result["reasons"][: None if result["error"]["before"] is None else 1]
        return "This log cannot be judged: " + "; ".join(why) + "."
    change = error_change(result)
    added = _found(result)
    left = left_of(result["unexplained"]) or left_beyond(result)
    unknown = _unknown(result) if result["unexplained"] else "that this log does not show"
    sentences = {
        "nothing missing": f"Nothing is missing: no known effect lowers the error on unseen motion "
        f"beyond chance, and what is left is near the noise (error {change}).",
        "explained": f"{added} (error {change}).",
        "partly explained": f"{added} (error {change}), and more is missing {unknown}: {left}.",
        "unexplained": f"Something is missing {unknown}: {left} (error {change}).",
    }
    told = [sentences[result["verdict"]]]
    if result["verdict"] in ("nothing missing", "explained"):
        told += [left_in_doubt(result), left_undecided(result)]
    return " ".join(filter(None, told))


def _unknown(result: dict) -> str:
    """Why what is left has no law, as a clause."""
    if result.get("budget"):  # a search that was cut short has not asked every law
        return "that the budget left no time for"
    if unshown := _unshown(result):
        names = " or ".join(unshown)
        return f"that this log cannot show ({names} would help, but no part of it predicts another)"
    if result["undecided"] and not result["effects"]:
        return f"that this log does not tell ({' or '.join(either_of(result))})"
    return "that no known law explains"


def _unshown(result: dict) -> list[str]:
    """Laws of the catalog that would lower the error, had the log a part that predicts another.

    Not those of a joint that others have brought near its noise since.
    """
    left = dict(zip(result["joints"], result["residual_over_noise"], strict=False))
    unshown = [entry for entry in result.get("refused", ()) if entry.get("unshown")]
    return [where(entry) for entry in unshown if left.get(entry["joint"], math.inf) > NEAR]


_PROOF = {
    "other motion": "",
    "held-out regions": "Shown on regions of this motion that were not fitted; to prove it, record another "
    "motion and pass it with --validation.",
    "none": "Not proven: record another motion and pass it with --validation.",
}


def proof_sentence(result: dict) -> str:
    """On what motion the outcome is shown, in one sentence."""
    if result["error"]["before"] is None:
        return "Nothing was fitted, nothing is proven."
    if _PROOF[result["proof"]]:
        return _PROOF[result["proof"]]
    logs = [entry["on"] for entry in result["error"]["validation"]]
    leads = f"; the worst of them, {result['error']['after']['on']}, leads" if logs[1:] else ""
    return f"Shown on other motion that was not fitted: {', '.join(logs)}{leads}."


def _found(result: dict) -> str:
    """What the model lacked and what changed, in one clause."""
    lacked = grouped(result["effects"], result["joints"])
    changed = grouped(result["changed"], result["joints"])
    clauses = []
    if lacked:
        clauses.append(f"The model lacked {lacked}")
    if changed:
        clauses.append(
            f"{'since it was identified' if lacked else 'Since the model was identified'} "
            f"{changed} changed"
        )
    clauses += [
        f"{entry['joint']} follows a law of its own: {entry['formula']}"
        for entry in result["discovered"]
    ]
    return "; ".join(clauses + not_told_apart(result))


def law_facts(entry: dict) -> list[str]:
    """What a reader has to know of a discovered law: its form, its range, its evidence, what fits alike."""
    gain = entry["gain"]
    seen = ", ".join(
        f"{r['variable']} from {r['from']:.3g} to {r['to']:.3g}{unit_text(r['unit'])}"
        for r in entry["range"]
    )
    told = [
        f"Form: {entry['form']}.",
        f"Seen where {seen}; a guess elsewhere.",
        f"Takes {percent(gain['share_of_error'], 0)} off the joint's squared error on unseen time "
        f"(p = {gain['p_value']:.1g}, {entry['programs_tried']} programs tried) and leaves "
        f"{percent(entry['error_on_other_motion'], 1)} of it in regions of the motion it was not fitted to.",
    ]
    if entry["based_on"]:
        told.append(f"It bends a known law: {', '.join(entry['based_on'])}.")
    told += [
        f"Fits alike: {a['formula']}, {a['distance']['over_noise']:.2g} times the noise apart on this motion."
        for a in entry["alternatives"]
    ]
    return told


def reasons(result: dict) -> list[str]:
    """What a reader has to know beside the verdict, without what the verdict's sentence says."""
    told = evidence_sentence(result)
    return [reason for reason in result.get("reasons", ()) if reason not in told]


def next_steps(result: dict) -> list[str]:
    """What to measure or do next."""
    steps = to_tell_apart(result)
    for law in result["discovered"]:
        steps += [
            f"To tell {law['formula']} from {other['formula']} on {law['joint']}: {other['experiment']}."
            for other in law["alternatives"][:1]
        ]
        steps.append(
            f"{law['file']} holds the law of {law['joint']}: read it, edit it, and declare it with "
            "--effects-from."
        )
    for u in result.get("no_formula", ()):
        steps.append(
            f"No formula for {u['joint']} among {u['programs_tried']} programs: {u['because']}."
        )
    # A search that was cut short, or one that could show nothing, has not asked every law.
    if not (result.get("budget") or _unshown(result)):
        if result["unexplained"]:
            steps += worth_a_longer_log(result["not_added"], None)
        for u in result["unexplained"]:
            steps += look_at(u) + worth_a_longer_log(result["not_added"], u["joint"])
        steps += _not_searched(result)
    return steps + fit_beyond(result) + left_open(result) + near_noise(result)


def _not_searched(result: dict) -> list[str]:
    """Where a search for formulas was not asked for and may tell more than the catalog."""
    told = []
    searched = {entry["joint"] for entry in (*result.get("no_formula", ()), *result["discovered"])}
    lacking = [u["joint"] for u in result["unexplained"] if u["depends_on"]]
    lacking = [joint for joint in lacking if joint not in searched]
    if lacking:
        told.append(
            f"diagnose with --discover looks for a formula of what {', '.join(lacking)} lacks."
        )
    usual = {name for name, law in REGISTRY.items() if law.everyday}
    own = [e["joint"] for e in result["effects"] if e["joint"] and e["effect"] not in usual]
    doubted = dict.fromkeys(joint for joint in own if own.count(joint) > 1)
    several = [joint for joint in doubted if joint not in {*searched, *lacking}]
    if several:
        told.append(
            f"Several laws were added on {', '.join(several)}: diagnose with --discover looks for one "
            "in their place."
        )
    return told


def log_notes(result: dict) -> list[str]:
    """What was found wrong with the logs themselves, and what was done about it."""
    told = {f"{item['log']}: {item['what']}": None for item in result.get("findings", ())}
    if not told:
        told = {note: None for log in result.get("logs", ()) for note in log["notes"]}
    scored = {entry["on"]: entry["after"] for entry in result["error"].get("validation") or []}
    rest = rest_lines(scored, result["joints"], result["torque_units"]) if scored else []
    return [*told, *unscored_lines(scored), *event_lines(scored), *rest, *clock_lines(result)]
