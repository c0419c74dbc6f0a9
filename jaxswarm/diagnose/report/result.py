"""The outcome of a diagnosis as plain data: the keys of ``diagnosis.json``."""

from collections.abc import Sequence

from jaxswarm.diagnose.decision.remainder import Remainder, remainders
from jaxswarm.diagnose.decision.score import Rules, Score
from jaxswarm.diagnose.decision.unexplained import Unexplained, with_smooth_terms
from jaxswarm.diagnose.decision.verdict import (
    CANNOT,
    NO_PROOF,
    OTHER_MOTION,
    REGIONS,
    hopeless,
    verdict,
)
from jaxswarm.diagnose.discovery.discover import Search
from jaxswarm.diagnose.discovery.stand_ins import Discovery
from jaxswarm.diagnose.folds.noise import noise_of
from jaxswarm.diagnose.folds.other_motion import regions
from jaxswarm.diagnose.report import discovered
from jaxswarm.diagnose.report.errors import UnseenErrors, grown
from jaxswarm.diagnose.report.experiment import best_experiment, separating_command
from jaxswarm.diagnose.report.refusal import refusal
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.diagnose.selection.survives import HARM
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.report.summary import (
    base_parameter_table,
    term_parameters,
    units,
    with_intervals,
)
from jaxswarm.logs.motion import Motion


def place(term: Term, joints: tuple[str, ...]) -> dict:
    """Effect and joint (null for a global effect, partner where there is one)."""
    entry = {"effect": term.effect, "joint": None if term.joint is None else joints[term.joint]}
    if term.other is not None:
        entry["other"] = joints[term.other]
    return entry


def to_result(
    diagnosis: Diagnosis,
    left: Sequence[Unexplained],
    validation: Sequence[Motion] = (),
    rules: Rules | None = None,
    search: Search | None = None,
) -> dict:
    """All that is known at the end, as nested dictionaries.

    Args:
        diagnosis: The loop's outcome.
        left: Structure that remains.
        validation: Logs to score on.
        rules: Other thresholds than those that decided, to see what they would have refused.
        search: Formulas that were searched, and found or not; None: none were asked for.
    """
    laws = search or Search((), ())
    rules = rules or diagnosis.rules
    final, robot = diagnosis.final, diagnosis.final.model.robot
    joints = robot.joints
    errors = UnseenErrors(validation, diagnosis.declared, final)
    steps = [_step(step, joints, errors) for step in (*diagnosis.steps, *laws.found)]
    before, after = errors.of(diagnosis.declared), errors.of(final)
    noise, remains = noise_of(final), remainders(final)
    smooth = any(u.term is not None for u in left)
    described = errors.with_model(with_smooth_terms(final, left)) if smooth else None
    why = hopeless(after["relative_global"])
    return {
        "robot": robot.name,
        "joints": list(joints),
        "declared": [place(t, joints) for t in diagnosis.declared.model.terms],
        "effects": [
            {**_effect(step, final, joints), "picture": f"effect_{number}.png"}
            for number, step in enumerate(diagnosis.kept, 1)
        ],
        "changed": [],
        "steps": steps,
        "base_parameters": base_parameter_table(final),
        "removed": [
            place(t, joints)
            for t in (*(t for s in diagnosis.steps for t in s.removed), *diagnosis.withdrawn)
        ],
        "unexplained": _unexplained(left, remains, joints),
        "undecided": [u for step in diagnosis.steps for u in _undecided(step, joints)],
        "error": {
            "before": before,
            "after": after,
            "validation": errors.validation,
            **({"with_smooth_terms": described} if described else {}),
            "noise_floor": {
                "rms": list(map(float, noise)),
                "how": "sample-to-sample noise of the torque (median third difference), taken as "
                "white, and what the noise of the positions makes of the declared model, below the "
                "torque cutoff; the least of the fitted logs",
                "torque_cutoff_hz": final.motions[0].torque_cutoff,
            },
        },
        "torque_units": list(units(robot)),
        "verdict": CANNOT if why else verdict(len(diagnosis.kept) + len(laws.found), left, remains),
        "proof": proof(final, validation),
        "residual_over_noise": [r.over_noise for r in remains],
        "discovered": discovered.entries(laws, final, joints),
        "no_formula": discovered.in_vain(laws, joints),
        "budget": vars(diagnosis.spent) if diagnosis.spent else None,
        "reasons": [
            *([why] if why else []),
            *diagnosis.cut_short,
            *grown(errors.validation, joints, noise, HARM),
        ],
        "refused": [{**place(t, joints), "because": text} for t, text in diagnosis.refused],
        "asked": diagnosis.asked,
        "not_added": [
            {
                **place(s.candidate.term, joints),
                **refusal(s, rules, len(diagnosis.last), diagnosis.spent is not None),
            }
            for s in _ranked(diagnosis.last)[:12]
        ],
        "effective_samples": diagnosis.background.effective,
        "sign_width": list(final.model.width),
        "filtering": {
            "motion_cutoff_hz": list(final.motions[0].motion_cutoff),
            "torque_cutoff_hz": final.motions[0].torque_cutoff,
            "clock_skew_s": final.motions[0].skew,
        },
        "rules": vars(rules),
    }


