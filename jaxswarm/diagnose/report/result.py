"""The outcome of a diagnosis as plain data: the keys of ``diagnosis.json``."""

from collections.abc import Sequence
from typing import Any

from jaxswarm.diagnose.decision.remainder import Remainder
from jaxswarm.diagnose.decision.rules import HARM, Rules
from jaxswarm.diagnose.decision.unexplained import Unexplained
from jaxswarm.diagnose.decision.verdict import (
    CANNOT,
    NO_PROOF,
    belongs_together,
    hopeless,
    unpredicted,
    verdict,
)
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.discovery.discover import Search
from jaxswarm.diagnose.report import discovered
from jaxswarm.diagnose.report.error_change import begun, grown
from jaxswarm.diagnose.report.place import place
from jaxswarm.diagnose.report.refusal import refusal
from jaxswarm.diagnose.report.undecided import undecided
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.outcome import Outcome
from jaxswarm.diagnose.selection.step import Addition, Step, with_errors
from jaxswarm.diagnose.selection.survives import UNSHOWN
from jaxswarm.effects.alike import has
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.report.summary import (
    base_parameter_table,
    term_parameters,
    units,
    with_intervals,
)

# How the noise of a joint is told.
NOISE = (
    "row by row, over all rows: noise of the torque sensor (sample to sample, by the median third difference, "
    "or what is as strong at all times just above the torque cutoff; the least of the fitted logs); what the "
    "noise of the positions makes of the model, by drawing it; and what is sharper than sampling shows, by the "
    "power of the residual above the torque cutoff"
)
# Candidates told among those that were not added.
_MOST_TOLD = 12


def to_result(outcome: Outcome, rules: Rules | None = None, search: Search | None = None) -> dict:
    """All that is known at the end, as nested dictionaries.

    Args:
        outcome: What was computed when the selection had ended.
        rules: Other thresholds than those that decided, to see what they would have refused.
        search: Formulas that were searched, and found or not; None: none were asked for.
    """
    laws, diagnosis = search or Search((), ()), outcome.diagnosis
    rules = rules or diagnosis.rules
    final, robot = diagnosis.final, diagnosis.final.model.robot
    joints = robot.joints
    belongs = not outcome.validation and belongs_together(final, outcome.remains)
    unseen = outcome.after["relative_global"]
    why, weak = hopeless(unseen, belongs), unpredicted(unseen, belongs)
    added = len(diagnosis.kept) + len(laws.found)
    beyond = any(entry.get("beyond") for entry in outcome.validation)
    return {
        "robot": robot.name,
        "joints": list(joints),
        "declared": [place(t, joints) for t in diagnosis.declared.model.terms],
        **_choices(outcome, laws, joints),
        "unexplained": _unexplained(outcome.left, outcome.remains, joints),
        "undecided": undecided(outcome, joints),
        "error": _error(outcome),
        "torque_units": list(units(robot)),
        "verdict": CANNOT if why else verdict(added, outcome.left, outcome.remains, beyond),
        "proof": NO_PROOF if weak else outcome.proof,
        "residual_over_noise": [r.over_noise for r in outcome.remains],
        "discovered": discovered.entries(laws, final, joints),
        "no_formula": discovered.in_vain(laws, joints),
        "budget": vars(diagnosis.spent) if diagnosis.spent else None,
        "reasons": [
            *(told for told in (why, weak) if told),
            *diagnosis.cut_short,
            *begun(outcome.validation),
            *grown(outcome.validation, joints, outcome.noise, HARM),
        ],
        **_refusals(diagnosis, rules, joints),
        "effective_samples": diagnosis.crossfit.effective,
        "sign_width": list(final.model.width),
        "filtering": {
            "motion_cutoff_hz": list(final.motions[0].motion_cutoff),
            "torque_cutoff_hz": final.motions[0].torque_cutoff,
            "clock_skew_s": final.motions[0].skew,
            "weight_skew_s": final.motions[0].weight_skew,
        },
        "rules": vars(rules),
    }


