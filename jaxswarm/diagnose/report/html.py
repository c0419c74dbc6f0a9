"""The report as one self-contained HTML page."""

import base64
from html import escape

from jaxswarm.diagnose.report.text import next_steps, value_text, verdict_sentence, where

_STYLE = """
body{font:15px/1.5 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;color:#222}
h1{font-size:1.5rem;margin-bottom:.2rem}h2{font-size:1.15rem;margin-top:2.2rem}
.verdict{font-size:1.15rem;background:#f3f6f8;border-left:5px solid #2e6f95;padding:.8rem 1rem}
table{border-collapse:collapse;margin:.6rem 0}td,th{padding:.25rem .7rem;border-bottom:1px solid #ddd;
text-align:left;vertical-align:top}th{background:#fafafa;font-weight:600}
img{max-width:100%;margin:.4rem 0}small{color:#667}
"""


def render(result: dict, images: dict[str, bytes]) -> str:
    """The page for the content of ``diagnosis.json`` and its pictures (PNG bytes by file name)."""
    declared = ", ".join(where(d) for d in result["declared"]) or "rigid body only"
    parts = [
        f"<h1>{escape(result['robot'])}: {escape(result['verdict'])}</h1>",
        f"<p><small>declared: {escape(declared)}; {result['asked']} suspects asked</small></p>",
        f"<p class=verdict>{escape(verdict_sentence(result))}</p>",
        "<h2>Error on unseen motion</h2>",
        _error_table(result),
        _image(images, "ladder.png"),
    ]
    for number, effect in enumerate([*result["effects"], *result["changed"]], 1):
        parts += _effect(effect, number, images)
    for name in sorted(images):
        if name.startswith("unexplained_"):
            parts += ["<h2>Structure no law explains</h2>", _image(images, name)]
    todo = "".join(
        f"<li>{escape(s)}</li>" for s in [*result.get("reasons", ()), *next_steps(result)]
    )
    parts += [
        "<h2>What to do next</h2>",
        f"<ul>{todo}</ul>" if todo else "<p>Nothing the data ask for.</p>",
        "<h2>Suspects that were not added</h2>",
        _suspects(result),
        "<h2>Measured and predicted torque</h2>",
        _image(images, "torque.png"),
        "<h2>Residual of the declared model</h2>",
        _image(images, "residual_before.png"),
        "<h2>Residual of the final model</h2>",
        _image(images, "residual.png"),
    ]
    notes = [n for log in result.get("logs", ()) for n in log["notes"]]
    skew = result.get("filtering", {}).get("clock_skew_s", 0.0)
    if skew:
        notes.append(
            f"The torque is read {1e3 * abs(skew):.2f} ms {'after' if skew > 0 else 'before'} the position: "
            "less than half a sample, so a matter of the clock and not of the robot. The model allows for it."
        )
    if notes:
        lines = "".join(f"<li>{escape(n)}</li>" for n in notes)
        parts += ["<h2>Found in the logs</h2>", f"<ul>{lines}</ul>"]
    title = escape(f"jaxswarm: {result['robot']}")
    return (
        f"<!doctype html><html lang=en><head><meta charset=utf-8><title>{title}</title>"
        f"<style>{_STYLE}</style></head><body>{''.join(parts)}</body></html>\n"
    )


def _image(images: dict[str, bytes], name: str) -> str:
    data = base64.b64encode(images[name]).decode()
    return f'<img alt="{escape(name)}" src="data:image/png;base64,{data}">'


def _table(head: list[str], rows: list[list[str]]) -> str:
    top = "".join(f"<th>{escape(h)}</th>" for h in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(c)}</td>" for c in row) + "</tr>" for row in rows)
    return f"<table><tr>{top}</tr>{body}</table>"


def _error_table(result: dict) -> str:
    units = result["torque_units"]

    def row(name: str, errors: dict) -> list[str]:
        cells = [
            f"{rms:.4g} {unit} ({100 * share:.2f} %)"
            for rms, share, unit in zip(errors["rms"], errors["relative"], units, strict=True)
        ]
        return [name, *cells, f"{100 * errors['relative_global']:.3f} %"]

    rows = [row("declared model", result["error"]["before"])]
    rows += [row(f"+ {where(s['added'])}", s["after"]) for s in result["steps"]]
    if "with_smooth_terms" in result["error"]:
        rows.append(row("+ smooth terms without a law", result["error"]["with_smooth_terms"]))
    floor = [
        f"{x:.3g} {u}" for x, u in zip(result["error"]["noise_floor"]["rms"], units, strict=True)
    ]
    rows.append(["noise of the torque", *floor, ""])
    return _table(["model", *result["joints"], "global"], rows)


def _effect(effect: dict, number: int, images: dict[str, bytes]) -> list[str]:
    gain = effect["gain"]
    changed = any("change" in row for row in effect["parameters"].values())
    rows = [[name, value_text(row)] for name, row in effect["parameters"].items()]
    others = ", ".join(
        f"{where(a)} ({100 * a['relative_gain']:.0f} % of its gain)" for a in effect["alternatives"]
    )
    return [
        f"<h2>{number}. {escape(where(effect))}{' changed' if changed else ''}</h2>",
        f"<p>Takes {100 * gain['share_of_error']:.0f} % off the joint's squared error on unseen time "
        f"(p = {gain['p_value']:.1g}, helps in {100 * gain['helps_in_blocks']:.0f} % of the blocks). "
        f"Runners-up: {escape(others or 'none')}.</p>",
        _table(["parameter", "value ± standard error"], rows),
        _image(images, effect["picture"]),
    ]


def _suspects(result: dict) -> str:
    rows = [
        [where(s), f"{100 * s['share_of_error']:.1f} %", "; ".join(s["rejected_because"])]
        for s in result["suspects"]
    ]
    return _table(["suspect", "share of the error", "not added because"], rows)
