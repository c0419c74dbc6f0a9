"""The outcome of a diagnosis as plain data: the keys of ``diagnosis.json``."""

from collections.abc import Sequence
from pathlib import Path

from jaxswarm.diagnose.decision.score import Rules, Score, passes
from jaxswarm.diagnose.decision.unexplained import Unexplained, with_smooth_terms
from jaxswarm.diagnose.report.experiment import best_experiment
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.diagnose.selection.stepwise import Diagnosis
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.validate import held_out_errors, log_errors
from jaxswarm.identify.report.summary import term_parameters, units, with_intervals
from jaxswarm.logs.motion import Motion


def unseen_errors(found: Estimate, validation: Sequence[Motion]) -> dict:
    """Errors on motion that was not fitted: the validation logs, else held-out blocks of time."""
    if not validation:
        return {**held_out_errors(found), "on": "held-out blocks of time"}
    parts = [
        {**log_errors(found.model.during(None), m), "on": Path(m.source).name} for m in validation
    ]
    return parts[0] if len(parts) == 1 else {**parts[0], "further": parts[1:]}


def place(term: Term, joints: tuple[str, ...]) -> dict:
    """Effect and joint (null for a global effect, partner where there is one)."""
    entry = {"effect": term.effect, "joint": None if term.joint is None else joints[term.joint]}
    if term.other is not None:
        entry["other"] = joints[term.other]
    return entry


def verdict(diagnosis: Diagnosis, left: Sequence[Unexplained]) -> str:
    """One of the four verdicts."""
    if diagnosis.steps:
        return "partly explained" if left else "explained"
    return "unexplained" if left else "nothing missing"


def to_result(
    diagnosis: Diagnosis,
    left: Sequence[Unexplained],
    validation: Sequence[Motion] = (),
    rules: Rules | None = None,
) -> dict:
    """All that is known at the end, as nested dictionaries.

    Args:
        diagnosis: The loop's outcome.
        left: Structure that remains.
        validation: Logs to score on.
        rules: The thresholds that were used.
    """
    rules = rules or Rules()
    final, robot = diagnosis.final, diagnosis.final.model.robot
    joints = robot.joints
    steps = [_step(step, joints, validation) for step in diagnosis.steps]
    before = unseen_errors(diagnosis.declared, validation)
    after = unseen_errors(final, validation)
    noise = [m.torque_noise for m in (validation or final.motions)][0]
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
        "removed": [
            place(t, joints)
            for t in (*(t for s in diagnosis.steps for t in s.removed), *diagnosis.withdrawn)
        ],
        "unexplained": [
            {
                "joint": joints[u.joint],
                "depends_on": list(u.depends_on),
                "share": u.share,
                "p_value": u.p_value,
                "in_model": u.term is not None,
            }
            for u in left
        ],
        "undecided": [u for step in diagnosis.steps for u in _undecided(step, joints)],
        "error": {
            "before": before,
            "after": after,
            **_smooth_errors(final, left, validation),
            "noise_floor": {
                "rms": list(map(float, noise)),
                "how": "sample-to-sample noise of the torque (median third difference), taken as "
                "white, below the torque cutoff",
                "torque_cutoff_hz": final.motions[0].torque_cutoff,
            },
        },
        "torque_units": list(units(robot)),
        "verdict": verdict(diagnosis, left),
        "asked": diagnosis.asked,
        "suspects": [_rejected(s, diagnosis, rules, joints) for s in _ranked(diagnosis.last)[:12]],
        "effective_samples": diagnosis.background.effective,
        "sign_width": list(final.model.width),
        "filtering": {
            "motion_cutoff_hz": list(final.motions[0].motion_cutoff),
            "torque_cutoff_hz": final.motions[0].torque_cutoff,
            "clock_skew_s": final.motions[0].skew,
        },
        "rules": vars(rules),
    }


def _smooth_errors(final: Estimate, left: Sequence[Unexplained], validation) -> dict:
    """Errors on the validation logs with smooth terms in the model, where there are both."""
    if not validation or not any(u.term is not None for u in left):
        return {}
    model = with_smooth_terms(final, left).during(None)
    parts = [{**log_errors(model, m), "on": Path(m.source).name} for m in validation]
    return {"with_smooth_terms": {**parts[0], **({"further": parts[1:]} if parts[1:] else {})}}


def _ranked(scores: Sequence[Score]) -> list[Score]:
    return sorted(scores, key=lambda s: -s.gain)


def _effect(step: Step, final: Estimate, joints: tuple[str, ...]) -> dict:
    term, errors = _final_term(step.added, final)
    parameters = with_intervals(term_parameters(term, final.model.robot, errors))
    total = float(step.score.gain)
    return {
        **place(term, joints),
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


def _step(step: Step, joints: tuple[str, ...], validation) -> dict:
    return {
        "added": place(step.added, joints),
        "before": unseen_errors(step.before, validation),
        "after": unseen_errors(step.after, validation),
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
                f"torque noise on {joints[trial.joint]}",
            }
        )
    return found


def _rejected(item: Score, diagnosis: Diagnosis, rules: Rules, joints) -> dict:
    reasons = []
    if item.gain <= 0:
        reasons.append("does not lower the error on unseen time")
    elif item.share < rules.share:
        reasons.append(
            f"takes off {100 * item.share:.1f} % of the error, less than {rules.share:.0%}"
        )
    if item.p_value * len(diagnosis.last) >= rules.significance:
        reasons.append("may be chance, given how many suspects were asked")
    if not item.allowed:
        reasons.append("sign or size against physics")
    if item.repeats < rules.repeat:
        reasons.append(f"helps in only {item.repeats:.0%} of the blocks")
    if not reasons and not passes(item, len(diagnosis.last), rules):
        reasons.append("no single event that explains more than everything that lasts")
    return {
        **place(item.candidate.term, joints),
        "share_of_error": item.share,
        "p_value": item.p_value,
        "rejected_because": reasons or ["the refit did not confirm it"],
    }