def _choices(outcome: Outcome, laws: Search, joints: tuple[str, ...]) -> dict:
    """What was added, in order, and taken back, and the values of the final model."""
    diagnosis = outcome.diagnosis
    effects = [_effect(step, diagnosis.final, joints) for step in diagnosis.kept]
    taken = (*(t for s in diagnosis.steps for t in s.removed), *diagnosis.withdrawn)
    every: tuple[Addition, ...] = (*diagnosis.steps, *laws.found)
    steps = zip(every, outcome.steps, strict=True)
    return {
        "effects": [{**e, "picture": f"effect_{k}.png"} for k, e in enumerate(effects, 1)],
        "changed": [],
        "steps": [
            {
                "added": place(step.added, joints),
                "before": before,
                "after": after,
                "removed": [place(t, joints) for t in step.removed],
            }
            for step, (before, after) in steps
        ],
        "base_parameters": base_parameter_table(diagnosis.final),
        # What was taken out on the way may have come back.
        "removed": [place(t, joints) for t in taken if not has(t, diagnosis.final.model.terms)],
    }


def _error(outcome: Outcome) -> dict:
    """Errors of the declared and of the final model on unseen motion, and the noise below them."""
    return {
        "before": outcome.before,
        "after": outcome.after,
        "validation": outcome.validation,
        **({"with_smooth_terms": outcome.smooth} if outcome.smooth else {}),
        "noise_floor": {
            "rms": list(map(float, outcome.noise)),
            "how": NOISE,
            "torque_cutoff_hz": outcome.diagnosis.final.motions[0].torque_cutoff,
        },
    }


def _refusals(diagnosis: Diagnosis, rules: Rules, joints: tuple[str, ...]) -> dict:
    """What was not kept, and the candidates that came nearest without being added."""
    rejected = [
        {
            **place(s.candidate.term, joints),
            **refusal(s, rules, len(diagnosis.last), diagnosis.spent is not None),
        }
        for s in _ranked(diagnosis.last)[:_MOST_TOLD]
    ]
    return {
        "refused": [
            {**place(t, joints), "because": text, "unshown": text == UNSHOWN}
            for t, text in diagnosis.refused
        ],
        "asked": diagnosis.asked,
        "not_added": rejected,
    }


def _ranked(scores: Sequence[Score]) -> list[Score]:
    return sorted(scores, key=lambda s: -s.gain)


def _effect(step: Step, final: Estimate, joints: tuple[str, ...]) -> dict:
    term, errors = with_errors(step.added, final) or (step.added, {})
    parameters = with_intervals(term_parameters(term, final.model.robot, errors))
    total = float(step.score.gain)
    law = term.law
    return {
        **place(term, joints),
        **({} if law.way is None else {"way": law.way(term.values)}),
        "law": law.summary,
        "meaning": law.meaning,
        "reference": law.reference,
        "parameters": parameters,
        "gain": {
            "share_of_error": step.score.share,
            "weighted_squared_error": total,
            "p_value": step.score.p_value,
            "helps_in_blocks": step.score.repeats,
        },
        "alternatives": [
            {**place(s.candidate.term, joints), "relative_gain": s.relative_gain(step.score)}
            for s in step.others[:5]
        ],
    }


def _again(left: Remainder) -> dict | None:
    """After which time the motion of a fitted log comes back, and how far what is left comes with it."""
    return left.again and {"period_s": left.again[0], "correlation": left.again[1]}


def _unexplained(left: Sequence[Unexplained], remains: Sequence[Remainder], joints) -> list[dict]:
    """Structure that was found, and joints that are far from the noise without any."""
    told: list[tuple[int, dict[str, Any]]] = []
    for u in left:
        entry: dict[str, Any] = {
            "share": u.share,
            "p_value": u.p_value,
            "in_model": u.term is not None,
            "share_on_other_motion": u.elsewhere,
            "or_states": u.or_states and {"depends_on": [*u.or_states[0]], "share": u.or_states[1]},
        }
        told.append((u.joint, {"depends_on": list(u.depends_on), **entry}))
    for r in remains:
        if not r.near and r.joint not in {u.joint for u in left}:
            entry = {"share": 1.0 - 1.0 / r.over_noise**2, "p_value": None, "in_model": False}
            entry |= dict.fromkeys(("share_on_other_motion", "or_states"))
            told.append((r.joint, {"depends_on": [], **entry}))
    return [
        {
            "joint": joints[joint],
            **entry,
            "over_noise": remains[joint].over_noise,
            "windows": [
                {"log": log, "start": start, "end": end}
                for log, start, end in remains[joint].windows
            ],
            "band_hz": list(remains[joint].band),
            "again": _again(remains[joint]),
        }
        for joint, entry in told
    ]
