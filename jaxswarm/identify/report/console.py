"""The result of ``identify`` as tables on a terminal."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.console import Console

from jaxswarm.identify.estimation.standing import held_lines
from jaxswarm.identify.forward.seen import swing_note
from jaxswarm.identify.report.errors import base_table, error_rows, error_table
from jaxswarm.identify.report.summary import SOUND

# Parameters named in a sentence; the others are in the table.
_MOST_NAMED = 6
# An error this many times that in motion is mostly that of rest: by half of its square.
_REST_COUNTS = 2.0**0.5


def print_identification(report: dict, out: Path) -> None:
    """Print errors and parameters of an ``identification.json``."""
    console = Console()
    errors = error_rows(report)
    console.print(summary_line(report), "", sep="\n")
    console.print(error_table(report["robot"], errors, report["joints"], report["torque_units"]))
    console.print("", base_table(report["base_parameters"]), sep="\n")
    console.print()
    for line in remarks(report):
        console.print(line)
    search = report["optimizer"]
    if search["name"] != "least_squares":
        excess = search["excess_over_least_squares"]
        console.print(
            f"{search['name']}: {search['runs']} runs, {search['evaluations']} evaluations, cost above "
            f"the least-squares optimum by {100 * excess['best']:.3g} % (best), "
            f"{100 * excess['median']:.3g} % (median)"
        )
    console.print(f"written to {out}")


def summary_line(report: dict) -> str:
    """The error on the motion that counts most, and how many parameters are known, in one sentence."""
    rows = error_rows(report)
    on, errors = list(rows.items())[-1]
    fitted = list(rows.values())[0]
    base = report["base_parameters"]
    told = (
        f"{report['robot']}: error {100 * errors['relative_global']:.2f} % of the torque on the {on}, "
        f"{100 * fitted['relative_global']:.2f} % where it was fitted; "
        f"{sum(row['verdict'] in SOUND for row in base)} of {len(base)} base parameters determined "
        "or negligible"
    )
    for verdict in ("weak", "at bound", "impossible"):
        names = [row["name"] for row in base if row["verdict"] == verdict]
        more = f" and {len(names) - _MOST_NAMED} more" if len(names) > _MOST_NAMED else ""
        told += f"; {verdict}: {', '.join(names[:_MOST_NAMED])}{more}" if names else ""
    return f"{told}."


def remarks(report: dict) -> list[str]:
    """What a reader has to know beside the tables."""
    return [
        *clock_lines(report),
        *unscored_lines(error_rows(report)),
        *held_lines(report.get("held_at_rest", {})),
        *rest_lines(error_rows(report), report["joints"], report["torque_units"]),
        *consistency_lines(report),
        *estimator_lines(report),
    ]


def unscored_lines(errors: Mapping[str, dict]) -> list[str]:
    """What is not scored of logs, by their names."""
    unscored = {name: e["left_out_s"] for name, e in errors.items() if e.get("left_out_s")}
    return [f"{name}: {swing_note(seconds)}" for name, seconds in unscored.items()]


def event_lines(errors: Mapping[str, dict]) -> list[str]:
    """What is not scored of logs, by their names, since something happened there."""
    spans = {
        name: ", ".join(f"{w['start']:.3g}-{w['end']:.3g} s" for w in e["events"])
        for name, e in errors.items()
        if e.get("events")
    }
    return [
        f"{name}: {span} is not scored: every model leaves far more there than in most of the log. Look at "
        "what happened then, such as a push."
        for name, span in spans.items()
    ]


def rest_lines(
    errors: Mapping[str, dict], joints: Sequence[str], units: Sequence[str]
) -> list[str]:
    """Joints whose error on a log is that of rest, by the logs' names: what they leave there, and in motion."""
    told = []
    for name, e in errors.items():
        apart = (e.get(key) or [None] * len(joints) for key in ("rms_moving", "rms_standing"))
        rows = zip(joints, units, e["rms"], *apart, strict=True)
        parts = [
            f"{joint} ({rest:.3g} {unit} at rest, {moving:.3g} in motion)"
            for joint, unit, rms, moving, rest in rows
            if moving and rest and rest > rms > _REST_COUNTS * moving
        ]
        if parts:
            told.append(
                f"{name}: most of the error of {', '.join(parts)} is that of rest, where dry friction can hold "
                "a joint at any torque."
            )
    return told


def clock_lines(report: dict) -> list[str]:
    """By how much the clocks of torque and position are apart, where they are."""
    told, lines = report.get("filtering", {}), []
    skew, weight = told.get("clock_skew_s", 0.0), told.get("weight_skew_s", 0.0)
    if skew:
        lines.append(
            f"The torque is read {_apart(skew)} the position: less than a sample, so a matter "
            "of the clock and not of the robot. The model allows for it."
        )
    if weight:
        lines.append(
            f"The weight is read {_apart(weight)} the rest of the torque, on several joints alike: as where a "
            "slower computer tells it to the drives. The model allows for it."
        )
    return lines


def _apart(seconds: float) -> str:
    return f"{1e3 * abs(seconds):.2f} ms {'after' if seconds > 0 else 'before'}"


def consistency_lines(report: dict) -> list[str]:
    """Which links' identified parameters no rigid body can have, and what bodies cost."""
    found = report.get("physical_consistency")
    if found is None:
        return []
    most = max(found["torque_moved_over_residual"])
    impossible = [link for link in found["links"] if not link["possible"]]
    lines = [
        f"{link['joint']}: no rigid body has these parameters: {'; '.join(link['reasons'])}"
        for link in impossible
    ]
    cost = f"the torque moves by {most:.2g} residual standard deviations at most"
    if found["enforced"]:
        lines.append(f"physical: all links are rigid bodies; {cost}")
    elif impossible:
        lines.append(f"--physical takes the nearest rigid bodies: {cost}")
    else:
        lines.append(f"physical consistency: rigid bodies can have these parameters ({cost})")
    return lines


def estimator_lines(report: dict) -> list[str]:
    """How another estimator than least squares went."""
    told = report.get("estimator", {"name": "least_squares"})
    if "p_value" in told:
        word = "biased" if told["least_squares_biased"] else "not biased beyond chance"
        return [f"{told['name']}: least squares is {word} (p = {told['p_value']:.2g})"]
    if "observer_hz" in told:
        after, before = (told["position_error_rms"][k] for k in ("output_error", "least_squares"))
        pairs = ", ".join(f"{b:.3g} to {a:.3g}" for a, b in zip(after, before, strict=True))
        done = "converged" if told["converged"] else "not converged"
        return [f"{told['name']}: {done}; error of the simulated positions from {pairs} (RMS)"]
    return []
