"""The diagnosis in sentences, shared by the report and the terminal."""


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
    change = f"{100 * before['relative_global']:.2f} %"
    if result["effects"]:
        change += f" before, {100 * after['relative_global']:.2f} % after, on {after['on']}"
    added = ", ".join(where(e) for e in result["effects"])
    left = "; ".join(
        f"{100 * u['share']:.0f} % of the remaining error of {u['joint']} follows "
        f"{' and '.join(u['depends_on'])}"
        for u in result["unexplained"]
    )
    sentences = {
        "nothing missing": f"Nothing is missing: no known effect lowers the error on unseen motion "
        f"beyond chance (error {change}).",
        "explained": f"The model lacked {added} (error {change}).",
        "partly explained": f"The model lacked {added} (error {change}), and more is missing that no "
        f"known law explains: {left}.",
        "unexplained": f"Something is missing that no known law explains: {left} (error {change}).",
    }
    return sentences[result["verdict"]]


def value_text(row: dict) -> str:
    """A parameter with its standard error and unit: ``0.108 ± 0.002 rad/s``."""
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