def _ranked(scores: Sequence[Score]) -> list[Score]:
    return sorted(scores, key=lambda s: -s.gain)


def _effect(step: Step, final: Estimate, joints: tuple[str, ...]) -> dict:
    term, errors = _final_term(step.added, final)
    parameters = with_intervals(term_parameters(term, final.model.robot, errors))
    total = float(step.score.gain)
    law = term.law
    return {
        **place(term, joints),
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
            {**place(s.candidate.term, joints), "relative_gain": s.gain / total}
            for s in step.others[:5]
        ],
    }


def _final_term(added: Term, final: Estimate) -> tuple[Term, dict]:
    for term, errors in zip(final.model.terms, final.std_errors, strict=True):
        if term.identity == added.identity:
            return term, errors
    return added, {}


def proof(final: Estimate, validation: Sequence[Motion]) -> str:
    """On what motion the outcome is shown."""
    if validation:
        return OTHER_MOTION
    return NO_PROOF if regions(final) is None else REGIONS


def _unexplained(left: Sequence[Unexplained], remains: Sequence[Remainder], joints) -> list[dict]:
    """Structure that was found, and joints that are far from the noise without any."""
    told = []
    for u in left:
        entry = {"share": u.share, "p_value": u.p_value, "in_model": u.term is not None}
        entry["share_on_other_motion"] = u.elsewhere
        told.append((u.joint, {"depends_on": list(u.depends_on), **entry}))
    seen = {joint for joint, _ in told}
    for r in remains:
        if not r.near and r.joint not in seen:
            entry = {"share": 1.0 - 1.0 / r.over_noise**2, "p_value": None, "in_model": False}
            entry["share_on_other_motion"] = None
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
        }
        for joint, entry in told
    ]


def _step(step: Step | Discovery, joints: tuple[str, ...], errors: UnseenErrors) -> dict:
    return {
        "added": place(step.added, joints),
        "before": errors.of(step.before),
        "after": errors.of(step.after),
        "removed": [place(t, joints) for t in step.removed],
    }


def _undecided(step: Step, joints: tuple[str, ...]) -> list[dict]:
    """Rivals of an added effect, with the motion on which the two would differ most."""
    found = []
    for rival in step.rivals[:2]:
        other = refit_with(step.before, rival)
        if other is None:
            continue
        trial = best_experiment(
            step.after.model, other.model, step.after.motions[0], step.added.joint
        )
        names = [step.added.effect, rival.candidate.term.effect]
        where = place(step.added, joints)["joint"]
        if names[0] == names[1]:
            names = [step.added.label(joints), rival.candidate.term.label(joints)]
        found.append(
            {
                "joint": where,
                "effects": names,
                "experiment": f"{trial.text}: there the two differ by {trial.ratio:.1f} times the "
                f"torque noise on {joints[trial.joint]}"
                + separating_command(step.added, rival.candidate.term, joints),
            }
        )
    return found
