"""The diagnosis in sentences, shared by the report and the terminal."""

import numpy as np


def where(entry: dict) -> str:
    """``stribeck_friction on joint2``, ``time_delay``."""
    if entry.get("joint") is None:
        return entry["effect"]
    other = f" (driven by {entry['other']})" if entry.get("other") else ""
    return f"{entry['effect']} on {entry['joint']}{other}"


def verdict_sentence(result: dict) -> str:
    """The verdict in one sentence, with the error before and after."""
    before, after = result["error"]["before"], result["error"]["after"]
    if before is None:
        return "; ".join(result["reasons"]) + "."
    if result["verdict"] == "cannot be judged":
        return "This log cannot be judged: " + "; ".join(result["reasons"]) + "."
    change = f"{100 * before['relative_global']:.2f} %"
    if result["effects"] or result["changed"]:
        change += f" before, {100 * after['relative_global']:.2f} % after, on {after['on']}"
    added = _found(result)
    left = "; ".join(remaining(u) for u in result["unexplained"])
    sentences = {
        "nothing missing": f"Nothing is missing: no known effect lowers the error on unseen motion "
        f"beyond chance, and what is left is near the noise (error {change}).",
        "explained": f"{added} (error {change}).",
        "partly explained": f"{added} (error {change}), and more is missing that no known law "
        f"explains: {left}.",
        "unexplained": f"Something is missing that no known law explains: {left} (error {change}).",
    }
    return f"{sentences[result['verdict']]} {_PROOF[result['proof']]}".strip()


_PROOF = {
    "other motion": "",
    "held-out regions": "Shown on regions of this motion that were not fitted; to prove it, record another "
    "motion and pass it with --validation.",
    "none": "Not proven: record another motion and pass it with --validation.",
}


def remaining(entry: dict) -> str:
    """What is left on a joint, in one clause: what it follows, or when and at which frequencies it is."""
    times = f"{entry['over_noise']:.1f} times the noise"
    if entry["depends_on"]:
        names = " and ".join(entry["depends_on"])
        return (
            f"{100 * entry['share']:.0f} % of the remaining error of {entry['joint']} ({times}) "
            f"follows {names}"
        )
    low, high = entry["band_hz"]
    spans = ", ".join(f"{w['start']:.3g}-{w['end']:.3g} s" for w in entry["windows"])
    when = f", mostly at {spans}" if spans else ""
    return f"{entry['joint']} is left with {times} at {low:.2g} to {high:.2g} Hz{when}"


def _found(result: dict) -> str:
    """What the model lacked and what changed, in one clause."""
    lacked = ", ".join(where(e) for e in result["effects"])
    changed = ", ".join(where(e) for e in result["changed"])
    clauses = []
    if lacked:
        clauses.append(f"The model lacked {lacked}")
    if changed:
        clauses.append(
            f"{'since it was identified' if lacked else 'Since the model was identified'} "
            f"{changed} changed"
        )
    return "; ".join(clauses)


def value_text(row: dict) -> str:
    """A parameter with its standard error and unit: ``0.108 ± 0.002 rad/s``; of a change, what it was too."""
    if "change" in row:
        now = value_text({k: v for k, v in row.items() if k not in ("change", "before")})
        return f"{now}, was {row['before']:.5g}: changed by {value_text(row['change'])}"
    if row.get("std_error") is not None and np.isnan(row["std_error"]):
        return f"{row['value']:.5g} {row['unit']} (assumed: the log does not tell it)"
    error = row.get("std_error")
    pm = f" ± {error:.2g}" if error is not None and error == error else ""
    return f"{row['value']:.5g}{pm} {row['unit']}"


def next_steps(result: dict) -> list[str]:
    """What to measure or do next."""
    steps = [
        f"To tell {' from '.join(u['effects'])} apart on {u['joint']}: {u['experiment']}."
        for u in result["undecided"]
    ]
    floor = result["error"]["noise_floor"]["rms"]
    after = result["error"]["after"]["rms"]
    for joint, low, rms in zip(result["joints"], floor, after, strict=True):
        if rms < 2.0 * low:
            steps.append(f"{joint} is at {rms / low:.1f} times the torque's noise: stop there.")
    for u in result["unexplained"]:
        if not u["depends_on"]:
            continue
        names = " and ".join(u["depends_on"])
        steps.append(
            f"Vary {names} alone to see the shape on {u['joint']}; a law registered with "
            "jaxswarm.effects.register becomes a suspect at once."
        )
        if u.get("in_model"):
            steps.append(
                f"model.json holds a smooth function of {names} for {u['joint']}: it predicts what "
                "no law explains, within the range of this motion."
            )
    return steps
