"""The lower half of the page: what was not added, the rigid body, pictures, logs, and where it comes from."""

from jaxswarm import outputs
from jaxswarm.diagnose.report import grids
from jaxswarm.diagnose.report.grids import Grid
from jaxswarm.diagnose.report.markup import bullets, download, folded, image, table, text
from jaxswarm.diagnose.report.signals import Signals, section
from jaxswarm.diagnose.report.text import grouped, log_notes, taken_out


def not_added(result: dict) -> str:
    """Candidates that were not kept, effects taken back, and those that came nearest."""
    parts = []
    lost = table(grids.refused(result), "candidates that were found and not kept")
    if lost:
        parts += [text("h2", "Did not survive on other motion"), lost]
    if result["removed"]:
        parts += [text("h2", "No longer in the model"), bullets(taken_out(result))]
    asked = f"Candidates that were not added ({result['asked']} asked)"
    parts.append(folded(asked, table(grids.not_added(result), "candidates that were not added")))
    return "".join(parts)


def rigid_body(result: dict) -> str:
    """Parameters in base and in standard form, behind their titles."""
    rows = grids.base_parameters(result)
    note = (
        "Base form: the combinations of standard parameters that this motion tells apart. 'determined': "
        "known well enough for the torque; 'negligible': all of its interval is worth less than 0.5 % of the "
        "torque; 'weak': its interval is wide; 'impossible': below zero, where no "
        "body is; 'at bound': physics holds it."
    )
    content = table(rows, "base parameters of the model")
    title = f"Parameters of the rigid body and of linear effects ({len(rows.rows)})"
    bodies = table(grids.standard_parameters(result), "standard parameters of the links")
    return folded(title, text("p", note, "soft") + content if content else "") + folded(
        "Standard parameters of the links", text("p", _BODIES, "soft") + bodies if bodies else ""
    )


_BODIES = (
    "Standard form: mass, center of mass and inertia about it, in the frame of the joint, of the rigid bodies "
    "nearest to the base parameters. The motion tells only the combinations above apart: within them these "
    "are one choice of many, as near to equal balls as the torque allows; no single number here is measured."
)


def pictures(result: dict, images: dict[str, bytes], shown: Signals | None = None) -> str:
    """Torque, where it can be zoomed into as signals, and residuals."""
    joints = ", ".join(result["joints"])
    drawn = [
        ("Measured and predicted torque", "torque.png",
         f"Torque of {joints} over time: measured, of the final model, and their difference below."),
        ("What the final model leaves", "residual.png",
         f"What the final model leaves on {joints}, against position, velocity, acceleration, load and "
         "time; bars: mean and two standard errors."),
        ("What the declared model leaves", "residual_before.png",
         f"What the declared model leaves on {joints}, against the same."),
    ]  # fmt: skip
    zoomed = section(shown, result["joints"], result["torque_units"])
    drawn = drawn[1:] if zoomed else drawn
    # What the declared model leaves is for those who doubt: behind its title.
    pairs = [(text("h2", title), image(images, name, words)) for title, name, words in drawn[:-1]]
    title, name, words = drawn[-1]
    told = zoomed + "".join(head + picture for head, picture in pairs if picture)
    return told + folded(title, image(images, name, words))


def logs(result: dict) -> str:
    """What was found wrong with the logs."""
    found = bullets(log_notes(result))
    return text("h2", "Found in the logs") + found if found else ""


def origin(result: dict, model: str | None = None) -> str:
    """What was declared and asked, versions, options and digests, and result and model to save."""
    declared = grouped(result["declared"], result["joints"], "; ") or "rigid body only"
    parts = [text("h2", "Where this comes from"), text("p", f"Declared: {declared}.")]
    if result.get("model"):
        parts.append(text("p", f"Against the earlier model {result['model']}."))
    source = result.get("provenance")
    if source:
        inputs = [(item["name"], item["sha256"]) for item in source["inputs"]]
        parts.append(table(Grid(("file", "SHA-256"), inputs), "input files"))
        options = dict(source["options"])
        parts.append(text("p", options.pop("command", None) or "", "formula"))
        told = {**options, **{f"{k} version": v for k, v in source["versions"].items()}}
        rows = [(name, str(value)) for name, value in told.items() if value is not None]
        settings = table(Grid(("option", "value"), rows), "options and versions")
        parts.append(folded("Options and versions", settings))
    parts.append(download("diagnosis.json", outputs.to_json(result), "application/json"))
    if model is not None:
        parts.append(download("model.json", model, "application/json"))
    return "".join(parts)
