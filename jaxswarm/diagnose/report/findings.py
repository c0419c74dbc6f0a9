"""The upper half of the page: verdict, errors, effects, what remains and what to do."""

from jaxswarm.diagnose.decision.rules import NEAR
from jaxswarm.diagnose.report import grids
from jaxswarm.diagnose.report.flags import flagged
from jaxswarm.diagnose.report.markup import bullets, folded, image, source, table, text
from jaxswarm.diagnose.report.numbers import percent
from jaxswarm.diagnose.report.remains import remaining
from jaxswarm.diagnose.report.stages import stages
from jaxswarm.diagnose.report.text import (
    evidence_sentence,
    law_facts,
    next_steps,
    proof_sentence,
    reasons,
    where,
)


def verdict(result: dict) -> str:
    """Verdict, one sentence of evidence, and how far it is proven."""
    return (
        text("h1", f"{result['robot']}: diagnosis")
        + f'<div class="verdict">{text("strong", result["verdict"].capitalize())}'
        + f"{text('p', evidence_sentence(result))}</div>"
        + text("p", proof_sentence(result), "proof")
    )


def errors(result: dict, images: dict[str, bytes]) -> str:
    """Error by joint, by step, and on every validation log."""
    error = result["error"]
    if error["before"] is None:
        return ""
    legend = (
        "RMS error of the torque; share: of the joint's own torque; noise: of torque and motion, below "
        f"{error['noise_floor']['torque_cutoff_hz']:.3g} Hz; {grids.OVER_NOISE}. "
        f"Beyond {NEAR:g} a joint is marked as far."
    )
    parts = [
        text("h2", f"Error on {error['after']['on']}"),
        table(grids.by_joint(result), "error by joint"),
        text("p", legend, "soft"),
        image(images, "ladder.png", _ladder_words(result)),
    ]
    if result["steps"] or "with_smooth_terms" in error:
        parts.append(table(grids.by_step(result), "error by step"))
        every = table(grids.all_steps(result), "error of every joint after every step")
        parts.append(folded("Every joint after every step", every))
    logs = grids.by_validation_log(result)
    if logs is not None:
        parts += [text("h3", "Every validation log"), table(logs, "error on every validation log")]
    return "".join(parts)


def _ladder_words(result: dict) -> str:
    names = "; ".join(f"{k}: {stage.name}" for k, stage in enumerate(stages(result)))
    return f"Bars: error of every joint. {names}. Dashed: noise."


def doubts(result: dict) -> str:
    """Values at bounds, implausible or unknown, in one list."""
    lines = flagged(result)
    if not lines:
        return ""
    return f'<div class="flags">{text("h3", "Values to be looked at")}{bullets(lines)}</div>'


def effects(result: dict, images: dict[str, bytes]) -> str:
    """What was added, what changed, and laws that were found as formulas."""
    parts = [
        _effect(effect, number, images)
        for number, effect in enumerate([*result["effects"], *result["changed"]], 1)
    ]
    for entry in result.get("discovered", ()):
        parts += [
            text("h2", f"A law of its own on {entry['joint']}"),
            text("p", entry["formula"], "formula"),
        ]
        if entry.get("parameters"):
            parts.append(table(grids.parameters(entry), "parameters of the law"))
        if entry.get("form"):
            parts += [
                bullets(law_facts(entry)),
                image(images, entry["picture"], _LAW_PICTURE),
                text("p", f"LaTeX: {entry['latex']}", "soft"),
                folded("Other formulas", table(grids.formulas(entry), "formulas that were tried")),
            ]
    return "".join(parts)


_LAW_PICTURE = (
    "The dots are the torque that the rest of the model leaves, the line is the law; left against what it "
    "depends on, right over time."
)


def _effect(effect: dict, number: int, images: dict[str, bytes]) -> str:
    gain, name = effect["gain"], where(effect)
    changed = any(row.get("change") for row in effect["parameters"].values())
    worth = (
        f"Takes {percent(gain['share_of_error'], 0)} off the joint's squared error on unseen time "
        f"(p = {gain['p_value']:.1g}, helps in {percent(gain['helps_in_blocks'], 0)} of the blocks)."
    )
    words = (
        f"{name}: the dots are the torque that the rest of the model leaves, the line is the effect; "
        "left against what it depends on, right over time."
    )
    rivals = table(grids.rivals(effect), f"runners-up of {name}")
    return "".join(
        [
            text("h2", f"{number}. {name}{' changed' if changed else ''}"),
            text("p", effect.get("law", ""), "formula"),
            text("p", effect.get("meaning", "")),
            table(grids.parameters(effect), f"parameters of {name}"),
            text("p", worth),
            image(images, effect["picture"], words),
            folded("Runners-up", rivals),
            source(effect.get("reference", "")),
        ]
    )


def left(result: dict, images: dict[str, bytes]) -> str:
    """What no law explains: on which joint, on what it depends, when, and at which frequencies."""
    if not result["unexplained"]:
        return ""
    parts = [text("h2", "What no known law explains")]
    parts.append(bullets(remaining(entry) for entry in result["unexplained"]))
    for entry in result["unexplained"]:
        words = (
            f"{entry['joint']} against {' and '.join(entry['depends_on'])}: the dots are what the final "
            "model leaves, the line is a smooth function of what it depends on."
        )
        parts.append(image(images, f"unexplained_{entry['joint']}.png", words))
    return "".join(parts)


def todo(result: dict) -> str:
    """What a reader has to know, and what to measure or do next."""
    told = bullets([*reasons(result), *next_steps(result)])
    return text("h2", "What to know and do next") + told if told else ""
